"""What a robot may do at most, as its driver or its robot file says: held at review, and again at
each call.

What is beyond a limit is refused with a sentence; only what is too loud is done less loudly, and
that is said.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import msgspec

from robot_api.capabilities.names import listed, one_of
from robot_api.driver import Capabilities
from robot_api.errors import InvalidCall, NotSupported
from robot_api.robots.robot_file import RobotFile

_PACE = ("speed", "turn_rate", "acceleration")
_DRIVES = {
    "linear": ("speed", "drives at {most:g} metres a second at most, not at {asked:g}"),
    "angular": ("turn_rate", "turns by {most:g} degrees a second at most, not by {asked:g}"),
}
"""Of `drive`: each parameter with its limit, and what is said of it."""


def held(capabilities: Capabilities, file: RobotFile) -> Capabilities:
    """What a robot can do that is held to its file. Raises `NotSupported` for a joint that it
    lacks, or that cannot turn as far as the file says it must."""
    joints = dict(capabilities.joints)
    for name, (least, most) in file.joints.items():
        trouble = trouble_with_joint(name, file, capabilities)
        if trouble is not None:
            raise NotSupported(trouble)
        known = str(one_of(name, joints))
        joints[known] = (max(least, joints[known][0]), min(most, joints[known][1]))
    given = msgspec.to_builtins(file.limits)
    return msgspec.structs.replace(
        capabilities,
        name=file.name or capabilities.name,
        joints=joints,
        limits=narrower(
            capabilities.limits, {name: most for name, most in given.items() if most is not None}
        ),
    )


def trouble_with_joint(name: str, file: RobotFile, capabilities: Capabilities) -> str | None:
    """What is wrong with a joint of a robot file, as a sentence; None if nothing is."""
    joints = capabilities.joints
    known = one_of(name, joints)
    if known is None:
        has = listed(tuple(joints), "none")
        return f"The robot has no joint {name!r}. It has {has}. Correct the robot file."
    (least, most), (low, high) = file.joints[name], joints[known]
    if max(least, low) > min(most, high):
        return (
            f"The joint {name!r} of the robot goes from {low:g} to {high:g} degrees, never from"
            f" {least:g} to {most:g}. Correct the robot file."
        )
    return None


def keeps(capabilities: Capabilities, file: RobotFile) -> bool:
    """Whether a robot that holds its limits itself declares those of the file."""
    wanted = held(capabilities, file)
    return (wanted.limits, wanted.joints) == (capabilities.limits, capabilities.joints)


def narrower(one: Mapping[str, float], other: Mapping[str, float]) -> dict[str, float]:
    """Both limits at once."""
    return {
        name: min(limits[name] for limits in (one, other) if name in limits)
        for name in (*one, *(name for name in other if name not in one))
    }


def pace(capabilities: Capabilities) -> dict[str, float]:
    """How fast it drives at most, as `sim.simulation.Simulation.limit_pace` takes it."""
    return {name: most for name, most in capabilities.limits.items() if name in _PACE}


def complaint(method: str, arguments: Mapping[str, Any], capabilities: Capabilities) -> str | None:
    """Why this robot may not do that, as a sentence; None if it may. Arguments that are not known
    yet may be left out."""
    if method == "drive":
        for parameter, (limit, sentence) in _DRIVES.items():
            asked, most = arguments.get(parameter), capabilities.limits.get(limit)
            if isinstance(asked, int | float) and most is not None and abs(asked) > most:
                said = sentence.format(most=most, asked=abs(asked))
                return f"This robot {said}. Choose less."
    if method == "joint":
        name, degrees = arguments.get("name"), arguments.get("degrees")
        joint = one_of(name, capabilities.joints) if isinstance(name, str) else None
        if joint is not None and isinstance(degrees, int | float):
            least, most = capabilities.joints[joint]
            if not least <= degrees <= most:
                bounds = f"from {least:g} to {most:g} degrees"
                return f"The joint {joint} goes {bounds}, not to {degrees:g}."
    return None


def check(method: str, arguments: Mapping[str, Any], capabilities: Capabilities) -> None:
    """Raise `InvalidCall` for what this robot may not do."""
    sentence = complaint(method, arguments, capabilities)
    if sentence is not None:
        raise InvalidCall(sentence)


def loudest(method: str, arguments: Mapping[str, Any], capabilities: Capabilities) -> int | None:
    """The volume that this robot is allowed, in percent, if the call asks for more."""
    percent, most = arguments.get("percent"), capabilities.limits.get("volume")
    if method != "set_volume" or most is None or not isinstance(percent, int) or percent <= most:
        return None
    return int(most)
