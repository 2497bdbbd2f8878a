"""Who may do what: the one table that the wire, the pages and their test go by.

A role has rights, and each method on the wire and each page needs one of them: a robot method
`drive`, a service what it says itself (`robot_api.server.Service`), a page what its server says.
"""

from __future__ import annotations

from typing import Final, Literal, get_args

Role = Literal["face", "observer", "assistant", "operator", "administrator"]
"""What somebody is to a robot: the tablet on it, who looks on, a program that proposes, who works
with it, who also decides who else may."""

Right = Literal["know", "look", "face", "propose", "operate", "drive", "administer"]
"""know: stop the robot, and be told what everybody may be. look: see all that goes on and went on.
face: be touched, typed at and called in the robot's place. propose: have programs written and
checked, and lay them before somebody who decides. operate: approve and run them, draw on the map.
drive: call the robot's own methods. administer: accounts."""

ROLES: Final[tuple[Role, ...]] = get_args(Role)
PAIRED: Final[tuple[Role, ...]] = ("face", "observer", "operator")
"""The roles that a device can have by itself; to administer takes a person."""
PERSONAL: Final[tuple[Role, ...]] = ("observer", "operator", "administrator")
"""The roles that a person can have."""
RIGHTS: Final[dict[Role, frozenset[Right]]] = {
    "face": frozenset({"know", "face"}),
    "observer": frozenset({"know", "look"}),
    "assistant": frozenset({"know", "look", "propose"}),
    "operator": frozenset({"know", "look", "face", "propose", "operate", "drive"}),
    "administrator": frozenset(get_args(Right)),
}
OF_THE_PROTOCOL: Final = frozenset({"robot.stop", "robot.capabilities", "rpc.discover"})
"""Methods that need no more than to be known: anybody may stop the robot."""
TOLD_TO_FACES: Final = frozenset(
    {
        *("face", "face.act", "call.signal", "call.state", "sound", "silence"),
        *("link", "stopping", "stopped", "stop_not_confirmed"),
        "schedule.buttons",
    }
)
"""The events that whoever may not look is told of: a tablet stands where visitors are."""


def may(role: Role, right: Right) -> bool:
    """Whether the role has the right."""
    return right in RIGHTS[role]


def may_hear(role: Role, event: str) -> bool:
    """Whether the role may be told of this kind of event."""
    return may(role, "look") or event in TOLD_TO_FACES
