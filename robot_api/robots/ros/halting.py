"""The stop that the robot confirms.

Everything that could move it is told to end, on the connection that is for nothing else: every goal
is cancelled, and its velocity is set to zero, again and again. Then it is asked something: what it
says after that answer, it says after the stop, however slow the network is. It stands when its
action servers have said that they pursue nothing more, and its odometry has said twice that it
stands.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence

from robot_api.errors import LostConnection, StopNotConfirmed
from robot_api.robots.ros.actions import Action, Cancelling
from robot_api.robots.ros.wheels import Wheels
from robot_api.robots.ros.wire import Answer

_AGAIN = 0.05
"""Seconds between two orders to stand."""
_CANCEL_AGAIN = 0.5
"""Seconds after which an action server that has not answered is told again."""


class Halting:
    """`still` sets the velocity to zero and `ask` asks something, both on the connection for
    stopping; `wheels` is None for a robot without a base that we could drive."""

    def __init__(
        self,
        actions: Sequence[Action],
        ask: Callable[[], Answer],
        still: Callable[[], None] | None,
        wheels: Wheels | None,
        within: float,
    ) -> None:
        self._actions = actions
        self._ask = ask
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
            cancels = [[action.cancel_all()] for action in self._actions]
            answer, answered = self._ask(), None
            while answered is None or not self._is_over(cancels, answered):
                now = time.monotonic()
                if now >= end:
                    raise StopNotConfirmed()
                if answered is None and (answer.ok or answer.said):
                    answered = now
                if now - cancelled > _CANCEL_AGAIN:
                    cancelled = now
                    for action, tries in zip(self._actions, cancels, strict=True):
                        tries.append(action.cancel_all())
                self._pause(min(_AGAIN, end - now))
                self._stand()
        except LostConnection:
            raise StopNotConfirmed() from None

    def _stand(self) -> None:
        if self._still is not None:
            self._still()

    def _is_over(self, cancels: Sequence[Sequence[Cancelling]], answered: float) -> bool:
        stands = self._wheels is None or self._wheels.stands_since(answered)
        return stands and all(any(one.confirmed(answered) for one in tries) for tries in cancels)

    def _pause(self, seconds: float) -> None:
        if self._wheels is None:
            time.sleep(seconds)
        else:
            self._wheels.wait(seconds)
