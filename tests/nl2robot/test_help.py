"""What can I say? Asked on the command line, in conversation and over the wire."""

import json

import pytest

from grammar.language import languages
from grammar.samples import samples
from nl2robot.cli.main import main
from nl2robot.knowledge import Knowledge
from nl2robot.translate.teaching import topic_of
from nl2robot.translate.translation import translate
from sim.world.builtin import builtin_worlds
from sim.world.loading import load_world


@pytest.fixture
def phrases(capsys):
    def phrases(*options: str) -> dict[str, list[str]]:
        assert main(["phrases", "--json", *options]) == 0
        return json.loads(capsys.readouterr().out)

    return phrases


@pytest.mark.parametrize("world", builtin_worlds())
@pytest.mark.parametrize("language", languages())
def test_every_phrase_that_is_shown_is_understood(phrases, world, language) -> None:
    topics = phrases("--world", world, "--lang", language)
    knowledge = Knowledge(load_world(world))
    assert len(topics) >= 6
    for topic, examples in topics.items():
        assert examples, topic
        for phrase in examples:
            translation = translate(phrase, knowledge, language)
            understood = translation.program or translation.request
            assert understood, f"{phrase}: {translation.message}"


def test_the_phrases_are_of_this_world(phrases) -> None:
    shown = " ".join(
        phrase for examples in phrases("--world", "ward").values() for phrase in examples
    )
    places = [place.name for place in load_world("ward").places]
    assert any(place in shown for place in places)
    assert "radiology" not in shown


def test_a_topic_may_be_asked_for(phrases, capsys) -> None:
    assert list(phrases("driving")) == list(phrases("drive")) == ["driving"]
    assert list(phrases("loops")) == ["loops and conditions"]
    assert main(["phrases", "quantum physics"]) == 2
    assert "The topics are:" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("language", "words", "topic"),
    [
        ("fr", "les routines", "routines"),
        ("fr", "me déplacer", "se déplacer"),
        ("de", "zum Fahren", "Fahren"),
        ("de", "die Routinen", "Routinen"),
        ("en", "the things", "things"),
    ],
)
def test_an_article_tells_no_topic(language, words, topic) -> None:
    topics = samples(Knowledge(load_world("city-hospital")).lexicon(language), language)
    assert topic_of(words, [*topics]) == topic


def test_people_see_topics_and_phrases(capsys) -> None:
    assert main(["phrases"]) == 0
    shown = capsys.readouterr().out
    assert "Driving\n" in shown
    assert "  go to the lobby\n" in shown


def test_the_routines_of_this_robot_can_be_said(phrases, capsys) -> None:
    assert not any("tea dance" in phrase for phrase in phrases("routines")["routines"])
    assert main(["routines", "learn", "tea dance", "wave", "--yes"]) == 0
    capsys.readouterr()
    assert "do the tea dance" in phrases("routines")["routines"]


@pytest.mark.parametrize(
    ("words", "about"),
    [
        ("What can I say?", ""),
        ("help", ""),
        ("hey robot, tell me what I can say please", ""),
        ("what do you understand?", ""),
        ("what can I say about driving?", "driving"),
        ("show me some examples about people", "people"),
    ],
)
def test_help_is_a_sentence_like_others(words, about) -> None:
    answer = translate(words, Knowledge(load_world("city-hospital")))
    assert (answer.status, answer.program) == ("ok", None)
    assert (answer.request.kind, answer.request.part) == ("help", about)
    assert "go to the lobby" in answer.suggestions or about != "driving"


@pytest.mark.parametrize("words", ["help the visitor", "what can Alice say", "what can I eat"])
def test_what_sounds_alike_is_no_call_for_help(words) -> None:
    answer = translate(words, Knowledge(load_world("city-hospital")))
    assert answer.request is None


def test_in_chat_help_is_shown_in_full(monkeypatch, capsys) -> None:
    said = iter(["what can I say?", "?", "help about driving", "bye"])
    monkeypatch.setattr("builtins.input", lambda _: next(said))
    assert main(["chat", "--world", "ward"]) == 0
    shown = capsys.readouterr().out
    assert shown.count("Speaking\n") == 2
    assert shown.count("Driving\n") == 3


@pytest.mark.parametrize("world", builtin_worlds())
def test_german_phrases_have_capitals_and_the_right_gender(phrases, world, capsys) -> None:
    assert main(["phrases", "--lang", "de", "--world", world]) == 0
    shown = capsys.readouterr().out
    assert "Gesten und Bildschirm\n" in shown and "Abläufe und Bedingungen\n" in shown
    assert "stell es" not in shown
    assert "Ladestation" not in shown  # nobody is led there, and no crowd is counted there


def test_a_long_phrase_stays_on_a_line(capsys) -> None:
    assert main(["phrases", "--lang", "fr"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert all(line.startswith("  ") or line[:1].isupper() for line in lines)
