"""A real tablet on the robot, beside the people that are only simulated: what the capabilities ask
of it.

`ComposedDriver.attach` gives a robot one. While it is connected, whoever stands before it touches,
types and takes calls; a robot without one has `NO_TABLET`, and does what it does by itself.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Final, Literal, Protocol, TypeVar

from robot_api.capabilities.sound import Asked
from robot_api.driver import StopFlag
from robot_api.errors import Stopped

T = TypeVar("T")

_LOOKS_EVERY: Final = 0.1
"""Seconds."""

Act = Literal["click", "type"]
"""What is done to an element of the shown page."""


class Tablet(Protocol):
    """Any thread may call any of it."""

    @property
    def connected(self) -> bool:
        """Whether somebody can see it now."""
        ...

    @property
    def helped(self) -> bool:
        """Whether somebody elsewhere may answer for whoever is asked, also while nobody sees it."""
        ...

    def called(self, options: Sequence[str], language: str) -> Sequence[str]:
        """What the options are called on it in a language, one after the other: whoever reads that
        may say it as well."""
        ...

    def answer(self, stop: StopFlag, asked: Asked) -> str | None:
        """What somebody touches or types before `stop` is set: one of the options exactly, or
        words; None if the tablet is gone, and nobody helps. Raises `Stopped`."""
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
    helped = False

    def called(self, options: Sequence[str], language: str) -> Sequence[str]:
        return options

    def answer(self, stop: StopFlag, asked: Asked) -> str | None:
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


def answered(
    stop: StopFlag, tablet: Tablet, asked: Asked, meanwhile: Callable[[StopFlag], T]
) -> tuple[str | None, T | None]:
    """What is touched or typed while the robot does something else, such as to ask and to listen;
    or else what came of that. The first who has an answer breaks the other off. Raises `Stopped`,
    and what `meanwhile` raises."""
    hand, rest = StopFlag(), StopFlag()
    for flag in (hand, rest):
        stop.on_set(flag.set)

    def in_its_thread() -> T | None:
        try:
            return meanwhile(rest)
        except Stopped:
            return None
        finally:
            hand.set()

    with ThreadPoolExecutor(1, thread_name_prefix="meanwhile") as threads:
        result = threads.submit(in_its_thread)
        try:
            touched = tablet.answer(hand, asked)
        except Stopped:
            touched = None
        if touched is not None:
            rest.set()
    stop.check()
    return (touched, None) if touched is not None else (None, result.result())


def patience(stop: StopFlag, tablet: Tablet, seconds: float) -> None:
    """Give people time, while there is a tablet to touch. Raises `Stopped`."""
    end = time.monotonic() + seconds
    while time.monotonic() < end and tablet.connected:
        stop.wait(_LOOKS_EVERY)
        stop.check()
