"""Short orders are the rules' own; of long ones, that they half understand, a language model has
its say."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.language_model.scripted import ScriptedWriter
from nl2robot.translate.outcome import Translation
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

WARD = Knowledge(load_world("ward", names_only=True))
Scripted = Callable[..., ScriptedWriter]

LONG = "Ask Henry if he wants tea. If he says yes, bring him the cup from ward b and tell Alice."
BETTER = """\
find("Henry")
answer = ask("Do you want tea?", ["yes", "no"], "Henry")
if answer == "yes":
    goto("ward b")
    grab("cup")
    find("Henry")
    give("cup", "Henry")
    find("Alice")
    say("Henry wants tea.")
"""


def said(words: str, planner: str = "auto") -> Translation:
    return translate(words, WARD, "en", planner)


@pytest.mark.parametrize(
    "words", ["Go to ward b.", "Tell Henry that lunch is ready.", "Bring me the cup."]
)
def test_of_what_the_rules_are_sure_nobody_else_is_asked(words: str, scripted: Scripted) -> None:
    writer = scripted({})
    assert said(words).source == "grammar"
    assert not writer.asked


def test_what_the_rules_half_understand_a_model_may_know_better(scripted: Scripted) -> None:
    assert said(LONG, "grammar").status == "ok"
    writer = scripted({LONG: [BETTER]})
    answered = said(LONG)
    assert writer.asked
    told = f"{answered.program} {answered.message}"
    assert "Henry wants tea" in told


def test_where_the_model_knows_nothing_the_rules_are_believed(scripted: Scripted) -> None:
    scripted({})
    assert said(LONG).program == said(LONG, "grammar").program


def test_what_both_say_is_shown_as_the_rules_say_it(scripted: Scripted) -> None:
    words = (
        "Go to ward a and wave, then go to ward b and nod, and then go to the charger and say"
        " that the round is over."
    )
    steps = [
        'goto("ward a")',
        'gesture("wave")',
        'goto("ward b")',
        'gesture("nod")',
        'goto("charger")',
        'say("The round is over now.")',
    ]
    writer = scripted({words: ["\n".join(steps) + "\n"]})
    answered = said(words)
    assert writer.asked
    assert answered.source == "grammar"


@pytest.mark.parametrize(
    "words", ["stop", "stop stop stop stop there is a little child right in front of you my dear"]
)
def test_of_a_stop_nobody_thinks_twice(words: str, scripted: Scripted) -> None:
    writer = scripted({})
    answered = said(words)
    assert answered.program is not None
    assert "robot.stop()" in answered.program
    assert not writer.asked


def test_what_is_left_alone_in_one_case_is_not_left_in_the_other(scripted: Scripted) -> None:
    words = "If Alice is not in ward a leave it, otherwise tell her that lunch is ready."
    writer = scripted({words: ['find("Alice", "ward a")\nsay("Lunch is ready.")\n']})
    said(words)
    assert writer.asked


def test_who_says_forget_it_is_left_alone(scripted: Scripted) -> None:
    writer = scripted({})
    assert said("Forget it.").program is None
    assert not writer.asked


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "please stop right now, you are going to hit somebody"),
        ("en", "okay stop now I have to get past"),
        ("en", "stop, flurbel the gizmo"),
        ("de", "Bleib stehen, du machst ihr Angst!"),
        ("de", "stopp du fährst ihm über den Fuß"),
        ("fr", "Arrête tout de suite, tu vas heurter quelqu'un !"),
    ],
)
def test_a_cry_of_stop_is_obeyed_whatever_is_said_after_it(
    language: str, words: str, scripted: Scripted
) -> None:
    writer = scripted({})
    stopped = translate(words, WARD, language)
    assert stopped.program is not None
    assert [line for line in stopped.program.splitlines() if line[0] != "#"] == ["robot.stop()"]
    assert not writer.asked


@pytest.mark.parametrize("words", ["Stop by the flurbel.", "stop at the gizmo you know"])
def test_who_is_to_stop_somewhere_is_not_to_stop_now(words: str, scripted: Scripted) -> None:
    scripted({})
    assert said(words).program is None
