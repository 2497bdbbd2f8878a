"""A sentence that may mean two things gets a short question back; one that means nothing safe, a
reason."""

from __future__ import annotations

import pytest

from grammar.planning.planner import Draft, Refusal
from grammar.understanding import Context
from nl2robot.deliberation import deciding
from nl2robot.deliberation.considering import consider
from nl2robot.deliberation.deciding import Chosen, Open, between, decide
from nl2robot.knowledge import Knowledge
from tests.deliberation.drafting import WARD, draft, drafts, turn

pytestmark = pytest.mark.usefixtures("uncalibrated")


def decided(
    text: str, *written: str, language: str = "en", knowledge: Knowledge = WARD
) -> Chosen | Open | Refusal:
    asked = turn(text, language, knowledge)
    return decide(asked, drafts(asked, *written), knowledge)


def test_one_draft_is_chosen() -> None:
    chosen = decided("ward a should get a wave", 'goto("ward a")\ngesture("wave")\n')
    assert isinstance(chosen, Chosen)
    assert chosen.considered.program == 'robot.goto("ward a")\nrobot.gesture("wave")\n'
    assert chosen.confidence == 1.0


def test_drafts_that_do_the_same_leave_no_question() -> None:
    chosen = decided(
        "wave to the people in ward a and ward b",
        'goto("ward a")\ngesture("wave")\ngoto("ward b")\ngesture("wave")\n',
        'for place in ["ward a", "ward b"]:\n    goto(place)\n    gesture("wave")\n',
    )
    assert isinstance(chosen, Chosen)
    assert chosen.confidence == 1.0


def test_what_is_doubtful_is_asked_about(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(deciding, "confidence", lambda *known: 0.3)
    opened = decided("ward a should get a wave", 'goto("ward a")\ngesture("wave")\n')
    assert isinstance(opened, Open)
    assert opened.question.message == (
        "I am not sure that I understand you. Do you mean this:"
        " I will go to ward a and then make the gesture wave."
    )
    [offer] = opened.offers
    assert offer.chosen.considered.program == 'robot.goto("ward a")\nrobot.gesture("wave")\n'
    assert offer.chosen.confidence == 0.3


def test_what_is_more_than_doubtful_is_not_even_asked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(deciding, "confidence", lambda *known: 0.1)
    refusal = decided("ward a should get a wave", 'goto("ward a")\ngesture("wave")\n')
    assert isinstance(refusal, Refusal)
    assert refusal.message == turn("").language.phrase("not_sure_enough")
    assert not refusal.final


# --- questions

QUESTIONS = {
    "en, what": (
        "en",
        "ward a should get a wave or a hello",
        'goto("ward a")\ngesture("wave")\n',
        'goto("ward a")\nsay("Hello!")\n',
        "Shall I make the gesture wave, or say “Hello!”?",
    ),
    "de, what": (
        "de",
        "Station A sollte ein Winken oder ein Hallo bekommen",
        'goto("ward a")\ngesture("wave")\n',
        'goto("ward a")\nsay("Hallo!")\n',
        "Soll ich die Geste „Winken“ machen oder „Hallo!“ sagen?",
    ),
    "fr, what": (
        "fr",
        "pour le service A un signe ou un bonjour",
        'goto("ward a")\ngesture("wave")\n',
        'goto("ward a")\nsay("Bonjour !")\n',
        "Dois-je faire ce geste : un signe de la main, ou dire « Bonjour ! » ?",
    ),
    "en, when": (
        "en",
        "ward a should get a wave if somebody is there",
        'goto("ward a")\nif sees("person"):\n    gesture("wave")\n',
        'goto("ward a")\nif not sees("person"):\n    gesture("wave")\n',
        "Shall I make the gesture wave, if I see a person, or make the gesture wave,"
        " if I do not see a person?",
    ),
    "en, more": (
        "en",
        "ward a should get a visit and a wave",
        'goto("ward a")\ngesture("wave")\n',
        'goto("ward a")\n',
        "Shall I go to ward a and then make the gesture wave, or go to ward a?",
    ),
    "de, in which order": (
        "de",
        "Station A und Station B sollten Besuch bekommen",
        'goto("ward a")\ngoto("ward b")\n',
        'goto("ward b")\ngoto("ward a")\n',
        "Soll ich zu Station A fahren und dann zu Station B fahren"
        " oder zu Station B fahren und dann zu Station A fahren?",
    ),
}


@pytest.mark.parametrize("story", QUESTIONS.values(), ids=QUESTIONS)
def test_a_close_second_is_asked_about_by_what_differs(
    story: tuple[str, str, str, str, str],
) -> None:
    language, text, one, other, message = story
    question = decided(text, one, other, language=language)
    assert isinstance(question, Open)
    assert question.question.message == message
    assert question.question.suggestions == tuple(offer.told for offer in question.offers)
    first, second = (offer.chosen for offer in question.offers)
    assert first.confidence > second.confidence > 0
    assert first.considered.program != second.considered.program


def test_a_second_that_is_far_behind_is_not_asked_about() -> None:
    asked = turn("ward a should get a wave or a hello")
    wave = draft(asked, 'goto("ward a")\ngesture("wave")\n', 0.8)
    hello = draft(asked, 'goto("ward a")\nsay("Hello!")\n', 0.2)
    chosen = decide(asked, [wave, hello], WARD)
    assert isinstance(chosen, Chosen)
    assert (chosen.draft, chosen.confidence) == (wave, 0.8)


def test_a_question_that_nobody_could_listen_to_is_not_asked() -> None:
    say = "".join(f'say("Lunch is ready, number {number}.")\n' for number in ("one", "two", "six"))
    text = "tell ward a: Lunch is ready, number one, number two, number six"
    result = decided(text, f'goto("ward a")\n{say}', f'{say}goto("ward a")\n')
    told = [offer.told for offer in result.offers] if isinstance(result, Open) else []
    assert all(len(each) <= deciding.LONGEST for each in told)


# --- two planners


def of_rules(text: str, written: str) -> Chosen:
    asked = turn(text)
    considered = consider(asked, draft(asked, written))
    assert considered is not None
    return Chosen(considered, 0.2)


def test_two_planners_of_which_neither_is_sure_are_asked_about_by_what_differs(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = "ward a should get a wave or a hello"
    rules = of_rules(text, 'goto("ward a")\nsay("Hello!")\n')
    monkeypatch.setattr(deciding, "confidence", lambda *known: 0.3)
    model = decided(text, 'goto("ward a")\ngesture("wave")\n')
    question = between(turn(text), rules, model)
    assert isinstance(question, Open)
    assert question.question.message == "Shall I make the gesture wave, or say “Hello!”?"
    assert [offer.chosen.plan for offer in question.offers][1] == rules.plan


def test_what_two_planners_mean_is_right_however_unsure_each_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    text = "ward a should get a wave"
    rules = of_rules(text, 'goto("ward a")\ngesture("wave")\n')
    monkeypatch.setattr(deciding, "confidence", lambda *known: 0.3)
    model = decided(text, 'goto("ward a")\ngesture("wave")\n')
    assert between(turn(text), rules, model) is rules


def test_a_planner_that_is_sure_is_believed_against_one_that_is_not() -> None:
    text = "ward a should get a wave or a hello"
    rules = of_rules(text, 'goto("ward a")\nsay("Hello!")\n')
    model = decided(text, 'goto("ward a")\ngesture("wave")\n')
    assert isinstance(model, Chosen)
    assert between(turn(text), rules, model) is model


@pytest.mark.parametrize(("likely", "shown"), [(0.7, True), (0.2, False)])
def test_where_the_other_knows_nothing_what_is_unlikely_is_asked(
    likely: float, shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    text = "ward a should get a wave"
    rules = of_rules(text, 'goto("ward a")\ngesture("wave")\n')
    monkeypatch.setattr(deciding, "confidence_alone", lambda *known: likely)
    found = between(turn(text), rules, Refusal("What is a wave?"))
    assert (found is rules) is shown
    if not shown:
        assert isinstance(found, Open)
        assert [offer.chosen.plan for offer in found.offers] == [rules.plan]


# --- refusals


def test_what_is_not_likely_enough_is_not_shown() -> None:
    asked = turn("ward a should get a wave or a hello")
    wave = draft(asked, 'goto("ward a")\ngesture("wave")\n', 0.4)
    elsewhere = draft(asked, 'goto("corridor")\n', 0.6)
    opened = decide(asked, [elsewhere, wave], WARD)
    assert isinstance(opened, Open)
    [offer] = opened.offers
    assert offer.chosen.draft is wave


@pytest.mark.parametrize(
    ("language", "text"),
    [
        ("en", "ward a should get a wave"),
        ("de", "Station A sollte ein Winken bekommen"),
        ("fr", "pour le service A un signe"),
    ],
)
def test_what_nobody_asked_for_is_not_shown(language: str, text: str) -> None:
    refusal = decided(text, 'goto("corridor")\n', 'call("Alice")\n', language=language)
    assert isinstance(refusal, Refusal)
    assert refusal.message == turn(text, language).language.phrase("not_sure_enough")


def test_what_must_not_be_is_refused_with_its_reason_and_for_good() -> None:
    refusal = decided("hand Henry some medicine", 'goto("ward b")\ngive("medicine", "Henry")\n')
    assert isinstance(refusal, Refusal)
    assert refusal.message == turn("").language.phrase("no_medicine")
    assert refusal.final


def test_what_is_too_much_is_refused_with_its_reason() -> None:
    refusal = decided("a turn of 99999 degrees would be nice", "turn(99999)\n")
    assert isinstance(refusal, Refusal)
    assert "36000" in refusal.message
    assert not refusal.final


def test_no_drafts_are_no_answer() -> None:
    asked = turn("ward a should get a wave")
    assert isinstance(decide(asked, [], WARD), Refusal)


def test_what_a_planner_knows_exactly_is_not_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = turn("go to ward a")
    exact = draft(asked, 'goto("ward a")\n', 0.9)
    exact = Draft(exact.plan, "grammar", 0.9, Context(), exact=True)
    monkeypatch.setitem(__import__("sys").modules, "nl2robot.deliberation.voting", None)
    chosen = decide(asked, [exact], WARD)
    assert isinstance(chosen, Chosen)
    assert chosen.confidence == 0.9
    threat = draft(asked, 'say("I will kill you.")\n', 0.9)
    refusal = decide(asked, [Draft(threat.plan, "grammar", 0.9, Context(), exact=True)], WARD)
    assert isinstance(refusal, Refusal)
