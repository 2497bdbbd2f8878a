"""The robot speaks as whoever approved the program does, unless somebody chose another language."""

from queue import Queue

import pytest

from nl2robot.cli.operator import Operator


@pytest.fixture
def heard(operator) -> Queue:
    """The languages in which the robot speaks, one after the other."""
    languages: Queue[str] = Queue()
    operator.watch(lambda kind, data: languages.put(data["language"]), "speech")
    return languages


def runs(operator: Operator, program: str, language: str | None) -> None:
    approval = operator.approve(operator.check(program), language=language)
    assert operator.wait(operator.run(approval)).state == "done"


def test_german_words_have_a_german_voice(operator, heard) -> None:
    runs(operator, 'robot.say("Guten Morgen.")\n', "de")
    assert heard.get(timeout=30) == "de"
    runs(operator, 'robot.say("Good morning.")\n', "en")
    assert heard.get(timeout=30) == "en"
    runs(operator, 'robot.say("Bonjour.", language="fr")\nrobot.say("Hello.")\n', "en")
    assert [heard.get(timeout=30) for _ in range(2)] == ["fr", "en"]


def test_a_language_that_was_chosen_stays(operator, heard) -> None:
    runs(operator, 'robot.set_language("fr")\n', "en")
    runs(operator, 'robot.say("Bonjour.")\n', "en")
    assert heard.get(timeout=30) == "fr"
    runs(operator, 'robot.say("Bonjour.")\n', "de")
    assert heard.get(timeout=30) == "fr"


def test_a_program_of_nobodys_language_changes_none(operator, heard) -> None:
    operator.robot.set_language("de")
    runs(operator, 'robot.say("Hallo.")\n', None)
    runs(operator, 'robot.say("Hallo.")\n', "en")
    assert [heard.get(timeout=30) for _ in range(2)] == ["de", "de"]


def test_who_gives_it_back_has_not_chosen_for_others(operator, heard) -> None:
    """A visitor's language ends when they leave; the next program has its own again."""
    operator.robot.set_language("fr")
    operator.robot.set_language("en")
    runs(operator, 'robot.say("Guten Morgen.")\n', "de")
    assert heard.get(timeout=30) == "de"
