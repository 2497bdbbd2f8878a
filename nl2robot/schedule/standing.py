"""From what words say may happen to what begins an appointment, and what is asked back of them:
"when somebody comes" may be each time, or the next time alone."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

import msgspec

from grammar.requests import Request
from grammar.standing_orders.happenings import Happening
from nl2robot.schedule.triggers import SHORTEST, Trigger, checked
from nl2robot.texts import texts_in
from robot_api.capabilities.matching import match_answer

LONGEST_ANSWER: Final = 6
"""Words; more of them are another order."""


@dataclass(frozen=True)
class Doubtful:
    """An order of which it was asked whether it is meant each time."""

    order: Request
    utterance: str

    def each_time(self, said: str, language: str) -> bool | None:
        """What was answered; None if that is no answer."""
        if len(said.split()) > LONGEST_ANSWER:
            return None
        choices = choices_in(language)
        chosen = match_answer(said, list(choices), language)
        return None if chosen not in choices else chosen == choices[0]


def question_in(language: str) -> str:
    """Whether it is meant each time."""
    return str(texts_in(language, "schedules")["each_time"]["question"])


def choices_in(language: str) -> tuple[str, str]:
    """The answers: each time, or only once."""
    texts = texts_in(language, "schedules")["each_time"]
    return str(texts["each"]), str(texts["once"])


def is_for_sure(happening: Happening) -> bool:
    """Whether it can only be meant each time; else it may be about the next time alone, as "when
    you get to the lobby" in an errand is."""
    return not happening.once


def may_be_each_time(happening: Happening) -> bool:
    """Whether somebody who speaks of a single time may mean every one: not where the robot is sent
    itself, and not of somebody by name."""
    return happening.what != "place" and not happening.named


def trigger_of(happening: Happening) -> Trigger:
    """Raises `BadTrigger` for what could never happen."""
    trigger = Trigger(
        what=happening.what,
        text=happening.text,
        thing=happening.thing,
        place=happening.place,
        below=happening.below,
    )
    if happening.rate is not None:
        trigger = msgspec.structs.replace(trigger, every=max(SHORTEST, happening.rate))
    return checked(trigger)
