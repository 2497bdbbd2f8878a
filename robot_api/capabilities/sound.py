"""What a robot that has no body here can be given instead of one: a loudspeaker, ears, and people
who can be heard.

Without them the emulated and the simulated robot publish what they say, and are told in words what
people answer. With them it is spoken and heard.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from robot_api.driver import StopFlag

if TYPE_CHECKING:
    from collections.abc import Iterator

    from robot_api.capabilities.base import Listener


@dataclass(frozen=True)
class Asked:
    """What is listened for."""

    language: str
    question: str | None = None
    options: Sequence[str] | None = None
    """The answers that count, where not any does."""
    person: str | None = None
    """Who is asked, where it is not anybody."""


@dataclass(frozen=True)
class Unsure:
    """Words that were heard badly, and the option that they probably were."""

    words: str
    perhaps: str


class Loudspeaker(Protocol):
    def speaking(
        self, stop: StopFlag, text: str, language: str, volume: int
    ) -> AbstractContextManager[None]:
        """It is spoken from the beginning of the `with` block on; the end of the block waits until
        all of it was heard, an error in it falls silent. Silent within 100 ms once `stop` is set,
        and then raises `Stopped`. `volume` is 0 to 100."""
        ...


class Ears(Protocol):
    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | Unsure | None:
        """The words of whoever begins to speak within `timeout` seconds, or None; where there are
        options, perhaps `Unsure`, and then the robot asks whether that was it. Raises
        `Stopped`."""
        ...


Microphone = Callable[[], AbstractContextManager[Iterable[bytes]]]
"""One of the robot's own: opens it and gives blocks of its sound for as long as it is open, 16-bit
samples, the lower byte first, one channel, 16 kHz; an empty block while there is nothing new.
Raises a `RobotError` when it gives none."""


class Voices(Protocol):
    def heard(self, stop: StopFlag, person: str, words: str, asked: Asked) -> str | None:
        """The robot's ears' account of it when a person who is simulated says these words. Raises
        `Stopped`."""
        ...


def _nothing() -> None: ...


def _as_written(text: str, language: str) -> str:
    return text


@dataclass(frozen=True)
class Sound:
    """What there is of it."""

    loudspeaker: Loudspeaker | None = None
    ears: Ears | None = None
    """Somebody real answers the robot."""
    ears_at: Callable[[Microphone], Ears] | None = None
    """Makes ears of a robot's own microphone."""
    voices: Voices | None = None
    """The simulated people answer aloud."""
    subscribe: Callable[[Listener], object] | None = None
    """Where clients play what is said: subscribes to the events `sound` and `silence`."""
    give_way: Callable[[], None] = _nothing
    """Ends what the robot is saying, for somebody speaks to it; its program goes on."""
    spoken: Callable[[str, str], str] = _as_written
    """A text, and its language, in the words in which any voice is to speak it: the server's, or
    the robot's own. What is shown and logged stays as it is written."""

    def publish_to(self, listener: Listener) -> None:
        """Let it hear what clients are to play, if there is any."""
        if self.subscribe is not None:
            self.subscribe(listener)

    @contextmanager
    def speaking(self, stop: StopFlag, text: str, language: str, volume: int) -> Iterator[None]:
        """As `Loudspeaker.speaking`, silently where there is none."""
        if self.loudspeaker is None:
            yield
            return
        with self.loudspeaker.speaking(stop, self.spoken(text, language), language, volume):
            yield


SILENT = Sound()
