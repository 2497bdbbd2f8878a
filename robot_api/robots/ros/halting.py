"""The stop that the robot confirms.

Everything that could move it is told to end, on the connection that is for nothing else: every goal
is cancelled, and its velocity is set to zero, again and again. It stands when its action servers
have said that they cancel and its odometry has said twice, since then, that it stands.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from robot_api.errors import LostConnection, StopNotConfirmed
from robot_api.robots.ros.actions import Action
from robot_api.robots.ros.wheels import Wheels

_AGAIN = 0.05
"""Seconds between two orders to stand."""
_CANCEL_AGAIN = 0.5
"""Seconds after which an action server that has not answered is told again."""


class Halting:
    """`still` sets the velocity to zero on the connection for stopping; `wheels` is None for a
    robot without a base that we could drive."""

    def __init__(
        self,
        actions: Sequence[Action],
        still: Callable[[], None] | None,
        wheels: Wheels | None,
        within: float,
    ) -> None:
        self._actions = actions
        self._still = still
        self._wheels = wheels
        self._within = within

    def halt(self) -> None:
        """Returns when the robot has confirmed that it stands; raises `StopNotConfirmed` if it has
        not in time, or cannot be reached."""
        began = time.monotonic()
        end = began + self._within
        try:
            self._stand()
            cancelled = began
            cancels = [action.cancel_all() for action in self._actions]
            while not (all(cancel.confirmed for cancel in cancels) and self._stands(began)):
                now = time.monotonic()
                if now >= end:
                    raise _not_confirmed()
                if now - cancelled > _CANCEL_AGAIN:
                    cancelled = now
                    cancels = [
                        cancel if cancel.confirmed else action.cancel_all()
                        for action, cancel in zip(self._actions, cancels, strict=True)
                    ]
                self._pause(min(_AGAIN, end - now))
                self._stand()
        except LostConnection:
            raise _not_confirmed() from None

    def _stand(self) -> None:
        if self._still is not None:
            self._still()

    def _stands(self, began: float) -> bool:
        return self._wheels is None or self._wheels.stands_since(began)

    def _pause(self, seconds: float) -> None:
        if self._wheels is None:
            time.sleep(seconds)
        else:
            self._wheels.wait(seconds)


def _not_confirmed() -> StopNotConfirmed:
    return StopNotConfirmed(
        "The robot has not confirmed that it stands. Use the robot's own button."
    )
