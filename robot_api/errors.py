"""What can go wrong when a robot is asked to do something.

    RobotError                 an `except Exception` in a program may catch these
    ├── UnknownPlace, UnknownPerson, NotFound, NotPossible, Blocked, TimedOut, NotSupported
    ├── InvalidCall
    ├── AccessDenied
    │   └── NotTrusted
    ├── InternalError
    ├── StopNotConfirmed
    └── LostConnection
    Stopped                    a BaseException: no `except Exception` in a program swallows a stop

Every message is one sentence a nurse understands. On the wire an error carries its class name in
`error.data.error` (see `robot_api.protocol`); `error_named` turns that name back into the class.
"""

from __future__ import annotations


class RobotError(Exception):
    """The robot could not do what it was asked; the message says why in one sentence."""

    code = -32000  # the JSON-RPC error code; the kinds use -32001 and below


class UnknownPlace(RobotError):
    """There is no place of that name in this world."""

    code = -32001


class UnknownPerson(RobotError):
    """There is no person of that name in this world."""

    code = -32002


class NotFound(RobotError):
    """The thing or person is not here, or not to be seen."""

    code = -32003


class NotPossible(RobotError):
    """It cannot be done now: nothing in the hand, hands full, ..."""

    code = -32004


class Blocked(RobotError):
    """The way is blocked, and there is no other."""

    code = -32005


class TimedOut(RobotError):
    """Nothing happened in the time allowed."""

    code = -32006


class NotSupported(RobotError):
    """This robot cannot do that at all."""

    code = -32007


class InvalidCall(RobotError):
    """There is no such method, or a parameter is of the wrong kind."""

    code = -32602  # JSON-RPC "invalid params"


class AccessDenied(RobotError):
    """It is not allowed: not approved, a wrong token, another operator drives."""

    code = -32008


class NotTrusted(AccessDenied):
    """The server's certificate is not to be trusted; raised by a client, never sent."""


class LostConnection(RobotError):
    """The robot cannot be reached any more."""

    code = -32009


class StopNotConfirmed(RobotError):
    """Raised by a stop that the robot has not confirmed: it may still be moving."""

    code = -32011

    def __init__(
        self,
        message: str = "The robot has not confirmed that it stands. Use the robot's own button.",
    ) -> None:
        super().__init__(message)


class InternalError(RobotError):
    """A fault of the robot's own software; the log has the details."""

    code = -32603  # JSON-RPC "internal error"


class Stopped(BaseException):
    """Somebody stopped the robot. A BaseException, so that user code cannot swallow it."""

    code = -32010

    def __init__(self, because: str = "The robot was stopped.") -> None:
        super().__init__(because)
        self.because = because


_BY_NAME: dict[str, type[RobotError] | type[Stopped]] = {
    kind.__name__: kind
    for kind in (
        RobotError,
        UnknownPlace,
        UnknownPerson,
        NotFound,
        NotPossible,
        Blocked,
        TimedOut,
        NotSupported,
        InvalidCall,
        AccessDenied,
        StopNotConfirmed,
        LostConnection,
        InternalError,
        Stopped,
    )
}


def cause(error: BaseException) -> str:
    """What an error of the system or of a library says, for a sentence in brackets: without the
    number that systems give their errors, and in one line."""
    said = getattr(error, "strerror", None) or str(error) or type(error).__name__
    return " ".join(str(said).split())


def error_named(name: str) -> type[RobotError] | type[Stopped]:
    """The class for an error's name on the wire; `RobotError` for a name from a newer server."""
    return _BY_NAME.get(name, RobotError)
