"""What can go wrong when a robot is asked to do something.

    RobotError                 an `except Exception` in a program may catch these
    ├── UnknownPlace           no place of that name in this world
    ├── UnknownPerson          no person of that name in this world
    ├── NotFound               the thing or person is not here, or not to be seen
    ├── NotPossible            cannot be done now (nothing in the hand, hands full, ...)
    ├── Blocked                the way is blocked and there is no other
    ├── TimedOut               nothing happened in the time allowed
    ├── NotSupported           this robot cannot do that at all
    ├── InvalidCall            no such method, or parameters of the wrong kind
    ├── AccessDenied           not allowed: not approved, a wrong token, another operator drives
    │   └── NotTrusted         the certificate of the server is from nobody that is trusted here
    ├── InternalError          a fault of the robot's own software; the log has the details
    ├── StopNotConfirmed       it was told to stop and has not said that it stands
    └── LostConnection         the robot cannot be reached any more
    Stopped                    a BaseException: no `except Exception` in a program swallows a stop

Every message is one sentence a nurse understands. On the wire an error carries its class name in
`error.data.error` (see `robot_api.protocol`); `error_named` turns that name back into the class.
"""

from __future__ import annotations


class RobotError(Exception):
    """The robot could not do what it was asked; the message says why in one sentence."""

    code = -32000  # the JSON-RPC error code; the kinds use -32001 and below


class UnknownPlace(RobotError):
    code = -32001


class UnknownPerson(RobotError):
    code = -32002


class NotFound(RobotError):
    code = -32003


class NotPossible(RobotError):
    code = -32004


class Blocked(RobotError):
    code = -32005


class TimedOut(RobotError):
    code = -32006


class NotSupported(RobotError):
    code = -32007


class InvalidCall(RobotError):
    code = -32602  # JSON-RPC "invalid params"


class AccessDenied(RobotError):
    code = -32008


class NotTrusted(AccessDenied):
    """The server's certificate is not to be trusted; raised by a client, never sent."""


class LostConnection(RobotError):
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
