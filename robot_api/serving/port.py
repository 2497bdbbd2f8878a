"""The port that a server listens at, and the signals that end it."""

from __future__ import annotations

import contextlib
import errno
import signal
import socket
from collections.abc import Callable, Iterator


class CannotListen(Exception):
    """The server cannot be reached at the address it was to have: the port is in use, or it is no
    address of this machine."""


def listen(host: str, port: int) -> socket.socket:
    """A listening socket. Raises CannotListen with what to do about it."""
    try:
        family, kind, number, _, where = socket.getaddrinfo(
            host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE
        )[0]
        listening = socket.socket(family, kind, number)
    except OSError:
        what = f"{host} is" if host else "An empty text is"
        raise CannotListen(f"{what} no address of this machine. Try 127.0.0.1.") from None
    try:
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind(where)
        listening.listen(128)
    except OSError as error:
        listening.close()
        match error.errno:
            case errno.EADDRINUSE:
                sentence = f"Port {port} is in use by another program. "
                sentence += "End that program, or choose another port with --port."
            case errno.EACCES:
                sentence = f"Port {port} may not be used. Choose one above 1023 with --port."
            case _:
                sentence = f"{host} is no address of this machine. Try 127.0.0.1."
        raise CannotListen(sentence) from None
    return listening


@contextlib.contextmanager
def on_signals(react: Callable[[], None]) -> Iterator[None]:
    """React to the first Ctrl-C or SIGTERM; a second one ends the process as usual."""
    numbers = (signal.SIGINT, signal.SIGTERM)
    before = {number: signal.getsignal(number) for number in numbers}

    def restore() -> None:
        for number, handler in before.items():
            signal.signal(number, handler)

    def first(number: int, frame: object) -> None:
        restore()
        react()

    for number in numbers:
        signal.signal(number, first)
    try:
        yield
    finally:
        restore()
