"""What people may answer to a question, and which answer they gave.

    expected = expect("digits", "en")            # or "yes-no", or "radiology, pharmacy"
    answer = hear_answer(recogniser, audio, expected)

How people say yes and what they say around an option is data: data/answers.yaml.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from nl2robot.errors import UserError
from nl2robot.speech.audio import Audio
from nl2robot.speech.recogniser import PUNCTUATION, Recogniser
from nl2robot.speech.vocabulary import number_words, spell_numbers

# Free words always find something to fit so short a sound, so an answer is only doubted when they
# fit far better: with the commands' limit, one right digit in sixteen was.
WORST_FIT = -0.15


@dataclass(frozen=True)
class Answer:
    """What was said in answer to a question."""

    heard: str  # empty for silence
    answer: str | None  # as the question has it; None: nothing heard, no answer, or two at once
    confidence: float  # 0..1; 0 where there is no answer


@dataclass(frozen=True)
class Expected:
    """What may be answered: the sayings, and which answer some words are."""

    phrases: tuple[str, ...]
    read: Callable[[str], str | None]


def expect(what: str | Sequence[str], language: str) -> Expected:
    """`what` is "digits", "yes-no", options as "a, b, c", or a list of options.

    Digits may come in a row; they are answered as numerals ("407"). Raises UserError if there is
    nothing to choose from.
    """
    if what == "digits":
        return _digits(language)
    sayings = _sayings(language)
    if what == "yes-no":
        return _choice({said: answer for answer in ("yes", "no") for said in sayings[answer]})
    options = what.split(",") if isinstance(what, str) else what
    options = [option.strip() for option in options if option.strip()]
    if not options:
        raise UserError(
            "There is nothing to choose from. "
            'Say what may be answered: digits, yes-no, or options such as "tea, coffee".'
        )
    spoken = {spell_numbers(option, language): option for option in options}
    around = [pattern.format(said) for said in spoken for pattern in sayings["around"]]
    return _choice(spoken, around)


def hear_answer(recogniser: Recogniser, audio: Audio, expected: Expected) -> Answer:
    """Which of the expected answers is given in `audio`."""
    heard = recogniser.recognise(audio, expected.phrases, worst_fit=WORST_FIT)
    answer = None if heard.doubtful else expected.read(heard.text)
    said = heard.free_text if heard.doubtful else heard.text
    return Answer(said or heard.text, answer, heard.confidence if answer is not None else 0.0)


def _digits(language: str) -> Expected:
    words = {number_words(str(digit), language): str(digit) for digit in range(10)}

    def read(text: str) -> str | None:
        return "".join(words[word] for word in text.split()) or None

    return Expected(tuple(words), read)


def _choice(spoken: dict[str, str], around: Sequence[str] = ()) -> Expected:
    """One of several: `spoken` is what is said -> the answer that it means."""
    sayings = {_words(said): answer for said, answer in spoken.items()}

    def read(text: str) -> str | None:
        heard = _words(text)
        return _only(_said(heard, sayings) or _nearest(heard, sayings))

    return Expected((*spoken, *around), read)


Words = tuple[str, ...]


def _said(heard: Words, sayings: dict[Words, str]) -> set[str]:
    """The answers of the sayings among these words."""
    answers, at = set(), 0
    longest = max(map(len, sayings))
    while at < len(heard):
        # The longest saying wins: "i do not" is not "i do", "green tea" is not "tea".
        lengths = range(min(len(heard) - at, longest), 0, -1)
        here = next((n for n in lengths if heard[at : at + n] in sayings), 0)
        if here:
            answers.add(sayings[heard[at : at + here]])
        at += here or 1
    return answers


def _nearest(heard: Words, sayings: dict[Words, str]) -> set[str]:
    """The answers of which most was said: "intensive care" for "intensive care unit"."""
    share = {said: len({*said} & {*heard}) / len(said) for said in sayings}
    most = max(share.values())
    return {answer for said, answer in sayings.items() if share[said] == most > 0.5}


def _only(answers: set[str]) -> str | None:
    return next(iter(answers)) if len(answers) == 1 else None


def _words(text: str) -> Words:
    """As the recogniser gives them, hyphens or not."""
    words = (word.strip(PUNCTUATION) for word in text.lower().replace("-", " ").split())
    return tuple(filter(None, words))


@cache
def _sayings(language: str) -> dict[str, Any]:
    path = Path(__file__).parents[1] / "data" / "answers.yaml"
    sayings: dict[str, dict[str, Any]] = yaml.safe_load(path.read_text("utf-8"))
    return sayings.get(language, sayings["en"])
