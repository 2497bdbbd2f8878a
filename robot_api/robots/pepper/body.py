"""Whether Pepper can move, and why not: awake, autonomous life, the charging flap, what is in its
way."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from contextlib import suppress
from typing import Any, Final, Literal

from robot_api.capabilities.base import Turns
from robot_api.driver import StopFlag
from robot_api.errors import NotPossible, RobotError, StopNotConfirmed
from robot_api.robots.pepper.line import finished
from robot_api.robots.pepper.session import Ending, Wire

STOP_WITHIN: Final = 2.0
"""Seconds in which Pepper stands after a stop: from its greatest speed it needs about one."""
STOP_MOVING: Final[Ending] = ("ALMotion", "stopMove")
STOP_LIMBS: Final[Ending] = ("ALMotion", "killAll")
STOP_SPEAKING: Final[Ending] = ("ALTextToSpeech", "stopAll")
_STANDS: Final = 0.001
"""Metres and radians a second below which it counts as standing."""
_ASKS_EVERY: Final = 0.005
"""Seconds between two questions whether it stands."""

_FLAP: Final = "Device/SubDeviceList/Platform/ILS/Sensor/Value"
"""1 while the charging flap is open: Pepper's wheels are locked then."""
_SONARS: Final = {
    "front": "Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value",
    "back": "Device/SubDeviceList/Platform/Back/Sonar/Sensor/Value",
}
_NEAR: Final = 0.6
"""Metres; what is nearer than this may be what stopped it."""
_SETTLES_WITHIN: Final = 15.0
"""Seconds that lying down to rest may take."""

Life = Literal["off", "keep"]


class Body:
    """What the parts that move have in common."""

    def __init__(self, wire: Wire, life: Life = "off") -> None:
        self._wire = wire
        self._life = life
        self._taking = Turns()
        self._taken = False
        self._life_before = "disabled"
        self._was_asleep = False

    # --- begin and end ---------------------------------------------------------------------------

    def take(self, stop: StopFlag) -> None:
        """Take the robot, the first time that it is called: its autonomous life off, itself awake.
        Until then it is left as it was found."""
        with self._taking.mine(stop):
            if self._taken:
                return
            if self._life == "off" and self._wire.has("ALAutonomousLife"):
                state = self._life_state()
                if state != "disabled":
                    self._life_before = state
                    self._wire.run(stop, "ALAutonomousLife", "setState", "disabled")
            if not self._awake():
                self._was_asleep = True
                self._wake(stop)
            self._taken = True

    def found_again(self) -> None:
        """It was lost, and may have been started anew meanwhile. Raises `StopNotConfirmed`."""
        self.stand_still()
        self._taken = False

    def give_back(self) -> None:
        """Leave it as it was before: asleep, or living by itself."""
        with suppress(RobotError):
            if self._life_before != "disabled":
                # The other states of life are entered from this one, by itself.
                self._wire.call("ALAutonomousLife", "setState", "solitary", within=_SETTLES_WITHIN)
            elif self._was_asleep:
                self._wire.call("ALMotion", "rest", within=_SETTLES_WITHIN)

    # --- before and after a movement -------------------------------------------------------------

    def be_ready(self, stop: StopFlag, *, to_drive: bool) -> None:
        """Get ready to move. Raises `NotPossible` with what hinders it."""
        if to_drive and self._flap_open():
            raise NotPossible(
                "My charging flap is open, and then my wheels are locked."
                " Take out the cable and close the flap, then send me again."
            )
        if self._life == "off" and self._wire.has("ALAutonomousLife"):
            state = self._life_state()
            if state != "disabled":
                raise NotPossible(
                    "Somebody has switched my autonomous life on, which moves me by itself."
                    " Switch it off, or start my server again."
                )
        if not self._awake():
            self._wake(stop)

    def in_the_way(self, direction: Literal["front", "back"] | None = None) -> str:
        """Why a movement has ended early, in a sentence; looks where it was going to, if that is
        known."""
        if self._flap_open():
            return "My charging flap is open. Close it, then send me again."
        seen = {side: self._metres(side) for side in _SONARS if direction in (None, side)}
        near = {side: metres for side, metres in seen.items() if metres < _NEAR}
        if near:
            side = min(near, key=near.__getitem__)
            where = "in front of me" if side == "front" else "behind me"
            return f"Something is {near[side]:.1f} m {where}. Clear the way, then send me again."
        return "I could not go on, though I see nothing in my way. Look what stops me."

    # --- rest ------------------------------------------------------------------------------------

    def stand_still(self) -> None:
        """Stop wheels, limbs and voice at once; returns when the robot has confirmed that it
        stands. Raises `StopNotConfirmed`."""
        until = time.monotonic() + STOP_WITHIN
        try:
            begun = [self._wire.begin_stop(*each) for each in (STOP_MOVING, STOP_LIMBS)]
            if self._wire.has("ALTextToSpeech"):
                self._wire.begin_stop(*STOP_SPEAKING)
            for each in begun:
                if not finished(each, until - time.monotonic()):
                    raise StopNotConfirmed()
            while not self._stands(until - time.monotonic()):
                if time.monotonic() > until:
                    raise StopNotConfirmed()
                time.sleep(_ASKS_EVERY)
        except StopNotConfirmed:
            raise
        except (RobotError, TypeError, ValueError):  # or it answers with nonsense
            raise StopNotConfirmed() from None

    def _stands(self, within: float) -> bool:
        velocity: Sequence[Any] = self._wire.call_stop("ALMotion", "getRobotVelocity", within)
        if not all(math.isfinite(part) and abs(part) < _STANDS for part in velocity):
            return False
        return not self._wire.call_stop("ALMotion", "moveIsActive", within)

    # --- what it says of itself ------------------------------------------------------------------

    def _wake(self, stop: StopFlag) -> None:
        self._wire.run(stop, "ALMotion", "wakeUp", ending=(STOP_LIMBS,))

    def _awake(self) -> bool:
        return bool(self._wire.call("ALMotion", "robotIsWakeUp"))

    def _life_state(self) -> str:
        return str(self._wire.call("ALAutonomousLife", "getState"))

    def _flap_open(self) -> bool:
        return bool(self._memory(_FLAP) == 1)

    def _metres(self, side: str) -> float:
        value = self._memory(_SONARS[side])
        return float(value) if isinstance(value, int | float) else math.inf

    def _memory(self, key: str) -> Any:
        """What the robot's memory holds there; None if it knows no such."""
        try:
            return self._wire.call("ALMemory", "getData", key)
        except NotPossible:
            return None
