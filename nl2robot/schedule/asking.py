"""At what time of day something is to be done, asked back where the words leave it open."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from grammar.requests import Request
from nl2robot.schedule.rhythm import Rhythm
from nl2robot.schedule.wishes import Unclear, rhythm_of
from nl2robot.schedule.words import in_words
from nl2robot.texts import texts_in
from robot_api.capabilities.matching import match_answer

EXAMPLE: Final = "08:00"
LONGEST_ANSWER: Final = 6
"""Words; more of them are another order."""


@dataclass(frozen=True)
class Timeless:
    """A wish whose time of day is not clear, and the question back."""

    request: Request
    times: tuple[str, ...]
    """Those that it may be; empty if none was said."""
    question: str
    sentences: tuple[str, ...]
    """The whole wish, in words that leave nothing open: with each of the times, or with an
    example."""

    def with_answer(self, said: str, language: str) -> str | None:
        """The whole wish, with what was said for an answer; None if that is too much for one."""
        if len(said.split()) > LONGEST_ANSWER:
            return None
        chosen = match_answer(said, list(self.times), language) if self.times else None
        if chosen in self.times:
            return self.sentences[self.times.index(chosen)]
        return f"{self.request.part} {said.strip(' .,!?')} {self.request.sentence}"


def asked_for(request: Request, now: float, zone: str, language: str) -> Rhythm | Timeless:
    """At what times it is to be done. Raises `BadRhythm`."""
    assert request.when is not None
    found = rhythm_of(request.when, now, zone)
    if not isinstance(found, Unclear):
        return found
    texts = texts_in(language, "schedules")
    if found.times:
        either = f" {texts['or']} ".join(found.times)
        question = str(texts["which_time"]).format(times=either)
    else:
        question = str(texts["what_time"])
    whole = []
    for time in found.times or (EXAMPLE,):
        chosen = rhythm_of(request.when, now, zone, time=time)
        assert isinstance(chosen, Rhythm)
        whole.append(f"{in_words(chosen, language)} {request.sentence}")
    return Timeless(request, found.times, question, tuple(whole))
