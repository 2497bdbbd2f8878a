"""Standing orders: what happens on a ward, and what is to be done each time."""

from __future__ import annotations

import pytest

from grammar.language import load_language
from grammar.requests import Request
from grammar.standing_orders.happenings import Happening
from grammar.standing_orders.orders import goes_on, said_of, standing_order
from grammar.understand import understand
from tests.grammar.hospitals import hospital


def order(sentence: str, language: str) -> Request | None:
    return standing_order(sentence, hospital(language), load_language(language))


def check(sentence: str, language: str, means: Happening, part: str) -> None:
    found = order(sentence, language)
    assert found is not None, sentence
    assert (found.happening, found.sentence) == (means, part)
    inner = understand(part, hospital(language), language, said_of(found))
    assert inner.plan is not None, inner.message


COMES = Happening("seen", thing="person", place="lobby")


@pytest.mark.parametrize(
    "sentence, means, part",
    [
        (
            "whenever somebody comes into the lobby, greet them",
            COMES,
            "greet them",
        ),
        (
            "Every time a visitor enters the lobby, ask them whether they need help.",
            Happening("seen", thing="visitor", place="lobby"),
            "ask them whether they need help",
        ),
        ("each time you see someone say hello", Happening("seen", thing="person"), "say hello"),
        ("greet them whenever somebody comes into the lobby", COMES, "greet them"),
        (
            "whenever the battery is below 20 %, go and charge",
            Happening("battery", below=20),
            "go and charge",
        ),
        ("if ever you run low on battery, go and charge", Happening("battery", below=20), None),
        ("each time you get to the lobby, say welcome", Happening("place", place="lobby"), None),
        (
            "whenever a visitor says help, say I am coming",
            Happening("heard", text="help"),
            "say I am coming",
        ),
        ("if ever a badge is scanned, say thank you", Happening("scanned"), None),
        (
            "whenever somebody presses the red button on your face, go to the lobby",
            Happening("pressed", text="Red button"),
            None,
        ),
        (
            'whenever somebody presses the button "Call a nurse", go to the lobby',
            Happening("pressed", text="Call a nurse"),
            None,
        ),
        (
            "whenever somebody comes into the lobby, greet them, but at most once an hour",
            Happening("seen", thing="person", place="lobby", rate=3600.0),
            "greet them",
        ),
        (
            "from now on, when somebody comes into the lobby, greet them no more than every 10"
            " minutes",
            Happening("seen", thing="person", place="lobby", rate=600.0),
            "greet them",
        ),
        (
            "when somebody comes into the lobby, greet them",
            Happening("seen", thing="person", place="lobby", once=True),
            "greet them",
        ),
    ],
)
def test_in_english(sentence: str, means: Happening, part: str | None) -> None:
    check(sentence, "en", means, part or sentence.partition(", ")[2])


@pytest.mark.parametrize(
    "sentence, means",
    [
        ("immer wenn jemand kommt, begrüße ihn", Happening("seen", thing="person")),
        ("Jedes Mal, wenn ein Besucher kommt, frag ihn, ob er Hilfe braucht", None),
        ("wann immer der Akku unter 20 % fällt, geh laden", Happening("battery", below=20)),
        ("immer wenn der Akku schwach wird, geh laden", Happening("battery", below=20)),
        (
            "immer wenn jemand den roten Knopf auf deinem Gesicht drückt, sag Hilfe kommt",
            Happening("pressed", text="Roter Knopf"),
        ),
        (
            "immer wenn die grüne Taste gedrückt wird, sag danke",
            Happening("pressed", text="Grüne Taste"),
        ),
        ("immer wenn ein Ausweis gescannt wird, sag danke", Happening("scanned")),
        ("sooft jemand Hilfe ruft, sag ich komme", Happening("heard", text="Hilfe")),
        (
            "immer wenn jemand kommt, begrüße ihn, aber höchstens einmal in der Stunde",
            Happening("seen", thing="person", rate=3600.0),
        ),
        ("sobald jemand kommt, begrüße ihn", Happening("seen", thing="person", once=True)),
    ],
)
def test_in_german(sentence: str, means: Happening | None) -> None:
    found = order(sentence, "de")
    assert found is not None
    if means is not None:
        assert found.happening == means
    assert understand(found.sentence, hospital("de"), "de", said_of(found)).plan is not None


@pytest.mark.parametrize(
    "sentence, means",
    [
        ("chaque fois que quelqu'un arrive, salue-le", Happening("seen", thing="person")),
        (
            "à chaque fois que la batterie descend sous 20 %, va te recharger",
            Happening("battery", below=20),
        ),
        (
            "chaque fois que quelqu'un appuie sur le bouton rouge de ton visage, dis bonjour",
            Happening("pressed", text="Bouton rouge"),
        ),
        ("si jamais un badge est scanné, dis merci", Happening("scanned")),
        (
            "toutes les fois qu'un visiteur dit au secours, dis j'arrive",
            Happening("heard", text="au secours"),
        ),
        (
            "chaque fois que quelqu'un arrive, salue-le, au plus une fois par heure",
            Happening("seen", thing="person", rate=3600.0),
        ),
        ("dès que quelqu'un arrive, salue-le", Happening("seen", thing="person", once=True)),
    ],
)
def test_in_french(sentence: str, means: Happening) -> None:
    found = order(sentence, "fr")
    assert found is not None
    assert found.happening == means
    assert understand(found.sentence, hospital("fr"), "fr", said_of(found)).plan is not None


@pytest.mark.parametrize(
    "sentence",
    [
        "go to the lobby and whenever somebody comes, greet them",  # a part of an errand
        "stay in the lobby. Whenever somebody comes, greet them",
        "whenever somebody comes, greet them. Then go to ward a",  # where it ends, nobody can tell
        "whenever somebody comes into the lobby between nine and ten, greet them",
        "tell Bob to call me whenever somebody comes into the lobby",  # it may be in the message
        "whenever I say evening round, go to the lobby",  # a routine
        "whenever you find one, say hello",
        "whenever it is a full hour, say hello",
        "every morning at eight go to the lobby",
        "go to the lobby and say hello each time",
        "whenever the battery is below 0 %, go and charge",
        "whenever somebody comes into the lobby",
    ],
)
def test_what_is_none(sentence: str) -> None:
    assert order(sentence, "en") is None


def test_what_is_done_for_a_while_is_not_done_each_time() -> None:
    found = order("whenever somebody comes, greet them until noon", "en")
    assert found is not None
    plan = understand(found.sentence, hospital("en"), "en", said_of(found)).plan
    assert plan is not None and goes_on(plan)
