"""Who wants another language asks for it in that one."""

import functools
from collections.abc import Iterator
from datetime import datetime
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from grammar.language import known_by_word, languages
from nl2robot.console.desk.dialogue import Dialogue
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.review.review import Review, review
from nl2robot.run.present import Present
from nl2robot.run.sightings import Sightings
from nl2robot.translate.other_language import accepted, language_of, question
from nl2robot.translate.talk import Talk
from nl2robot.translate.talks import Talks
from nl2robot.translate.translation import translate
from nl2robot.words import words_in
from nl2robot.work import here
from sim.world.loading import load_world

KNOWLEDGE = Knowledge(load_world(DEFAULT_WORLD))


@pytest.mark.parametrize(
    ("language", "said", "asked_for"),
    [
        ("en", "sprich Deutsch", "de"),
        ("en", "Deutsch bitte", "de"),
        ("en", "sprich Französisch", "fr"),
        ("fr", "speak German", "de"),
        ("en", "en français s'il te plaît", "fr"),
        ("de", "speak English please", "en"),
        ("de", "auf Englisch bitte", "en"),
        ("fr", "English please", "en"),
        ("fr", "können wir Deutsch reden?", "de"),
    ],
)
def test_a_visitor_asks_for_their_own_language(language, said, asked_for) -> None:
    translation = translate(said, KNOWLEDGE, language)
    assert translation.status == "ok"
    assert translation.program == f'robot.set_language("{asked_for}")\n'


@pytest.mark.parametrize("said", ["fahr in die Deutsch", "geh zur Lobby und sprich Deutsch"])
def test_nothing_else_is_understood_in_another_language(said) -> None:
    assert translate(said, KNOWLEDGE, "en").program is None


@pytest.mark.parametrize("language", ["en", "de", "fr"])
@pytest.mark.parametrize(
    "cry", ["stop!", "halt", "freeze", "stopp", "anhalten!", "arrête", "arrêtez-vous !"]
)
def test_a_cry_of_stop_is_heard_in_every_language(language, cry) -> None:
    assert translate(cry, KNOWLEDGE, language).program == "robot.stop()\n"


def test_every_language_is_known_by_its_name() -> None:
    named = {"en": "speak English", "de": "sprich Deutsch", "fr": "parle français"}
    for code in languages():
        assert code in known_by_word(named[code])


@pytest.mark.parametrize(
    ("language", "said", "told"),
    [
        ("de", "sprich Englisch und sag Alice, wenn du fertig bist", "I have finished."),
        ("de", "sprich Französisch und sag mir, wenn du fertig bist", "J'ai terminé."),
        ("de", "sprich Englisch und richte Alice einen schönen Gruß aus", "kind regards"),
        ("en", "speak German and give Alice my regards", "einen schönen Gruß"),
        ("fr", "parle anglais et remercie Alice", "Thank you."),
    ],
)
def test_what_it_has_ready_is_said_in_the_language_it_is_to_speak(language, said, told) -> None:
    program = translate(said, KNOWLEDGE, language).program
    assert program is not None
    assert told in program


# --- offered ------------------------------------------------------------------------------------

GRAMMAR = Path(__file__).parents[1] / "grammar"


def _strings(data) -> Iterator[str]:
    if isinstance(data, str):
        yield data
    elif isinstance(data, list):
        for each in data:
            yield from _strings(each)
    elif isinstance(data, dict):
        for key, value in data.items():
            if key not in ("means", "meaning", "world"):
                yield from _strings(value)


@functools.cache
def said_in(language: str) -> tuple[str, ...]:
    """The sentences of the tests of the grammar in a language."""
    files = [
        *GRAMMAR.glob(f"sentences_{language}*.yaml"),
        *GRAMMAR.glob(f"not_commands_{language}*.yaml"),
    ]
    read = (yaml.safe_load(file.read_text(encoding="utf-8")) for file in files)
    return tuple(each for data in read for each in _strings(data) if each != "not yet")


@pytest.mark.parametrize("language", languages())
def test_hardly_anybody_is_offered_another_language_than_they_speak(language) -> None:
    sentences = said_in(language)
    wrong = [each for each in sentences if language_of(each, language) is not None]
    assert len(sentences) > 500
    assert len(wrong) < 0.01 * len(sentences), wrong


@pytest.mark.parametrize("spoken", languages())
@pytest.mark.parametrize("language", languages())
def test_who_speaks_another_language_is_offered_it(language, spoken) -> None:
    if spoken == language:
        return
    sentences = said_in(spoken)
    found = [each for each in sentences if language_of(each, language) == spoken]
    assert len(found) > 0.85 * len(sentences)


@pytest.mark.parametrize("language", languages())
def test_the_offer_can_be_answered_in_either_language(language) -> None:
    for code in languages():
        assert accepted(words_in(code)["accept"], code, language)
        assert accepted("yes", code, "en") and not accepted("no", code, "en")
        assert len(question(code, language).splitlines()) == 2


def test_a_nurse_writes_german_and_goes_on_in_it(start) -> None:
    chat = start("chat", at_terminal=True)
    chat.until("you: ")
    chat.type("fahr zur Apotheke\n")
    chat.until("You wrote in German. Shall I go on in German?")
    chat.until("Soll ich auf Deutsch weitermachen?")
    chat.type("ja\n")
    assert "Ich werde zur Apotheke fahren" in chat.until("erwerfen? ")
    chat.type("v\n")
    chat.until("Sie: ")
    chat.type("va à la pharmacie\n")
    chat.until("weitermachen?")
    chat.type("nein\n")
    assert "nicht verstanden" in chat.until("Sie: ")
    chat.type("va à la cuisine\n")  # was declined, so nobody is asked again
    assert "weitermachen" not in chat.until("Sie: ")
    chat.type("ende\n")
    assert chat.end() == 0


def test_in_the_console_too() -> None:
    knowledge = Knowledge(load_world(DEFAULT_WORLD))
    dialogue = Dialogue(_backstage(knowledge), "test")
    dialogue.say("fahr zur Apotheke", "en", "Nurse Kim")
    line = dialogue.lines[-1]
    assert line.tone == "question" and "You wrote in German" in line.text
    dialogue.say(line.suggestions[0], "en", "Nurse Kim")
    assert dialogue.lines[-1].text == "Ich werde zur Apotheke fahren."
    dialogue.say("komm zurück zum Empfang", "en", "Nurse Kim")  # and on it goes
    assert "Empfang" in dialogue.lines[-1].text
    dialogue.say("va à la pharmacie", "fr", "Nurse Kim")  # the page's language was changed
    assert dialogue.lines[-1].text == "Je vais aller à la pharmacie."


def test_who_declines_in_the_console_is_not_asked_again() -> None:
    dialogue = Dialogue(_backstage(Knowledge(load_world(DEFAULT_WORLD))), "test")
    dialogue.say("fahr zur Apotheke", "en", "Nurse Kim")
    dialogue.say("no", "en", "Nurse Kim")
    assert dialogue.lines[-1].tone != "question"
    assert "fahr" in dialogue.lines[-1].text
    dialogue.say("fahr ins Labor", "en", "Nurse Kim")
    assert dialogue.lines[-1].tone != "question"


# --- no model guesses at them -------------------------------------------------------------------

FOREIGN = "Bitte schau in jedem Zimmer nach, ob dort ein Rollstuhl steht, und sag es mir"


def test_a_model_is_not_asked_about_what_is_in_another_language(scripted) -> None:
    """It would make something of it; a wrong program is worse than a question."""
    writer = scripted({FOREIGN: ['for room in places("ward"):\n    goto(room)\n']})
    talk = Talk()
    translation = translate(FOREIGN, KNOWLEDGE, "en", talk=talk)
    assert translation.status == "rejected" and not writer.asked
    again = translate(FOREIGN, KNOWLEDGE, "en", talk=talk)  # who insists is meant as it stands
    assert writer.asked and again.status != "rejected"


def test_what_is_quoted_in_another_language_is_for_the_model_all_the_same(scripted) -> None:
    said = 'the folks in ward a might enjoy a "Ich wünsche Ihnen einen schönen guten Morgen"'
    writer = scripted({said: ['goto("ward a")\nsay("Ich wünsche Ihnen ...")\n']})
    translate(said, KNOWLEDGE, "en")
    assert writer.asked


def test_where_nobody_can_be_asked_they_are_told(start) -> None:
    run = start("run", "fahr zur Apotheke", "--yes")
    assert run.end() == 3
    assert "This seems to be German. Say so with --lang de." in " ".join(run.output.split())


class _Runner:
    def __init__(self, knowledge: Knowledge) -> None:
        self.knowledge = knowledge
        self.present = Present(lambda state: None)
        self.sightings = Sightings()
        self.think = here

    def state(self) -> None:
        return None

    def unfinished(self) -> None:
        return None

    def last(self) -> None:
        return None

    def check(
        self, program: str, language: str, continues: int | None, at: datetime | None
    ) -> Review:
        return review(program, self.knowledge, None, language=language)


def _backstage(knowledge: Knowledge) -> Any:
    heard = SimpleNamespace(call=lambda method, arguments, stop: None)
    return SimpleNamespace(runner=_Runner(knowledge), driver=heard, talks=Talks(), schedule=None)
