"""Many ways to ask for the same errand lead to the same (`families.py`)."""

from __future__ import annotations

from collections import Counter

import pytest

from nl2robot.deliberation.paper_robot import Scene
from tests.errands.families import FEW, Family, carried_out, families, judged

FAMILIES = families()


@pytest.mark.parametrize("family", FAMILIES, ids=lambda family: family.family)
def test_as_many_sentences_as_ever_do_what_they_ask(family: Family, soak: bool) -> None:
    """Of a part of them no more are missed than may be of the whole."""
    drawn = family.drawn()
    found = [judged(family, *each) for each in (drawn if soak else drawn[:FEW])]
    verdicts = Counter(each.verdict for each in found)
    missed = "\n".join(f"[{each.verdict}] {each.sentence}" for each in found if each.why)
    untried = len(drawn) - len(found)
    assert verdicts["right"] + untried >= family.least * len(drawn), missed
    assert verdicts["wrong"] <= family.most_wrong * len(drawn), missed


def test_families_have_names_of_their_own() -> None:
    names = [family.family for family in FAMILIES]
    assert len(names) == len(set(names))


def test_the_paper_robot_does_what_a_program_says() -> None:
    program = """
robot.find("stapler")
robot.grab("stapler")
robot.find("Bob")
robot.give("stapler", person="Bob")
if robot.ask("Is that the right one?", ["yes", "no"]) == "no":
    robot.say("I am sorry.")
"""
    scene = Scene(
        places={"lobby": "lobby", "office 1": "office"},
        people={"Bob": "office 1"},
        things=[("red stapler", "lobby")],
        answers={"Bob": "no"},
    )
    events, end = carried_out(program, scene)
    assert end == "done"
    assert [str(event) for event in events if event.kind not in ("looks for", "visits")] == [
        "takes 'red stapler' at lobby",
        "gives 'red stapler' (Bob) at office 1",
        "asks 'Is that the right one?' (Bob) at office 1",
        "says 'I am sorry.' (Bob) at office 1",
    ]


def test_a_program_that_never_ends_is_over_some_time() -> None:
    events, end = carried_out("while True:\n    robot.wait(1)\n", Scene(places={}))
    assert (events[0].kind, end) == ("waits", "over")
