"""At what time of day something is to be done, asked back where the words leave it open."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from typing import Final

from grammar.requests import Request, When
from grammar.times.bare_hours import Choice
from grammar.times.said import time_in
from nl2robot.schedule.rhythm import BadRhythm, Rhythm
from nl2robot.schedule.wishes import Unclear, rhythm_of
from nl2robot.schedule.words import in_words, near_moment, times_in_words
from nl2robot.texts import texts_in
from robot_api.capabilities.matching import match_answer

EXAMPLES: Final = {
    None: ("08:00", "14:00", "20:00", "23:59"),
    "am": ("08:00", "11:59"),
    "pm": ("18:00", "23:59"),
    "night": ("22:00", "23:59"),
}
"""Of an answer, by the half of the day that was said, the later ones for who says it late."""
LONGEST_ANSWER: Final = 6
"""Words; more of them are another order."""


@dataclass(frozen=True)
class Timeless:
    """A wish whose time of day is not clear, and the question back."""

    request: Request
    choices: tuple[Choice, ...]
    """The times that it may be; empty if none was said."""
    labels: tuple[str, ...]
    """As they are offered: "08:00"."""
    question: str
    sentences: tuple[str, ...]
    """The whole wish, in words that leave nothing open: with each of the times, or with an
    example."""

    def with_answer(self, said: str, language: str) -> Iterator[str]:
        """The whole wish with what was said for an answer, in the ways in which it may be meant;
        none if that is too much for an answer."""
        if len(said.split()) > LONGEST_ANSWER:
            return
        chosen = match_answer(said, list(self.labels), language) if self.labels else None
        if chosen in self.labels:
            yield self.sentences[self.labels.index(chosen)]
            return
        time = time_in(said, language)
        fitting = [at for at, each in enumerate(self.choices) if time in each]
        if len(fitting) == 1:
            yield self.sentences[fitting[0]]
            return
        answer, at = said.strip(" .,!?"), str(texts_in(language, "schedules")["at"])
        yield f"{self.request.part} {answer} {self.request.sentence}"
        yield f"{self.request.part} {at.format(times=answer)} {self.request.sentence}"


def asked_for(request: Request, now: float, zone: str, language: str) -> Rhythm | Timeless:
    """At what times it is to be done. Raises `BadRhythm`."""
    assert request.when is not None
    found = rhythm_of(request.when, now, zone)
    if not isinstance(found, Unclear):
        return found
    texts = texts_in(language, "schedules")
    rhythms = [_chosen(request.when, now, zone, times) for times in found.choices]
    rhythms = rhythms or [_example(request.when, now, zone)]
    labels: tuple[str, ...] = ()
    if not found.choices:
        question = str(texts["what_time"])
    elif len(found.choices[0]) == 1 and all(each.rule is None for each in rhythms):
        labels = tuple(times[0] for times in found.choices)
        days = {each.begins.date() for each in rhythms}
        either = (
            labels if len(days) == 1 else [near_moment(each, language, now) for each in rhythms]
        )
        question = str(texts["which_time"]).format(times=f" {texts['or']} ".join(either))
    else:
        labels = tuple(times_in_words(times, language) for times in found.choices)
        question = str(texts["which_time"]).format(times=f" {texts['or']} ".join(labels))
    whole = tuple(f"{in_words(each, language)} {request.sentence}" for each in rhythms)
    return Timeless(request, found.choices, labels, question, whole)


def _chosen(when: When, now: float, zone: str, times: Choice) -> Rhythm:
    chosen = rhythm_of(when, now, zone, times=times)
    assert isinstance(chosen, Rhythm)
    return chosen


def _example(when: When, now: float, zone: str) -> Rhythm:
    """At some time of day that is still to come. Raises `BadRhythm` if none is."""
    *examples, last = EXAMPLES[when.half]
    for time in examples:
        with suppress(BadRhythm):
            return _chosen(when, now, zone, (time,))
    return _chosen(when, now, zone, (last,))
