"""What people may answer to a question, and which answer they gave.

    what = expected_by("How many chairs are there?", None, "en")    # "number"
    expected = expect(what, "en")     # or "digits", "yes-no", "times", or "radiology, pharmacy"
    answer = hear_answer(recogniser, audio, expected)

How people say yes, what they say around an option and how questions begin is data:
data/answers.yaml.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from math import exp, log
from typing import Any, Final

from nl2robot.errors import UserError
from nl2robot.speech.audio import Audio
from nl2robot.speech.digits import classifier as digits
from nl2robot.speech.hear.recogniser import PUNCTUATION, Heard, Recogniser
from nl2robot.speech.hear.rescorer import Judged, SecondEar
from nl2robot.speech.hear.vocabulary import number_words, spell_numbers
from nl2robot.texts import texts_in

# Free words always find something to fit so short a sound, so an answer is only doubted when they
# fit far better: with the commands' limit, one right digit in sixteen was.
WORST_FIT = -0.15


UNSURE: Final = 0.6
"""An answer of a smaller share is not taken: the robot asks whether that was it."""
NOT_LISTED: Final = -3.0
"""Log likelihood, next to the likeliest, of an answer that the recogniser does not even list; it
lists what is up to 2 behind."""
BY_WORDS: Final = 0.4
"""Weight of what the recogniser hears next to what single digits sound like. The second ear's
opinion of them adds nothing to that."""
UNSURE_OF_SOUND: Final = 0.9
"""As `UNSURE`, where the recogniser hears nothing and only the sound of a digit is known."""
JUDGED: Final = 8
"""So many texts of the recogniser are judged by the second ear."""
LARGEST: Final = 999
"""Numbers are heard up to this one."""


@dataclass(frozen=True)
class Answer:
    """What was said in answer to a question."""

    heard: str  # empty for silence
    answer: str | None  # as the question has it; None: nothing heard, no answer, or two at once
    confidence: float  # 0..1; 0 where there is no answer
    # The two likeliest answers with their shares (0..1), the likelier first: what to ask about
    # ("Was that five?") where `answer` is None. Empty where nothing like an answer was said.
    likely: tuple[tuple[str, float], ...] = ()


@dataclass(frozen=True)
class Expected:
    """What may be answered: the sayings, and which answer some words are."""

    phrases: tuple[str, ...]
    read: Callable[[str], str | None]
    digits_of: str | None = None
    """The language, where single digits are expected: those are also told by their sound alone."""
    figures: tuple[str, ...] = ()
    """Numbers as they are written; `phrases` has them in words."""
    besides: frozenset[str] = frozenset()
    """Words that may stand around a number."""
    everyday: bool = False
    """The answers are words that fit into much else that people say: "right", "okay", "no"."""

    @cached_property
    def words(self) -> frozenset[str]:
        """Those that answers are made of."""
        phrases = (*self.phrases, *self.figures)
        return self.besides.union(*(map(_words, phrases)))

    def read_alone(self, text: str) -> str | None:
        """As `read`, of what may be no answer at all: a number among other words, as in "one
        handed", is none, for too much of what people say sounds like one."""
        answer = self.read(text)
        return None if self.figures and not self.words.issuperset(_words(text)) else answer


@dataclass(frozen=True)
class _Limit:
    """When an answer is believed that the second ear hears: log likelihoods."""

    behind: float  # what is no answer may be so much likelier ...
    least: float  # ... and so likely it must be


BOTH_HEARD: Final = _Limit(behind=12.0, least=-12.0)
"""Where the recogniser does not doubt the same answer: free words are often wrong of so little."""
BOTH_HEARD_FIGURES: Final = _Limit(behind=8.0, least=-9.0)
"""The same for digits and numbers, of which some sounds like whatever is said."""
ONE_HEARD: Final = _Limit(behind=2.0, least=-4.0)
BY_SOUND: Final = _Limit(behind=12.0, least=-16.0)
"""Of a digit by its sound: an ear that expects sentences may well find it unlikely."""
NEVER_FREELY: Final = _Limit(behind=4.0, least=-7.0)
"""Where both hear one of everyday's words, but neither of them when anything may be said."""


def expected_by(question: str, options: Sequence[str] | None, language: str) -> str | list[str]:
    """What to `expect` in answer to a question, by its options or else by its words: "number",
    "digits", "times", "yes-no", the options, or an empty text where anything may be answered."""
    sayings = _sayings(language)
    if options:
        answers = {" ".join(_words(option)) for option in options}
        both = [{*map(str.lower, sayings[answer])} for answer in ("yes", "no")]
        # "yes" and "no" as they stand are answers in every language, as programs are English.
        if all(answers & ({word} | said) for word, said in zip(("yes", "no"), both, strict=True)):
            return "yes-no" if answers <= {"yes", "no"}.union(*both) else list(options)
        return list(options)
    asked = " ".join(question.lower().replace("’", "'").split())
    for what, pattern in sayings["questions"].items():
        if re.search(pattern, asked):
            return str(what)
    return ""


def expect(what: str | Sequence[str], language: str) -> Expected:
    """`what` is "digits", "number", "times", "yes-no", options as "a, b, c", or a list of options.

    Digits may come in a row; they are answered as numerals ("407"), as numbers are, from 0 to 999;
    times as "3:30". Raises UserError if there is nothing to choose from.
    """
    if what == "digits":
        return _digits(language)
    sayings = _sayings(language)
    if what == "yes-no":
        spoken: dict[str, str | None] = dict.fromkeys(sayings["neither"])
        spoken |= {said: answer for answer in ("yes", "no") for said in sayings[answer]}
        return _choice(spoken, everyday=True)
    if what == "number":
        return _number(language)
    if what == "times":
        return _choice(_times(language), nearest=False)
    options = what.split(",") if isinstance(what, str) else what
    options = [option.strip() for option in options if option.strip()]
    if not options:
        raise UserError(
            "There is nothing to choose from. "
            "Say what may be answered: digits, number, times, yes-no, "
            'or options such as "tea, coffee".'
        )
    spoken = {spell_numbers(option, language): option for option in options}
    around = [pattern.format(said) for said in spoken for pattern in sayings["around"]]
    return _choice(spoken, around)


def hear_answer(recogniser: Recogniser, audio: Audio, expected: Expected) -> Answer:
    """Which of the expected answers is given in `audio`."""
    heard = recogniser.recognise(audio, expected.phrases, worst_fit=WORST_FIT)
    return answer_in(heard, audio, expected, recogniser.second)


def answer_in(
    heard: Heard, audio: Audio, expected: Expected, second: SecondEar | None = None
) -> Answer:
    """Which answer was given, of what was heard in `audio` with the expected phrases and
    `WORST_FIT`, and what the second ear makes of it."""
    by_sound = _by_sound(heard, audio, expected)
    if second is not None and heard.text:
        return _judged(heard, audio, expected, second, by_sound)
    shares = _shares(heard, expected)
    answer = expected.read(heard.text)
    said = (heard.doubtful and heard.free_text) or heard.text
    unsure = UNSURE if heard.text else UNSURE_OF_SOUND
    if by_sound:
        shares = _sounding(shares, by_sound)
        answer = shares[0][0]
    if heard.doubtful or answer is None:
        return Answer(said, None, 0.0, shares[:2])
    share = dict(shares).get(answer, 1.0)
    if share < unsure:
        return Answer(said, None, 0.0, shares[:2] if said else ())
    return Answer(said or answer, answer, share, shares[:2])


def _judged(
    heard: Heard,
    audio: Audio,
    expected: Expected,
    second: SecondEar,
    by_sound: Mapping[str, float] | None,
) -> Answer:
    """The likeliest answer of all opinions together, if the second ear hears it well enough."""
    limited = [reading.text for reading in heard.readings if not reading.free][:JUDGED]
    figures = [answer for text in limited if expected.figures and (answer := expected.read(text))]
    each = expected.phrases if expected.digits_of else ()
    opinion = second.hear(
        audio.samples,
        [*expected.phrases, *expected.figures],
        filter(None, [*limited, *figures, *each, heard.free_text]),
    )
    texts: dict[str, Judged] = {}  # the likeliest of each answer
    no_answer: Judged | None = None
    for judged in sorted(opinion.readings, key=lambda judged: judged.likelihood):
        answer = expected.read_alone(judged.text.replace(",", ""))
        if answer is None:
            no_answer = judged
        else:
            texts[answer] = judged
    if not texts:
        return Answer(opinion.free, None, 0.0)
    listed = _shares(heard, expected)
    by_words = {answer: log(max(share, 1e-9)) for answer, share in listed}
    if by_sound:
        shares = tuple(each for each in _sounding(listed, by_sound) if each[0] in texts)
        if not shares:
            return Answer(opinion.free, None, 0.0)
    else:
        shares = _normalised(
            {
                answer: judged.likelihood + (by_words.get(answer, NOT_LISTED) if by_words else 0.0)
                for answer, judged in texts.items()
            }
        )
    answer, share = shares[0]
    # Of several readings the plain one may be no likelier than another that means something else:
    # either of them is what the recogniser hears.
    first = max(by_words, key=by_words.__getitem__, default=None)
    both = not heard.doubtful and answer in (first, expected.read(heard.text))
    freely = answer in (expected.read(text or "") for text in (heard.free_text, opinion.free))
    limit = BY_SOUND if by_sound else _limit(expected, both, freely)
    likelihood = texts[answer].likelihood
    behind = no_answer.likelihood - likelihood if no_answer else 0.0
    if share < UNSURE or behind > limit.behind or likelihood < limit.least:
        said = no_answer.text if no_answer and behind > 0 else texts[answer].text
        return Answer(said, None, 0.0, shares[:2])
    return Answer(texts[answer].text, answer, share, shares[:2])


def _limit(expected: Expected, both: bool, freely: bool) -> _Limit:
    """When to believe an answer that both ears hear, or only the second one; `freely`: one of them
    hears it also when anything may be said."""
    if not both:
        return ONE_HEARD
    if expected.everyday and not freely:
        return NEVER_FREELY
    return BOTH_HEARD_FIGURES if expected.figures else BOTH_HEARD


def _by_sound(heard: Heard, audio: Audio, expected: Expected) -> Mapping[str, float] | None:
    """How likely each digit is by its sound alone; None where that cannot be told, and where the
    recogniser hears several words."""
    if expected.digits_of is None or len(heard.text.split()) > 1:
        return None
    ear = digits.load(expected.digits_of)
    return ear.shares(audio) if ear else None


Shares = tuple[tuple[str, float], ...]


def _shares(heard: Heard, expected: Expected) -> Shares:
    """How likely each answer is by the recogniser, the likeliest first."""
    best: dict[str, float] = {}
    for reading in heard.readings:
        answer = None if reading.free else expected.read(reading.text)
        if answer is not None:
            best[answer] = max(reading.score, best.get(answer, reading.score))
    return _normalised(best)


def _sounding(shares: Shares, by_sound: Mapping[str, float]) -> Shares:
    """How likely each digit is by its sound and by the recogniser, the likeliest first. All of them
    and what is none have a share of one together."""
    known = dict(shares)

    def by_words(digit: str) -> float:
        return max(NOT_LISTED, log(max(known.get(digit, 0.0), 1e-9))) if known else 0.0

    scores = {
        digit: log(max(share, 1e-9)) + (BY_WORDS * by_words(digit) if digit else 0.0)
        for digit, share in by_sound.items()
    }
    return tuple(each for each in _normalised(scores) if each[0] != digits.NONE)


def _normalised(scores: Mapping[str, float]) -> Shares:
    most = max(scores.values(), default=0.0)
    weights = {answer: exp(max(-700.0, score - most)) for answer, score in scores.items()}
    whole = sum(weights.values())
    ordered = sorted(weights.items(), key=lambda item: -item[1])
    return tuple((answer, weight / whole) for answer, weight in ordered)


def _digits(language: str) -> Expected:
    words = {number_words(str(digit), language): str(digit) for digit in range(10)}
    for digit, alike in _sayings(language).get("digits_alike", {}).items():
        words |= dict.fromkeys(alike, str(digit))

    def read(text: str) -> str | None:
        said = text.split()
        return "".join(words[word] for word in said) or None if words.keys() >= {*said} else None

    return Expected(
        tuple(words),
        read,
        digits_of=language,
        figures=tuple(map(str, range(10))),
        besides=_besides(language),
    )


def _number(language: str) -> Expected:
    spoken = dict(_numbers(language))
    one_by_one = _digits(language).read
    figures = {number_words(str(digit), language) for digit in range(10)}
    whole = _choice(spoken, nearest=False)

    def read(text: str) -> str | None:
        words = text.split()
        # "four zero seven", as one reads a number out
        if len(words) > 1 and figures.issuperset(words):
            return one_by_one(text)
        return whole.read(text)

    return Expected(
        whole.phrases,
        read,
        figures=tuple(dict.fromkeys(spoken.values())),
        besides=_besides(language),
    )


def _besides(language: str) -> frozenset[str]:
    return frozenset(map(str, _sayings(language)["besides"]))


@cache
def _numbers(language: str) -> tuple[tuple[str, str], ...]:
    """What is said -> the numeral."""
    spoken = {number_words(str(n), language): str(n) for n in range(LARGEST + 1)}
    between = _sayings(language).get("hundred_and")
    if between:  # "one hundred and five"
        hundred = number_words("100", language).split()[-1]
        for said, numeral in list(spoken.items()):
            if int(numeral) > 100 and int(numeral) % 100:
                spoken[said.replace(f"{hundred} ", f"{hundred} {between} ", 1)] = numeral
    for said, number in _sayings(language)["numbers"].items():
        spoken[str(said)] = str(number)
    return tuple(spoken.items())


@cache
def _times(language: str) -> dict[str, str]:
    """What is said -> the time of day."""
    sayings = _sayings(language)["times"]
    spoken = {str(said): str(time) for said, time in sayings["named"].items()}
    for hour in range(1, sayings["hours"] + 1):
        for pattern, minutes in sayings["past"].items():
            whole, rest = divmod(hour * 60 + minutes, 60)
            spoken[pattern.format(number_words(str(hour), language))] = f"{whole}:{rest:02}"
    return spoken


def _choice(
    spoken: Mapping[str, str | None],
    around: Sequence[str] = (),
    nearest: bool = True,
    everyday: bool = False,
) -> Expected:
    """One of several: `spoken` is what is said -> the answer that it means, if any; `nearest`: most
    of the words of one will do; `everyday`: see `Expected`."""
    sayings = {_words(said): answer for said, answer in spoken.items()}

    def read(text: str) -> str | None:
        heard = _words(text)
        said = _said(heard, sayings)
        return _only(said or _nearest(heard, sayings) if nearest else said)

    # What is no answer is not listened for: its words would take the place of answers in noise.
    phrases = (said for said, answer in spoken.items() if answer is not None)
    return Expected((*phrases, *around), read, everyday=everyday)


Words = tuple[str, ...]


def _said(heard: Words, sayings: Mapping[Words, str | None]) -> set[str | None]:
    """The answers of the sayings among these words."""
    answers: set[str | None] = set()
    at = 0
    longest = max(map(len, sayings))
    while at < len(heard):
        # The longest saying wins: "i do not" is not "i do", "green tea" is not "tea".
        lengths = range(min(len(heard) - at, longest), 0, -1)
        here = next((n for n in lengths if heard[at : at + n] in sayings), 0)
        if here:
            answers.add(sayings[heard[at : at + here]])
        at += here or 1
    return answers


def _nearest(heard: Words, sayings: Mapping[Words, str | None]) -> set[str | None]:
    """The answers of which most was said: "intensive care" for "intensive care unit"."""
    share = {said: len({*said} & {*heard}) / len(said) for said in sayings}
    most = max(share.values())
    return {answer for said, answer in sayings.items() if share[said] == most > 0.5}


def _only(answers: set[str | None]) -> str | None:
    return next(iter(answers)) if len(answers) == 1 else None


def _words(text: str) -> Words:
    """As the recogniser gives them, hyphens or not."""
    words = (word.strip(PUNCTUATION) for word in text.lower().replace("-", " ").split())
    return tuple(filter(None, words))


def _sayings(language: str) -> Mapping[str, Any]:
    return texts_in(language, "answers")
