"""`nl2robot mcp`: a door for assistants, over the Model Context Protocol.

It is started by the assistant's program (stdio), or once for all on this machine (--http), and is
itself a client of a running `nl2robot serve`.
"""

from __future__ import annotations

import argparse
import contextlib
import logging
import os
import signal
import socket
import sys
import threading
from collections.abc import Iterator
from types import FrameType
from typing import Final

from nl2robot.assistant.link import Link, connected
from nl2robot.cli.options.robot import add_ca, trust
from nl2robot.cli.options.values import whole
from nl2robot.errors import ExitStatus, UserError
from robot_api.errors import cause
from robot_api.server import DEFAULT_PORT

CLOSES_WITHIN: Final = 1.0
"""Seconds that the robot's server has to take leave when this is told to end."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    here = f"ws://127.0.0.1:{DEFAULT_PORT}"
    parser.add_argument(
        "--robot", default=here, metavar="ADDRESS", help=f"the robot server (default: {here})"
    )
    add_ca(parser)
    parser.add_argument(
        "--token", help="what `nl2robot accounts token NAME` printed on the robot's computer"
    )
    parser.add_argument(
        "--http",
        type=whole(1, 65535),
        metavar="PORT",
        help="serve streamable HTTP on this port of this machine, instead of stdin and stdout",
    )


def run(options: argparse.Namespace) -> int:
    try:
        from nl2robot.assistant.server import assistant_server
    except ModuleNotFoundError as error:
        if error.name is None or error.name.partition(".")[0] not in ("mcp", "mcp_types"):
            raise
        raise UserError(
            "The door for assistants needs the package mcp. Install it: pip install"
            " 'nl2robot[assistants]'."
        ) from error
    trust(options)
    logging.basicConfig(level=logging.WARNING, stream=sys.stderr)
    link = connected(options.robot, options.token)
    try:
        server = assistant_server(link)
        if options.http is None:
            with _ended_by_signals(link), _until_nobody_reads():
                server.run("stdio")
        else:
            _check_free(options.http)
            print(
                f"Assistants on this machine find the robot at http://127.0.0.1:{options.http}/mcp.",
                file=sys.stderr,
            )
            server.run("streamable-http", host="127.0.0.1", port=options.http)
    finally:
        link.close()
    return ExitStatus.OK


@contextlib.contextmanager
def _ended_by_signals(link: Link) -> Iterator[None]:
    """A thread that reads stdin keeps Python from ending: so it is ended without more ado."""

    def end(number: int, frame: FrameType | None) -> None:
        closing = threading.Thread(target=link.close, daemon=True)
        closing.start()
        closing.join(CLOSES_WITHIN)
        os._exit(ExitStatus.INTERRUPTED)

    signals = signal.SIGINT, signal.SIGTERM
    before = [signal.signal(each, end) for each in signals]
    try:
        yield
    finally:
        for each, handler in zip(signals, before, strict=True):
            signal.signal(each, handler)


@contextlib.contextmanager
def _until_nobody_reads() -> Iterator[None]:
    """An assistant's program that has died reads no answer: that is an end like any other."""
    try:
        yield
    except* BrokenPipeError:
        pass


def _check_free(port: int) -> None:
    """Raises `UserError` if something else listens there."""
    with socket.socket() as tried:
        tried.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            tried.bind(("127.0.0.1", port))
        except OSError as error:
            raise UserError(
                f"Port {port} cannot be listened at ({cause(error)}). Choose another: --http"
                f" {port + 1 if port < 65535 else 8765}."
            ) from error
