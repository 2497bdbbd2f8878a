"""What an engineer writes down of one robot, in YAML: what it may do, what its parts are called.

    name: The porter
    limits: {speed: 0.5, acceleration: 0.5, turn_rate: 45, volume: 80}
    joints: {head: [-40, 40]}
    speech: robot            # or server, or tablet
    hearing: server
    gestures: {wave: animations/Stand/Gestures/Hey_1}
    ros: {topics: {velocity: /cmd_vel}}    # the section of its wire

Everything may be left out. A section of a wire is read by the wire's own type
(`registry.RobotKind.settings`).
"""

from __future__ import annotations

from typing import Any, Literal

import msgspec

Voice = Literal["robot", "server", "tablet"]
"""Who speaks, or hears: the robot itself, the machine that the server runs on, or a tablet with
the robot's face."""


class Limits(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """What the robot may do at most; held at review and again at the call. None: no limit."""

    speed: float | None = None
    """Metres per second."""
    acceleration: float | None = None
    """Metres per second, per second."""
    turn_rate: float | None = None
    """Degrees per second."""
    volume: float | None = None
    """Percent."""


class RobotFile(msgspec.Struct, frozen=True, kw_only=True):
    name: str | None = None
    """For people: "The porter"."""
    limits: Limits = Limits()
    joints: dict[str, tuple[float, float]] = {}
    """Each joint by the robot's own name, with its least and greatest angle in degrees."""
    speech: Voice | None = None
    """None: the robot where it can, else the server."""
    hearing: Voice | None = None
    gestures: dict[str, str] = {}
    """What programs call them, to the robot's own names."""
    emotions: dict[str, str] = {}
    skills: dict[str, str] = {}
    """The robot's own skills for `do`, each with a line that says what it does."""
    wire: dict[str, Any] = {}
    """The section of its wire ("ros", "pepper" ...), checked against the kind's `settings`."""
