"""Courtesy is answered with courtesy, and moves nothing; an order stays an order."""

import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.translate.outcome import Translation
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from sim.world.loading import load_world


@pytest.fixture(scope="module")
def knowledge() -> Knowledge:
    return Knowledge(load_world("city-hospital"))


def said(words: str, knowledge: Knowledge, language: str = "en", talk: Talk | None = None):
    return translate(words, knowledge, language, "grammar", talk)


def is_courteous(translation: Translation) -> bool:
    return translation.status == "ok" and translation.program is None and not translation.request


@pytest.mark.parametrize(
    ("language", "words", "answer"),
    [
        ("en", "hello", "Hello. What can I do for you?"),
        ("en", "Good morning!", "Good morning. What can I do for you?"),
        ("en", "hi robot, how are you?", "Hello. I am fine, thank you. What can I do for you?"),
        ("en", "thanks a lot", "You are welcome."),
        ("en", "ok thank you, goodbye", "You are welcome. Goodbye."),
        ("en", "good evening", "Good evening. What can I do for you?"),
        ("en", "thnak you", "You are welcome."),
        ("en", "helo robot", "Hello. What can I do for you?"),
        ("de", "Na Roboter, wie geht es dir?", "Mir geht es gut, danke. Was kann ich für Sie tun?"),
        ("de", "guten Morgen", "Guten Morgen. Was kann ich für Sie tun?"),
        ("de", "Dnake", "Gern geschehen."),
        ("de", "auf Wiedersehen", "Auf Wiedersehen."),
        ("fr", "Bonjour !", "Bonjour. Que puis-je faire pour vous ?"),
        ("fr", "merci beaucoup", "Je vous en prie."),
        ("fr", "bonsoir", "Bonsoir. Que puis-je faire pour vous ?"),
        ("fr", "au revoir", "Au revoir."),
    ],
)
def test_a_courtesy_is_answered(language, words, answer, knowledge) -> None:
    translation = said(words, knowledge, language)
    assert is_courteous(translation)
    assert translation.message == answer


@pytest.mark.parametrize(
    ("language", "words"),
    [("en", "who are you?"), ("de", "wer bist du?"), ("fr", "qui es-tu ?"),
     ("en", "what can you do?"), ("de", "was kannst du?"), ("fr", "que sais-tu faire ?")],
)  # fmt: skip
def test_who_it_is_and_what_it_can_do_is_told(language, words, knowledge) -> None:
    translation = said(words, knowledge, language)
    assert is_courteous(translation)
    assert len((translation.message or "").split()) > 3


@pytest.mark.parametrize(
    ("language", "words", "part"),
    [
        ("en", "good morning, go to the lobby", 'robot.goto("lobby")'),
        ("en", "say hello to Bob", 'robot.find("Bob")'),
        ("en", "thank Bob", 'robot.find("Bob")'),
        ("en", "say good morning", 'robot.say("Good morning.")'),
        ("de", "guten Tag, fahr zur Apotheke", 'robot.goto("pharmacy")'),
        ("fr", "bonjour, va à la pharmacie", 'robot.goto("pharmacy")'),
        ("fr", "dis bonjour à Bob", 'robot.find("Bob")'),
        ("de", "halt", "robot.stop()"),
    ],
)
def test_an_order_stays_an_order(language, words, part, knowledge) -> None:
    translation = said(words, knowledge, language)
    assert translation.program is not None and part in translation.program


def test_thanks_in_between_do_not_disturb_the_talk(knowledge) -> None:
    talk = Talk()
    said("go to the lobby", knowledge, talk=talk)
    assert is_courteous(said("thank you", knowledge, talk=talk))
    assert said("no, the pharmacy", knowledge, talk=talk).program == 'robot.goto("pharmacy")\n'


def test_an_answer_to_a_question_back_is_no_courtesy(knowledge) -> None:
    talk = Talk()
    asked = said("go to the ward", knowledge, talk=talk)
    assert asked.status == "clarify"
    assert not is_courteous(said("hello", knowledge, talk=talk))
