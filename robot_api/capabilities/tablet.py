"""A real tablet on the robot, beside the people that are only simulated: what the capabilities ask
of it.

`ComposedDriver.attach` gives a robot one. While it is connected, whoever stands before it touches,
types and takes calls; a robot without one has `NO_TABLET`, and does what it does by itself.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal, Protocol

from robot_api.capabilities.sound import Asked
from robot_api.driver import StopFlag

Act = Literal["click", "type"]
"""What is done to an element of the shown page."""


class Tablet(Protocol):
    """Any thread may call any of it."""

    @property
    def connected(self) -> bool:
        """Whether somebody can see it now."""
        ...

    def answer(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        """What somebody touches or types within `timeout` real seconds: one of the options exactly,
        or words; None if nobody does, or if the tablet is gone. Raises `Stopped`."""
        ...

    def page(self) -> str | None:
        """The page of HTML that it shows, as it is now, with what people typed into it; None if it
        is as it was shown."""
        ...

    def act(self, stop: StopFlag, act: Act, selector: str, text: str) -> str | None:
        """Do it to the first such element of the page that is shown; the page as it is then, or
        None if it was not done. Raises `Stopped`."""
        ...

    def ring(self, stop: StopFlag, contact: str, over: Callable[[], None]) -> bool:
        """Call, and return True when somebody answers; `over` is called when they end the call.
        False if nobody could be rung up. Raises `TimedOut`, `NotPossible` and `Stopped`."""
        ...

    def hang_up(self) -> None:
        """End the call, if there is one."""
        ...


class _NoTablet:
    connected = False

    def answer(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
        return None

    def page(self) -> str | None:
        return None

    def act(self, stop: StopFlag, act: Act, selector: str, text: str) -> str | None:
        return None

    def ring(self, stop: StopFlag, contact: str, over: Callable[[], None]) -> bool:
        return False

    def hang_up(self) -> None:
        """There is no call."""


NO_TABLET: Tablet = _NoTablet()
