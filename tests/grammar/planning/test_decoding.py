"""Programs are written token by token: the likeliest, and others where the model is in doubt."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grammar.language import load_language
from grammar.planning.model.decoding import LEAST_LIKELY, MOST_TOKENS, Decoder, Full
from grammar.planning.model.expansion import expanded
from grammar.planning.model.recogniser import Partial
from grammar.planning.model.request import Request, Written
from grammar.planning.model.vocabulary import Vocabulary
from tests.grammar.ward import WARD

MODEST = settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
WORDS = Vocabulary(places=("kitchen", "lobby", "laundry"), people=("Bob", "person"), numbers=("3",))
END = ""
TOKENS = (
    *(END, "go", "to", "goto", "(", '("', '"', '")', ")", "\n", " ", "kitchen", "lobby", "laundry"),
    *(
        "dock",
        "()",
        "find",
        "Bob",
        "say",
        "Hi.",
        "if ",
        ":",
        "    ",
        "sauna",
        "<|im_end|>",
        "import",
    ),
)


@dataclass
class Speller:
    """A language model that thinks of some texts, each so likely, and of little else: the branch is
    the text that was read."""

    likes: Mapping[str, float]
    room: int = 1000
    """Tokens that it can remember."""
    read_so_far: int = 0
    reads: list[int] = field(default_factory=list)
    """How many branches were read side by side each time."""
    loose: float = 0.0
    """How likely it spells a text in other tokens than the longest."""
    guesses: Callable[[str], Sequence[int]] = lambda read: ()
    """What it guesses to come behind a text."""

    def encode(self, text: str) -> list[int]:
        return [TOKENS.index(text)]

    def text(self, token: int) -> str:
        return TOKENS[token]

    def read(self, pieces: Sequence[tuple[str, Sequence[int]]]) -> list[str]:
        self.read_so_far += len(pieces)
        self.reads.append(len(pieces))
        if self.read_so_far > self.room:
            raise Full
        return [branch + "".join(map(self.text, tokens)) for branch, tokens in pieces]

    def read_along(self, branch: str, tokens: Sequence[int]) -> list[str]:
        self.read_so_far += len(tokens)
        self.reads.append(1)
        if self.read_so_far > self.room:
            raise Full
        return [branch + "".join(map(self.text, tokens[:end])) for end in range(1, len(tokens) + 1)]

    def guess(self, branch: str, tokens: Sequence[int]) -> Sequence[int]:
        return self.guesses(branch + "".join(map(self.text, tokens)))

    def following(self, branch: str) -> Iterator[tuple[int, float]]:
        weights = [self._weight(branch, token) for token in TOKENS]
        ranked = sorted(enumerate(weights), key=lambda each: -each[1])
        return ((token, math.log(weight / sum(weights))) for token, weight in ranked)

    def _weight(self, branch: str, token: str) -> float:
        if token == END:
            return 1e-6 + self.likes.get(branch, 0.0)
        weight = 1e-6
        for text, like in self.likes.items():
            rest = text.removeprefix(branch) if text.startswith(branch) else ""
            spelled = [each for each in TOKENS if each and rest.startswith(each)]
            if token in spelled:
                likeliest = token == max(spelled, key=len)
                weight += like * (1 - self.loose if likeliest else self.loose)
        return weight


def written(
    model: Speller,
    most: int = 4,
    on_text: Callable[[str], None] | None = None,
    enough: Callable[[], bool] | None = None,
) -> list[Written]:
    decoder = Decoder(model)
    first = decoder.first("", Partial.begin(WORDS), on_text, enough)
    return [] if first is None else [first, *decoder.others(first, most - 1, enough)]


def texts(model: Speller, most: int = 4) -> list[str]:
    return [each.text for each in written(model, most)]


KITCHEN, LOBBY, LAUNDRY = (f'goto("{place}")' for place in ("kitchen", "lobby", "laundry"))


def test_the_likeliest_program_comes_first_and_others_where_it_is_in_doubt() -> None:
    found = written(Speller({KITCHEN: 0.6, LOBBY: 0.3, LAUNDRY: 0.1}))
    assert [each.text for each in found] == [KITCHEN, LOBBY, LAUNDRY]
    scores = [each.score for each in found]
    assert scores == sorted(scores, reverse=True)
    assert scores[0] == pytest.approx(math.log(0.6), abs=0.1)
    assert found[0].surest == pytest.approx(0.6, abs=0.05)
    assert found[1].surest == pytest.approx(0.3, abs=0.05)
    assert all(each.tokens > 1 for each in found)


def test_nobody_has_to_look_on_for_it_to_be_in_doubt() -> None:
    model = {"dock()": 0.6, 'find("Bob")': 0.4}
    grown: list[str] = []
    assert texts(Speller(model)) == ["dock()", 'find("Bob")']
    assert len(written(Speller(model), on_text=grown.append)) == 2
    assert grown[-1] == "dock()"
    assert all("dock()".startswith(text) for text in grown)


@pytest.mark.parametrize("most", [1, 2, 3])
def test_no_more_are_written_than_were_asked_for(most: int) -> None:
    assert len(texts(Speller({KITCHEN: 0.4, LOBBY: 0.35, LAUNDRY: 0.25}), most)) == most


def test_what_is_much_less_likely_is_left() -> None:
    least = math.exp(-LEAST_LIKELY) / 2
    assert texts(Speller({KITCHEN: 1.0, LOBBY: least})) == [KITCHEN]
    for each in written(Speller({KITCHEN: 1.0, LOBBY: 4 * least})):
        assert each.score > math.log(1.0) - LEAST_LIKELY - 0.1


def test_the_same_program_in_other_tokens_is_the_same() -> None:
    found = texts(Speller({KITCHEN: 0.5, LOBBY: 0.45}, loose=0.3))
    assert found == [KITCHEN, LOBBY]


def test_a_program_may_end_or_go_on() -> None:
    found = texts(Speller({KITCHEN: 0.7, f"{KITCHEN}\ndock()": 0.3}))
    assert found == [KITCHEN, f"{KITCHEN}\ndock()"]
    found = texts(Speller({KITCHEN: 0.3, f"{KITCHEN}\ndock()": 0.7}))
    assert found == [f"{KITCHEN}\ndock()", KITCHEN]


def test_what_is_no_program_is_never_written_however_likely_it_is() -> None:
    likes = {'goto("sauna")': 0.5, "import": 0.3, "<|im_end|>": 0.1, LOBBY: 0.01}
    assert texts(Speller(likes))[0] == LOBBY


def test_a_block_does_not_end_before_something_stands_in_it() -> None:
    begun = 'if find("Bob"):'
    found = texts(Speller({begun: 0.9, f"{begun}\n    dock()": 0.1}))
    assert found == [f"{begun}\n    dock()"]


@pytest.mark.parametrize(
    "guess", [(), (TOKENS.index("dock"),), tuple(map(TOKENS.index, ("dock", "()", "\n", "dock")))]
)
def test_guesses_make_no_difference_to_what_is_written(guess: Sequence[int]) -> None:
    likes = {f"{KITCHEN}\ndock()\ndock()": 0.5, f"{LOBBY}\ndock()": 0.3, "dock()": 0.2}
    plain = written(Speller(likes))
    guessing = written(Speller(likes, guesses=lambda read: guess if read[-1:] == "\n" else ()))
    assert [each.text for each in guessing] == [each.text for each in plain]
    assert [each.score for each in guessing] == pytest.approx([each.score for each in plain])


# --- where it ends too early ---------------------------------------------------------------------


@pytest.mark.parametrize("room", range(1, 5))
def test_what_is_half_written_when_the_model_is_full_is_no_draft(room: int) -> None:
    likes = {f"{KITCHEN}\ndock()\n{LOBBY}": 0.6, KITCHEN: 0.4}
    assert texts(Speller(likes, room)) == []


def test_what_is_whole_when_the_model_is_full_is_kept() -> None:
    likes = {KITCHEN: 0.6, f"{LOBBY}\ndock()\ndock()\ndock()": 0.4}
    alone = Speller(likes)
    assert len(texts(alone, most=1)) == 1
    assert texts(Speller(likes, alone.read_so_far + 1)) == [KITCHEN]


def test_a_program_that_never_ends_is_none() -> None:
    endless = "dock()\n" * 200
    model = Speller({endless: 1.0}, room=10 * MOST_TOKENS)
    assert all(not endless.startswith(f"{text}\ndock()\ndock()") or text for text in texts(model))
    assert model.read_so_far <= 10 * MOST_TOKENS


class Clock:
    """A clock that goes on by a second whenever somebody looks at it."""

    def __init__(self, until: float) -> None:
        self.now, self.until = 0.0, until

    def is_late(self) -> bool:
        self.now += 1.0
        return self.now > self.until


def test_a_first_program_that_takes_too_long_is_no_draft() -> None:
    model = Speller({f"{KITCHEN}\ndock()": 0.6, LOBBY: 0.4})
    clock = Clock(until=2)
    assert written(model, enough=clock.is_late) == []
    assert len(model.reads) == 2


def test_others_that_take_too_long_are_given_up_and_what_is_whole_is_kept() -> None:
    likes = {KITCHEN: 0.5, LOBBY: 0.3, f"{LAUNDRY}\ndock()\ndock()": 0.2}
    enough_for = len(_reads(likes, most=1)) + 1
    late = Clock(until=enough_for)
    assert [each.text for each in written(Speller(likes), enough=late.is_late)] == [KITCHEN]
    patient = Clock(until=1000)
    assert len(written(Speller(likes), enough=patient.is_late)) == 3


def _reads(likes: Mapping[str, float], most: int) -> list[int]:
    model = Speller(likes)
    texts(model, most)
    return model.reads


def test_how_long_people_wait_is_a_part_of_what_is_asked() -> None:
    assert Request(prefix="").seconds == 20.0


# --- whatever the model likes --------------------------------------------------------------------


class Fickle(Speller):
    """A model that likes anything, and never the same."""

    def __init__(self, chance: random.Random) -> None:
        super().__init__({}, room=120)
        self.chance = chance

    def _weight(self, branch: str, token: str) -> float:
        return self.chance.choice((1e-300, 1e-9, 0.1, 1.0, 5.0))


@MODEST
@given(st.randoms(use_true_random=False))
def test_nothing_but_programs_is_written(chance: random.Random) -> None:
    for each in written(Fickle(chance)):
        assert math.isfinite(each.score) and 0 <= each.surest <= 1
        draft = Partial.begin(WORDS).extended(each.text)
        assert draft is not None and draft.is_whole
        if not draft.ended:
            expanded(each.text, WORDS.people, WARD, load_language("en"))
