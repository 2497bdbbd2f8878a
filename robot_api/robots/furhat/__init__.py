"""A Furhat: a head on a desk that speaks, listens, looks at people and makes faces.

It is spoken to over its Realtime API: JSON messages over a WebSocket, the same that its maker's own
package `furhat-realtime-api` sends. That package is not used: it knows no port but 9000, waits 30
seconds for whatever is said, tells nobody that the robot is gone, and brings a package `asyncio`
that takes the standard library's name. The tests drive our stand-in with it, so that the stand-in
speaks as a Furhat does.

`connection` is one WebSocket, `robot` the robot by two of them (one for stopping alone), `parts`
its capabilities, `driver` what puts them together. docs/robots/furhat.md says what works.
"""

from __future__ import annotations

from typing import Final

from robot_api.robots.furhat.settings import DEFAULT_PORT, FurhatSettings
from robot_api.robots.registry import RobotKind, when_called

FURHAT: Final = RobotKind(
    scheme="furhat",
    title="A Furhat, by its Realtime API",
    example="furhat://HOST",
    connect=when_called("robot_api.robots.furhat.driver:connect"),
    modules=("websockets",),
    port=DEFAULT_PORT,
    section="furhat",
    settings=FurhatSettings,
)
