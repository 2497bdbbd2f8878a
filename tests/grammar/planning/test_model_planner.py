"""A language model as a planner: its programs become plans, its ways out answers, and nothing that
it writes an exception."""

from __future__ import annotations

import threading
from collections.abc import Callable

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grammar.language import load_language
from grammar.naming import place_called
from grammar.planning.model.planner import LONGEST, ModelPlanner
from grammar.planning.model.request import Request, TooLate, Written
from grammar.planning.planner import (
    Answer,
    Draft,
    Drafts,
    Interrupted,
    Question,
    Refusal,
    Watch,
)
from grammar.planning.turn import Turn
from nl2robot.language_model.scripted import ScriptedWriter
from tests.grammar.ward import WARD, program

MODEST = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
SAYS = "wheel the tea round to Bob in the kitchen"


def planned(writer: ScriptedWriter | Scribbler | Snail, watch: Watch | None = None) -> Answer:
    return ModelPlanner(writer).plan(Turn(SAYS, WARD, load_language("en")), watch or Watch())


def drafts(answer: Answer) -> tuple[Draft, ...]:
    assert isinstance(answer, Drafts)
    return answer.drafts


Scripted = Callable[..., ScriptedWriter]


def test_programs_become_drafts_the_likeliest_first(scripted: Scripted) -> None:
    first, second = drafts(planned(scripted({SAYS: ['goto("kitchen")', "dock()"]})))
    assert [program(each.plan) for each in (first, second)] == ['goto("kitchen")', "dock()"]
    assert first.probability > second.probability > 0
    assert first.probability + second.probability == pytest.approx(1.0)
    assert (first.planner, first.exact) == ("model", False)
    assert first.context.written == 'goto("kitchen")' and first.context.text == SAYS
    assert first.context.plan == first.plan


def test_what_is_no_program_is_left_out(scripted: Scripted) -> None:
    [only] = drafts(planned(scripted({SAYS: ["fly()", 'goto("kitchen")', "say(", "import os"]})))
    assert program(only.plan) == 'goto("kitchen")'


def test_where_nothing_is_a_program_the_robot_has_not_understood(scripted: Scripted) -> None:
    for programs in ([], ["fly()"], ["(" * 500], ["\x00"]):
        answer = planned(scripted({SAYS: programs}))
        assert isinstance(answer, Refusal) and answer.message and not answer.final


@pytest.mark.parametrize(
    ("written", "kind", "final"),
    [
        ('refuse("dangerous")', Refusal, True),
        ('refuse("medical")', Refusal, True),
        ('refuse("unable")', Refusal, False),
        ('refuse("unknown", "sauna")', Refusal, False),
        ('refuse("no order")', Refusal, False),
        ('clarify("who")', Question, False),
        ('clarify("what")', Question, False),
        ('clarify("where")', Question, False),
        ('clarify("when")', Question, False),
        ('clarify("which", "ward")', Question, False),
    ],
)
@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_ways_out_are_told_in_words(
    scripted: Scripted, written: str, kind: type[Answer], final: bool, language: str
) -> None:
    writer = scripted({SAYS: [written, "dock()"]})
    turn = Turn(SAYS, WARD, load_language(language))
    answer = ModelPlanner(writer).plan(turn, Watch())
    assert isinstance(answer, kind) and isinstance(answer, Refusal | Question)
    assert answer.message and "{" not in answer.message
    assert getattr(answer, "final", False) is final
    for words in ("sauna", "ward"):
        assert (words in answer.message) == (words in written)


def test_which_of_several_is_meant_is_asked_with_all_of_them(scripted: Scripted) -> None:
    words = "Take the red cup to the ward."
    turn = Turn(words, WARD, load_language("en"))
    answer = ModelPlanner(scripted({words: ['clarify("which", "ward")']})).plan(turn, Watch())
    assert isinstance(answer, Question)
    names = [place.name for place in WARD.places if "ward" in place.name.split()]
    assert len(names) > 1
    assert all(name in answer.message for name in names)
    called = [place_called(name, WARD, turn.language) for name in names]
    assert answer.suggestions == tuple(f"Take the red cup to {name}." for name in called)
    assert "Take the red cup to the children's ward." in answer.suggestions


def test_what_nobody_here_is_called_is_not_one_of_several(scripted: Scripted) -> None:
    words = "Take the red cup to the sauna."
    turn = Turn(words, WARD, load_language("en"))
    for question in ("which", "where"):
        writer = scripted({words: [f'clarify("{question}", "sauna")']})
        answer = ModelPlanner(writer).plan(turn, Watch())
        assert isinstance(answer, Refusal) and "do not know “sauna” here" in answer.message


def test_a_way_out_that_is_only_second_best_is_none(scripted: Scripted) -> None:
    [only] = drafts(planned(scripted({SAYS: ["dock()", 'refuse("unable")']})))
    assert program(only.plan) == "dock()"


def test_why_there_is_no_model_is_told(scripted: Scripted) -> None:
    answer = planned(scripted({}, ill="It has a cold. Come back tomorrow."))
    assert answer == Refusal("It has a cold. Come back tomorrow.", absent=True)


def test_a_long_story_is_not_even_read(scripted: Scripted) -> None:
    writer = scripted({})
    story = "and then it rained " * 110
    assert len(story) > 2000 > LONGEST
    turn = Turn(story, WARD, load_language("en"))
    answer = ModelPlanner(writer).plan(turn, Watch())
    assert answer == Refusal(load_language("en").phrase("too_long"))
    assert writer.asked == []


def test_whoever_waits_sees_what_is_written(scripted: Scripted) -> None:
    text = 'if sees("Bob"):\n    say("Tea!")\nelse:\n    goto("kitchen")'
    shown: list[str] = []
    thinking: list[bool] = []
    watch = Watch(lambda: thinking.append(True), shown.append)
    assert drafts(planned(scripted({SAYS: [text]}), watch))
    assert thinking == [True]
    assert shown[0].startswith('if robot.sees("Bob"):')
    assert "    robot.say('Tea!')" in shown[-1] or '    robot.say("Tea!")' in shown[-1]


def test_whoever_gives_up_waits_no_longer(scripted: Scripted) -> None:
    writer = scripted({SAYS: ["dock()"]})
    writer.held.set()
    begun = threading.Event()
    watch = Watch(writing=lambda text: begun.set())

    def give_up() -> None:
        assert begun.wait(10)
        watch.cancel()

    thread = threading.Thread(target=give_up)
    thread.start()
    with pytest.raises(Interrupted):
        planned(writer, watch)
    thread.join()


def test_no_more_than_a_few_programs_are_asked_for_and_not_for_long(scripted: Scripted) -> None:
    writer = scripted({SAYS: ["dock()"]})
    planned(writer)
    [asked] = writer.asked
    assert asked.most == 4 and asked.seconds == 20.0


class Snail:
    """A writer on a machine that is too busy."""

    def write(
        self, request: Request, on_text: Callable[[str], None] | None = None
    ) -> list[Written]:
        raise TooLate

    def cancel(self) -> None:
        pass


def test_a_model_that_did_not_come_to_an_end_says_so() -> None:
    answer = planned(Snail())
    assert isinstance(answer, Refusal) and answer.absent and "in time" in answer.message


# --- garbage -------------------------------------------------------------------------------------


class Scribbler:
    """A writer that writes what it is told to, whatever it is."""

    def __init__(self, written: list[Written]) -> None:
        self.written = written

    def write(
        self, request: Request, on_text: Callable[[str], None] | None = None
    ) -> list[Written]:
        for each in self.written:
            if on_text is not None:
                on_text(each.text)
        return self.written

    def cancel(self) -> None:
        pass


_GOOD = ('find("Bob")\nsay("Tea!")', 'refuse("unable")', "x = 1\nsay(f'{x}')", "dock()")
texts = st.one_of(
    st.text(max_size=80),
    st.text("(){}[]'\"\\\n fxrobt=:,.0", max_size=80),
    st.sampled_from(_GOOD),
    st.tuples(st.sampled_from(_GOOD), st.integers(0, 20)).map(lambda each: each[0][each[1] :]),
)
scores = st.floats(allow_nan=True, allow_infinity=True)


@MODEST
@given(st.lists(st.builds(Written, texts, scores, scores, st.integers(0, 9)), max_size=4))
def test_whatever_is_written_is_answered(written: list[Written]) -> None:
    answer = planned(Scribbler(written))
    assert isinstance(answer, Drafts | Refusal | Question)
    if isinstance(answer, Drafts):
        assert all(0 <= each.probability <= 1 for each in answer.drafts)
        assert sum(each.probability for each in answer.drafts) <= 1 + 1e-9


def test_how_unlikely_all_are_makes_no_difference() -> None:
    unlikely = [Written("dock()", -2000.0, 0.0, 3), Written('goto("kitchen")', -2001.0, 0.0, 3)]
    first, second = drafts(planned(Scribbler(unlikely)))
    assert first.probability == pytest.approx(0.731, abs=0.001)
    assert second.probability == pytest.approx(0.269, abs=0.001)
