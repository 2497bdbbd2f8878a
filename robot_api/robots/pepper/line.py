"""One connection to a Pepper: a `qi` session whose every wait has an end and whose errors are ours.

`qi` knows one error, RuntimeError, and tells what went wrong in its text alone.
"""

from __future__ import annotations

import re
import socket
import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, Final

import qi

from robot_api.errors import AccessDenied, LostConnection, NotPossible, NotSupported, RobotError
from robot_api.robots.address import Address

PORT: Final = 9559
SECURE_PORT: Final = 9503
"""Where NAOqi 2.9 and later listen, who want a login."""
CONNECTS_WITHIN: Final = 5.0
"""Seconds that a connection may take; `qi` itself would wait for ever."""
ANSWERS_WITHIN: Final = 2.0
"""Seconds that a light call may take."""

CUT: Final = "The connection to Pepper was cut."
HINT: Final = "See that it is switched on and in the network."

Future = Any
"""A `qi.Future`: `qi` has no types."""

_GONE: Final = re.compile(
    r"session closed|session not connected|socket is not connected|disconnected|"
    r"future timeout|connection (reset|closed)|broken pipe|promise broken",
    re.IGNORECASE,
)
_SERVICE_GONE: Final = re.compile(r"socket is not connected|service removed", re.IGNORECASE)
"""Told of a service that has ended, too, though the connection holds."""
_CLOSES_WITHIN: Final = 1.0
_SETTLES_WITHIN: Final = 0.05
"""Seconds until a connection that is being cut counts as cut."""
_NO_SUCH: Final = re.compile(
    r"cannot find service|can't find method|arguments types did not match", re.IGNORECASE
)


@dataclass(frozen=True)
class Login:
    user: str
    password: str


class _Authenticator:
    """What `qi` asks for a login; it names the methods."""

    def __init__(self, login: Login) -> None:
        self._login = login

    def initialAuthData(self) -> dict[str, str]:
        return {"user": self._login.user, "token": self._login.password}


class _Authenticators:
    def __init__(self, login: Login) -> None:
        self._login = login

    def newAuthenticator(self) -> _Authenticator:
        return _Authenticator(self._login)


def login_of(address: Address, password: str | None) -> Login | None:
    """The login for that address. Raises `AccessDenied` if its password is missing."""
    if address.user is None:
        return None
    if not password:
        raise AccessDenied(
            f"Pepper at {address.host} wants the password of {address.user}."
            " Put it into the environment variable NL2ROBOT_ROBOT_PASSWORD."
        )
    return Login(address.user, password)


def url_of(address: Address) -> str:
    """Where `qi` finds it: with a login, over an encrypted connection."""
    scheme, port = ("tcp", PORT) if address.user is None else ("tcps", SECURE_PORT)
    host = f"[{address.host}]" if ":" in address.host else address.host
    return f"{scheme}://{host}:{address.port or port}"


class Line:
    """A connection. Any thread may use it."""

    def __init__(self, address: Address, login: Login | None) -> None:
        """Raises `LostConnection`, `AccessDenied`."""
        # What `qi` has to say goes to standard output otherwise.
        qi.logging.setLevel(qi.logging.FATAL)
        self._address = address
        self._session = qi.Session()
        self._services: dict[str, Any] = {}
        self._gone: Any = None
        """What listens for its end."""
        if login is not None:
            self._session.setClientAuthenticatorFactory(_Authenticators(login))
        try:
            connecting = self._session.connect(url_of(address), _async=True)
            if not finished(connecting, CONNECTS_WITHIN):
                raise LostConnection(
                    f"Nothing at {address.host} has answered as a Pepper does for"
                    f" {CONNECTS_WITHIN:g} seconds. Check the address, and that Pepper is switched"
                    " on and in the network."
                )
            connecting.value(0)
        except RobotError:
            self.close()
            raise
        except RuntimeError as error:
            self.close()
            raise _no_connection(str(error), address, login) from None

    @property
    def connected(self) -> bool:
        return bool(self._session.isConnected())

    def when_gone(self, listener: Callable[[], None]) -> None:
        """Call it when the connection ends, in a thread of `qi`."""
        self._gone = self._session.disconnected.connect(lambda *_: listener())

    def names(self) -> frozenset[str]:
        """The services that the robot has."""
        asking = self._begun("services", lambda: self._session.services(_async=True))
        return frozenset(service["name"] for service in self.answered(asking, "services"))

    def begin(self, service: str, method: str, *arguments: Any) -> Future:
        """Ask for it without waiting. Raises `LostConnection`, `NotSupported`."""
        proxy = self.service(service)
        try:
            asked = getattr(proxy, method)
        except AttributeError:
            raise NotSupported(
                f"This Pepper's software has no {service}.{method}. Bring it up to date."
            ) from None
        return self._begun(f"{service}.{method}", lambda: asked(*arguments, _async=True))

    def call(
        self, service: str, method: str, *arguments: Any, within: float = ANSWERS_WITHIN
    ) -> Any:
        """A light call."""
        begun = self.begin(service, method, *arguments)
        return self.answered(begun, f"{service}.{method}", within)

    def answered(self, future: Future, what: str, within: float = ANSWERS_WITHIN) -> Any:
        """What comes of it. Raises `LostConnection` if nothing does in time, and what the robot's
        errors are in our words."""
        if not finished(future, within):
            raise LostConnection(f"Pepper has not answered for {within:g} seconds. {HINT}")
        return self._begun(what, lambda: future.value(0))

    def listen(self, service: str, signal: str, heard: Callable[..., None]) -> None:
        """Call it whenever the robot sends that signal, in a thread of `qi`."""
        found = getattr(self.service(service), signal)
        self._begun(service, lambda: found.connect(heard))

    def service(self, name: str) -> Any:
        known = self._services.get(name)
        if known is None:
            looking = self._begun(name, lambda: self._session.service(name, _async=True))
            known = self._services[name] = self.answered(looking, name)
        return known

    def register(self, name: str, service: object) -> int:
        """Give the robot a service of ours, for as long as the connection lasts. It calls us back
        where it sees us: on this machine's address towards it."""
        with suppress(RuntimeError):
            if not self._session.endpoints():
                self._session.listen(f"tcp://{self._own_address()}:0")
        registering = self._begun(
            name, lambda: self._session.registerService(name, service, _async=True)
        )
        return int(self.answered(registering, name))

    def unregister(self, number: int) -> None:
        ending = self._begun(
            "unregister", lambda: self._session.unregisterService(number, _async=True)
        )
        self.answered(ending, "unregister")

    def close(self) -> None:
        """Whoever waits for an answer gets `LostConnection`."""
        self._services.clear()
        with suppress(RuntimeError):
            # Nobody needs to hear of an end of our own; and a thread of `qi` that calls a Python
            # which is just ending takes it down.
            if self._gone is not None:
                self._session.disconnected.disconnect(self._gone)
            finished(self._session.close(_async=True), _CLOSES_WITHIN)

    def _begun(self, what: str, begin: Callable[[], Any]) -> Any:
        """Do that, with its errors in our words."""
        try:
            return begin()
        except RuntimeError as error:
            text = str(error)
        if not self.connected:  # then what is missing is told as if it had never been there
            raise LostConnection(f"{CUT} {HINT}")
        if _SERVICE_GONE.search(text):
            time.sleep(_SETTLES_WITHIN)
            if self.connected:
                service = what.partition(".")[0]
                self._services.pop(service, None)
                raise NotPossible(
                    f"Pepper's {service} has gone away. Try again; if that does not help, start"
                    " Pepper again."
                )
        raise in_words(text, what)

    def _own_address(self) -> str:
        family = socket.AF_INET6 if ":" in self._address.host else socket.AF_INET
        with socket.socket(family, socket.SOCK_DGRAM) as way:
            way.connect((self._address.host, self._address.port or PORT))  # sends nothing
            own = str(way.getsockname()[0])
        return f"[{own}]" if ":" in own else own


def finished(future: Future, within: float) -> bool:
    """Wait so many seconds; whether it is over by then, well or badly."""
    return bool(future.wait(max(1, int(within * 1000))) != qi.FutureState.Running)


def in_words(text: str, what: str) -> RobotError:
    """Our error for one of `qi`, or of a service of the robot's."""
    if _GONE.search(text):
        return LostConnection(f"{CUT} {HINT}")
    if _NO_SUCH.search(text):
        return NotSupported(f"This Pepper's software has no {what} as it is needed here.")
    return NotPossible(f"Pepper refused {what}: {_reason(text)}. See to that, then try again.")


def _reason(text: str) -> str:
    """What a service gives as its reason: the first line that is not the method's name alone."""
    for line in text.splitlines():
        said = re.sub(r"^\w*Error:", "", line.strip()).strip().rstrip(".")
        if said and not re.fullmatch(r"\w+::\w+", said):
            return said
    return "it does not say why"


def _no_connection(text: str, address: Address, login: Login | None) -> RobotError:
    """What it means that a connection was not made."""
    host = address.host
    if "not found" in text.lower():
        return LostConnection(f"There is no {host} in this network. Check the robot's address.")
    if "disconnected" in text and login is not None:
        return AccessDenied(
            f"{host} let nobody in as {login.user}. Check the name in the address and the password"
            " in NL2ROBOT_ROBOT_PASSWORD."
        )
    if "disconnected" in text:
        return AccessDenied(
            f"{host} hung up. If it is a Pepper that wants a login, write pepper://USER@{host}"
            " and put the password into NL2ROBOT_ROBOT_PASSWORD; else check the address."
        )
    port = address.port or (PORT if login is None else SECURE_PORT)
    login_hint = (
        f" A Pepper with NAOqi 2.9 or later wants a login: write pepper://USER@{host}."
        if login is None and address.port is None
        else ""
    )
    return LostConnection(
        f"No Pepper answers at {host}, port {port}. Check the address, and that Pepper is switched"
        f" on and in the network.{login_hint}"
    )
