"""What a robot file may say of a Pepper, in its section `pepper`."""

from __future__ import annotations

from typing import Literal

import msgspec


class PepperSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    map: str | None = None
    """The exploration that the robot finds its way by: the file on the robot that
    `ALNavigation.saveExploration` named. None: it drives without a map."""
    autonomous_life: Literal["off", "keep"] = "off"
    """Whether Pepper's own autonomous life is switched off for as long as it is driven from here,
    and switched on again afterwards."""
    animated_speech: bool = False
    """Whether Pepper moves its arms while it speaks."""
    joint_speed: float = 0.2
    """Share of a joint's greatest speed, 0 to 1."""
    face_page: str | None = None
    """The address of this server's page /face, as the robot's tablet reaches it, with the
    operator's token: it is shown there while the robot is driven from here. None: texts and buttons
    are shown on the tablet as they are, without a face."""
