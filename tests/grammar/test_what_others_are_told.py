"""What others are asked and told: all of it is theirs, and no part of it is done by the robot."""

from __future__ import annotations

import re

import pytest

from tests.grammar.test_kinds import program, said


def spoken(language: str, words: str) -> str:
    """What is said or asked, where the robot does nothing else than find who hears it."""
    text = program(language, words)
    methods = set(re.findall(r"robot\.(\w+)\(", text))
    assert methods <= {"find", "say", "ask"} and "while" not in text, (words, text)
    return re.findall(r"robot\.(?:say|ask)\(\"(.*?)\"", text)[0]


def is_refused(language: str, words: str) -> None:
    assert said(language, words).program is None, words


# --- two things that somebody is to do


@pytest.mark.parametrize(
    ("language", "words", "text"),
    [
        (
            "en",
            "ask Maria to water the plants and to bring the key to Bob",
            "Please water the plants and bring the key to Bob.",
        ),
        (
            "en",
            "tell Henry to put on his shoes and to go to the cafeteria",
            "Please put on your shoes and go to the cafeteria.",
        ),
        (
            "de",
            "Sag Henry, er soll seine Jacke holen und dann in die Cafeteria gehen.",
            "Bitte holen Sie Ihre Jacke und gehen Sie in die Cafeteria.",
        ),
        (
            "de",
            "Maria soll das Fenster schliessen und Bob anrufen.",
            "Bitte schliessen Sie das Fenster und rufen Sie Bob an.",
        ),
        (
            "fr",
            "Demande à Maria de fermer la porte et de chercher Bob.",
            "Veuillez fermer la porte et chercher Bob.",
        ),
        (
            "fr",
            "Dis à Henry de se lever, puis d'aller à la pharmacie.",
            "Veuillez vous lever, puis aller à la pharmacie.",
        ),
        (
            "fr",
            "Dis à Bob de s'asseoir et de tourner à gauche.",
            "Veuillez vous asseoir et tourner à gauche.",
        ),
    ],
)
def test_whatever_somebody_is_asked_to_do_is_asked_of_them(
    language: str, words: str, text: str
) -> None:
    assert spoken(language, words) == text


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "tell Henry to lie down and get some rest"),
        ("en", "ask Maria to find Bob and send him to radiology"),
        ("en", "tell Bob to take a deep breath and turn right"),
        ("en", "tell Maria that I am at the pharmacy and to wait for me"),
        ("de", "Frag Henry, ob er daran denkt, die Tasse in die Küche zu bringen."),
        ("de", "Sag Bob, er soll Maria anrufen und ihr sagen, dass das Essen fertig ist."),
        ("fr", "Dis à Maria que le repas est prêt et de venir."),
        ("en", "tell Henry he may not smoke and to open the window"),
    ],
)
def test_what_may_be_for_them_is_not_done_by_the_robot(language: str, words: str) -> None:
    is_refused(language, words)


@pytest.mark.parametrize(
    ("language", "words", "then"),
    [
        ("en", "tell Henry to sit down and come back", "robot.goto(start)"),
        ("en", "tell Henry to wait and bring him a cup", 'robot.grab("cup")'),
        ("de", "Sag Henry, er soll warten, und fahr in die Lobby.", 'robot.goto("lobby")'),
        ("fr", "Dis à Henry d'attendre et reviens.", "robot.goto(start)"),
    ],
)
def test_what_only_the_robot_can_be_meant_for_is_done(language: str, words: str, then: str) -> None:
    assert then in program(language, words)


# --- until when, and after what


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("tell Henry to rest until four", "Please rest until four."),
        ("ask Maria not to leave until Bob comes", "Please do not leave until Bob comes."),
        ("order Bob to mind the desk till noon", "Please mind the desk till noon."),
    ],
)
def test_until_when_somebody_is_to_do_it_is_told_once(words: str, text: str) -> None:
    assert spoken("en", words) == text


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "tell Maria that lunch begins when Bob arrives"),
        ("en", "ask Henry to call me as soon as Clara comes"),
        ("de", "Sag Maria, dass wir essen, sobald Bob kommt."),
        ("fr", "Dis à Maria que nous mangeons quand Bob arrive."),
    ],
)
def test_who_waits_for_somebody_is_not_guessed(language: str, words: str) -> None:
    assert "wait" not in (said(language, words).program or "")


# --- what they say of themselves, and what they say of the robot


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "ask Bob what hurts and if he says it is his knee, call Clara"),
        ("en", "ask Maria how she feels, and if she says she is dizzy, fetch Bob"),
        ("de", "Frag Maria, was ihr fehlt, und wenn sie sagt, ihr Knie, ruf Bob an."),
    ],
)
def test_nobody_speaks_of_themselves_as_he_or_she(language: str, words: str) -> None:
    is_refused(language, words)


@pytest.mark.parametrize(
    ("words", "text"),
    [
        ("ask Henry if he trusts you", "Do you trust me?"),
        ("ask Maria whether she likes your voice", "Do you like my voice?"),
        ("ask Bob what he wants you to bring", "What do you want me to bring?"),
        ("ask Bob to step aside so you can turn", "Please step aside so I can turn."),
        ("tell Maria that you're waiting at the pharmacy", "I'm waiting at the pharmacy."),
    ],
)
def test_the_robot_speaks_of_itself_as_itself(words: str, text: str) -> None:
    assert spoken("en", words) == text


@pytest.mark.parametrize(
    "words", ["tell Henry you are a machine", "ask Bob if he believes you are clever"]
)
def test_who_is_meant_by_you_is_not_guessed(words: str) -> None:
    is_refused("en", words)


# --- what is to end, and what is named


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "stop driving to the pharmacy"),
        ("en", "stop saying goodbye"),
        ("en", "stop looking for Henry"),
        ("de", "Hör auf, in die Apotheke zu fahren."),
        ("de", "Hören Sie auf, Henry zu suchen."),
        ("fr", "Arrête de chercher Henry."),
    ],
)
def test_what_is_to_end_is_not_done(language: str, words: str) -> None:
    assert program(language, words) == "robot.stop()\n"


@pytest.mark.parametrize(
    ("words", "plainly"),
    [
        ("fetch both the cup and the book", "fetch the cup and the book"),
        ("give both the pen and the cup to Henry", "give the pen and the cup to Henry"),
        ("check both the kitchen and the lobby", "check the kitchen and the lobby"),
        (
            "if there are no cups left in the kitchen, tell Bob",
            "if there are no cups in the kitchen, tell Bob",
        ),
        (
            "wait until there is nobody left in the lobby",
            "wait until there is nobody in the lobby",
        ),
    ],
)
def test_both_and_what_is_left_are_no_amount_and_no_side(words: str, plainly: str) -> None:
    assert program("en", words) == program("en", plainly)
