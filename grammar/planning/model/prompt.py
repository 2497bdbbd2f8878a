"""What the model is told: the task, the robot's functions, examples, and the sentence with what it
speaks of. All but the last is the same for every world, so that it has to be read only once.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import Final

from grammar.lexicon import Lexicon
from grammar.planning.mentions import Mention, written
from grammar.planning.model.request import Piece, Request
from grammar.planning.model.vocabulary import Vocabulary
from grammar.planning.turn import Turn
from grammar.roles import ANYBODY, QUANTITIES, SORTS

PREFIX: Final = "<|im_start|>system\nRobot program.<|im_end|>\n"
"""What stands before every sentence."""
_PERSON: Final = Piece("<|im_start|>user\n", marks=True)
_MODEL: Final = Piece("<|im_end|>\n<|im_start|>assistant\n", marks=True)
_OVER: Final = Piece("<|im_end|>\n", marks=True)
_DEFAULTS: Final = {
    "seconds": ("1", "2", "5", "10", "30", "60"),
    "metres": ("0.5", "1"),
    "degrees": ("0", "45", "90", "180", "360"),
    "percents": ("0", "10", "20", "30", "40", "50", "60", "70", "80", "90", "100"),
    "numbers": ("0",),
}
"""Numbers for what is asked for without one: "wait a moment", "turn left", "a bit louder"; and how
long to wait between two looks, which nobody says."""
_JOINTS: Final = (
    *("head_yaw", "head_pitch", "left_shoulder", "right_shoulder", "left_elbow", "right_elbow"),
    *("left_wrist", "right_wrist", "waist"),
)
"""What joints are called where it is not known which the robot has."""
_SIGNED: Final = frozenset({"metres", "degrees", "numbers"})


def request(turn: Turn, before: str = "", most: int = 1) -> Request:
    """What the model is asked for a turn; `before` is the program, in the dialect, of what was said
    before."""
    earlier: tuple[Piece, ...] = ()
    if turn.before is not None and before:
        earlier = (_PERSON, _asked(turn.before), _MODEL, Piece(before), _OVER)
    return Request(
        prefix=PREFIX,
        said=(*earlier, _PERSON, _asked(turn), _MODEL),
        words=vocabulary(turn),
        most=most,
    )


def _asked(turn: Turn) -> Piece:
    """A sentence, and what it speaks of."""
    named = hints(turn)
    return Piece(f"{turn.language.code}: {turn.text}" + (f"\n({named})" if named else ""))


def vocabulary(turn: Turn) -> Vocabulary:
    """What a program for this turn may name."""
    lexicon, found = turn.lexicon, turn.spoken_of
    own = {
        field: tuple(dict.fromkeys(each.value for each in found if each.sort == sort))
        for field, sort in SORTS.items()
    }
    own["places"] = tuple(dict.fromkeys((*own["places"], *_owned(lexicon, own["people"]))))
    own["people"] = tuple(dict.fromkeys((*own["people"], ANYBODY)))
    own["gestures"] = tuple(dict.fromkeys((*own["gestures"], *lexicon.gestures)))
    own["emotions"] = tuple(dict.fromkeys((*own["emotions"], *lexicon.emotions)))
    own["joints"] = lexicon.joints or _JOINTS
    own["languages"] = own["languages"] or lexicon.languages
    own["times"] = tuple(dict.fromkeys(_either_half(own["times"])))
    phrases = tuple(dict.fromkeys((*_phrases(turn), *(_phrases(turn.before or turn)))))
    own["skills"] = lexicon.skills or phrases
    numbers = {
        field: tuple(_numbers(field, [each.value for each in found if each.sort == sort]))
        for field, sort in QUANTITIES.items()
    }
    spans = [float(each.value) / 60 for each in found if each.sort == "seconds"]
    plain = [each.value for each in found if each.sort in ("number", "times")]
    return Vocabulary(
        **own,
        **numbers,
        minutes=tuple(dict.fromkeys(written(minutes) for minutes in spans)),
        numbers=tuple(_numbers("numbers", plain)),
        phrases=phrases,
        said=turn.text,
    )


def _either_half(times: Sequence[str]) -> Iterator[str]:
    """Times of day, and the same in the other half of the day: "eight" may be either."""
    for time in times:
        hour, _, minute = time.partition(":")
        yield time
        yield f"{(int(hour) + 12) % 24:02d}:{minute}"


def _owned(lexicon: Lexicon, people: Sequence[str]) -> Iterator[str]:
    """The places that are called after people."""
    named = {
        name
        for each in lexicon.people
        if each.name in people
        for name in (each.name, *each.aliases)
    }
    for place in lexicon.places:
        called = " ".join((place.name, *place.aliases))
        if any(re.search(rf"\b{re.escape(name)}", called, re.IGNORECASE) for name in named):
            yield place.name


def _numbers(field: str, said: Sequence[str]) -> Iterator[str]:
    """Those that were said, and those for what is asked for without one."""
    numbers = dict.fromkeys((*said, *_DEFAULTS[field]))
    yield from numbers
    if field in _SIGNED:
        yield from (f"-{each}" for each in numbers if each != "0" and each[0] != "-")


def _phrases(turn: Turn) -> Iterator[str]:
    """Words of the sentence, as they were said, that may stand for something in a list."""
    reader = turn.reader
    spans = [
        (each.start, each.end) for each in turn.mentions if each.sort in ("thing", "person", "time")
    ]
    spans += [(at, at + 1) for at in range(len(reader.tokens))]
    for start, end in spans:
        while start < end and reader.tokens[start].norm in reader.language.closed:
            start += 1
        words = reader.words(start, end)
        if words and reader.tokens[start].kind != "mark":
            yield words


def hints(turn: Turn) -> str:
    """What the sentence speaks of, by the names that programs know it by."""
    told: dict[str, None] = {}
    taken: set[int] = set()
    for each in sorted(_worth_telling(turn), key=_likelier):
        span = {*range(each.start, each.end)}
        if span & taken:
            continue
        taken |= span
        sort, words = "kind of place" if each.sort == "kind" else each.sort, _bare(each, turn)
        new = each.value.lower() != words.lower()
        told[f'{words}: {sort} "{each.value}"' if new else f"{words}: {sort}"] = None
    return "; ".join(told)


_HINTED: Final = ("place", "person", "kind", "contact", "thing", "furniture")
"""Sorts that are told of; of the same words the first."""


def _likelier(mention: Mention) -> tuple[bool, int, int]:
    """Of mentions that overlap, the surer and longer one is told."""
    return mention.cost > 0.5, mention.start - mention.end, _HINTED.index(mention.sort)


def _bare(mention: Mention, turn: Turn) -> str:
    """Its words without articles and the like before them."""
    start, closed = mention.start, turn.language.closed
    while start < mention.end - 1 and turn.tokens[start].norm in closed:
        start += 1
    return turn.reader.words(start, mention.end)


def _worth_telling(turn: Turn) -> Iterator[Mention]:
    """Names, kinds, and what is called otherwise than in a program; in as few words as will do."""
    for each in turn.mentions:
        if each.sort not in _HINTED or each.value == ANYBODY or _is_wordy(each, turn):
            continue
        if each.sort in ("person", "thing", "furniture") and not _is_name(turn.lexicon, each):
            listed = each.sort == "person" or _is_listed(turn.lexicon, each)
            if not listed or each.value.lower() == _bare(each, turn).lower():
                continue
        yield each


def _is_wordy(mention: Mention, turn: Turn) -> bool:
    """Whether fewer words mean the same for certain."""
    return any(
        (other.sort, other.value) == (mention.sort, mention.value)
        and mention.start <= other.start
        and other.end <= mention.end
        and other.cost < mention.cost
        for other in turn.mentions
    )


def _is_listed(lexicon: Lexicon, mention: Mention) -> bool:
    """Whether it is a thing or a piece of furniture that the world lists, whatever it looks
    like."""
    listed = {"thing": lexicon.objects, "furniture": lexicon.furniture}.get(mention.sort, ())
    return any(mention.value.endswith(each.name) for each in listed)


def _is_name(lexicon: Lexicon, mention: Mention) -> bool:
    return any(each.name == mention.value for each in (*lexicon.places, *lexicon.people))
