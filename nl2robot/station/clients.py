"""A connection to the server of a station, for whoever asks it something."""

from __future__ import annotations

from nl2robot.errors import ExitStatus, UserError
from robot_api.client import Robot
from robot_api.errors import AccessDenied, NotTrusted


def client_of(address: str, token: str | None) -> Robot:
    """Raises `UserError` if it lets nobody in like this."""
    try:
        return Robot(address, token=token)
    except NotTrusted as error:
        raise UserError(str(error), ExitStatus.NO_ROBOT) from error
    except AccessDenied as error:
        raise UserError(f"{error} Give the token with --token.", ExitStatus.NO_ROBOT) from error
