"""Drafts that do the same are one vote; what must not be, cannot be or fails has none."""

from __future__ import annotations

import pytest

from nl2robot.deliberation import voting
from nl2robot.deliberation.considering import consider
from nl2robot.deliberation.voting import Count, count, same
from nl2robot.knowledge import Knowledge
from tests.deliberation.drafting import ARMLESS, WARD, draft, drafts, turn


def counted(text: str, *written: str, knowledge: Knowledge = WARD, language: str = "en") -> Count:
    asked = turn(text, language, knowledge)
    return count(asked, drafts(asked, *written), knowledge)


def sizes(found: Count) -> list[int]:
    return [len(vote.drafts) for vote in found.votes]


ALIKE = {
    "a loop or one by one": (
        "wave to the people in ward a and ward b",
        'goto("ward a")\ngesture("wave")\ngoto("ward b")\ngesture("wave")\n',
        'for place in ["ward a", "ward b"]:\n    goto(place)\n    gesture("wave")\n',
    ),
    "yes first or no first": (
        "if somebody is in ward a say hello, otherwise wave",
        'goto("ward a")\nif sees("person"):\n    say("Hello!")\nelse:\n    gesture("wave")\n',
        'goto("ward a")\nif not sees("person"):\n    gesture("wave")\nelse:\n    say("Hello!")\n',
    ),
    "an answer with a name or without": (
        "see in ward a whether anybody wants tea, and if so wave",
        'goto("ward a")\nif ask("Do you want tea?", ["yes", "no"]) == "yes":\n'
        '    gesture("wave")\n',
        'goto("ward a")\nanswer = ask("Do you want tea?", ["yes", "no"])\n'
        'if answer == "yes":\n    gesture("wave")\n',
    ),
    "in other words": (
        "ward a should know that lunch is ready",
        'goto("ward a")\nsay("Lunch is ready.")\n',
        'goto("ward a")\nsay("The lunch is ready!")\n',
    ),
    "twice or two times over": (
        "ward a should get two waves",
        'goto("ward a")\nfor number in range(2):\n    gesture("wave")\n',
        'goto("ward a")\ngesture("wave")\ngesture("wave")\n',
    ),
}


@pytest.mark.parametrize("story", ALIKE.values(), ids=ALIKE)
def test_drafts_that_do_the_same_are_one_vote(story: tuple[str, str, str]) -> None:
    text, *written = story
    found = counted(text, *written)
    assert sizes(found) == [2]
    assert found.dropped == ()
    assert found.votes[0].share == pytest.approx(1.0)
    assert found.votes[0].first.program != found.votes[0].drafts[1].program


UNLIKE = {
    "another order": (
        "ward a and ward b should get a visit",
        'goto("ward a")\ngoto("ward b")\n',
        'goto("ward b")\ngoto("ward a")\n',
    ),
    "once or for each": (
        "ward a and ward b should get a wave",
        'for place in ["ward a", "ward b"]:\n    goto(place)\n    gesture("wave")\n',
        'goto("ward a")\ngoto("ward b")\ngesture("wave")\n',
    ),
    "if yes or if no": (
        "see in ward a whether anybody wants tea, and if so wave",
        'goto("ward a")\nif ask("Do you want tea?", ["yes", "no"]) == "yes":\n'
        '    gesture("wave")\n',
        'goto("ward a")\nif ask("Do you want tea?", ["yes", "no"]) == "no":\n    gesture("wave")\n',
    ),
    "if somebody is there or nobody": (
        "ward a should get a wave if somebody is there",
        'goto("ward a")\nif sees("person"):\n    gesture("wave")\n',
        'goto("ward a")\nif not sees("person"):\n    gesture("wave")\n',
    ),
    "once or for ever": (
        "ward a should get a wave again and again",
        'goto("ward a")\ngesture("wave")\n',
        'while True:\n    goto("ward a")\n    gesture("wave")\n',
    ),
    "before or behind the wait": (
        "ward a should get a wave when Alice comes",
        'goto("ward a")\nwait_for("Alice")\ngesture("wave")\n',
        'goto("ward a")\ngesture("wave")\nwait_for("Alice")\n',
    ),
    "late at night": (
        "when it is 9 pm ward a should get a wave",
        'while clock().time < "21:00":\n    wait(60)\ngoto("ward a")\ngesture("wave")\n',
        'while clock().time < "21:00":\n    wait(60)\ngesture("wave")\ngoto("ward a")\n',
    ),
}


@pytest.mark.parametrize("story", UNLIKE.values(), ids=UNLIKE)
def test_drafts_that_do_something_else_somewhere_are_two(story: tuple[str, str, str]) -> None:
    text, *written = story
    asked = turn(text)
    one, other = (consider(asked, each) for each in drafts(asked, *written))
    assert one is not None and other is not None
    assert not same(asked, one, other)
    assert same(asked, one, one)


def test_the_most_voted_come_first_though_no_single_one_is_the_likeliest() -> None:
    asked = turn("ward a and ward b should get a wave")
    once = draft(asked, 'goto("ward a")\ngoto("ward b")\ngesture("wave")\n', 0.4)
    loop = 'for place in ["ward a", "ward b"]:\n    goto(place)\n    gesture("wave")\n'
    row = 'goto("ward a")\ngesture("wave")\ngoto("ward b")\ngesture("wave")\n'
    found = count(asked, [once, draft(asked, loop, 0.35), draft(asked, row, 0.25)], WARD)
    assert sizes(found) == [2, 1]
    assert [vote.share for vote in found.votes] == pytest.approx([0.6, 0.4])
    assert found.votes[0].first.draft.probability == 0.35


# --- without a vote

EMPTY_HANDED = 'give("cup", "person")\n'


def test_what_nobody_asked_for_has_no_vote() -> None:
    found = counted("ward a should get a wave", 'goto("corridor")\n', 'goto("ward a")\n')
    assert [each.program for each in found.dropped] == ['robot.goto("corridor")\n']
    assert sizes(found) == [1]


def test_what_this_robot_cannot_do_has_no_vote() -> None:
    text, visit = "ward a should get a wave", 'goto("ward a")\n'
    wave = f'{visit}gesture("wave")\n'
    assert sizes(counted(text, wave, visit)) == [1, 1]
    armless = counted(text, wave, visit, knowledge=ARMLESS)
    assert [vote.first.program for vote in armless.votes] == ['robot.goto("ward a")\n']
    assert ["gesture" in each.program for each in armless.dropped] == [True]


def test_what_fails_where_all_is_well_has_no_vote() -> None:
    gives = 'find("cup")\ngrab("cup")\ngive("cup", "person")\n'
    found = counted("hand somebody the cup", EMPTY_HANDED, gives)
    assert ["grab" in vote.first.program for vote in found.votes] == [True]
    assert ["grab" in each.program for each in found.dropped] == [False]
    assert all(each.checked.sound for each in found.dropped)


def test_what_fails_is_not_the_same_as_what_does_not() -> None:
    asked = turn("hand somebody the cup")
    gives = 'find("cup")\ngrab("cup")\ngive("cup", "person")\n'
    one, other = (consider(asked, each) for each in drafts(asked, EMPTY_HANDED, gives))
    assert one is not None and other is not None
    assert not same(asked, one, other)
    assert same(asked, one, one)


def test_a_draft_that_fails_at_once_is_not_tried_further(monkeypatch) -> None:
    plays: list[str] = []
    play = voting.played

    def noted(program, scene):
        plays.append(program)
        return play(program, scene)

    monkeypatch.setattr(voting, "played", noted)
    counted("hand somebody the cup", EMPTY_HANDED)
    assert len(plays) == 1


def test_a_share_is_of_all_that_was_drafted() -> None:
    found = counted("ward a should get a wave", 'goto("corridor")\n', 'goto("ward a")\n')
    assert found.votes[0].share == pytest.approx(0.9 / 1.9)


def test_without_drafts_there_are_no_votes() -> None:
    asked = turn("ward a should get a wave")
    assert count(asked, [], WARD) == Count((), ())


def test_drafts_that_nobody_finds_likely_are_counted_all_the_same() -> None:
    asked = turn("ward a should get a wave")
    found = count(asked, [draft(asked, 'goto("ward a")\n', 0.0)], WARD)
    assert [vote.share for vote in found.votes] == [0.0]
