"""What French asks of the language engine, each as data that any language may use."""

from __future__ import annotations

from dataclasses import replace

import msgspec
import pytest

from grammar.language import load_language, speech
from grammar.lexicon import Lexicon, Name
from grammar.names import names_of
from grammar.naming import Naming, naming, place_called
from grammar.slots import Slots
from grammar.tokens import Spelling, tokenise, words_of
from grammar.wordforms import plural, singular

FRENCH = Spelling(accents_optional=True)


def test_a_word_is_the_same_with_and_without_its_accents() -> None:
    assert words_of("Répète à l'accueil, ma sœur", FRENCH) == words_of(
        "repete a l accueil, ma soeur", FRENCH
    )
    assert tokenise("la clé", FRENCH)[1].spelled == "clé"


@pytest.mark.parametrize(
    ("noun", "many"),
    [
        ("tasse", "tasses"),
        ("bouteille d'eau", "bouteilles d'eau"),
        ("tasse verte", "tasses vertes"),
    ],
)
def test_all_words_of_a_noun_change_up_to_where_it_ends(noun: str, many: str) -> None:
    data = {"until": ["d'", "de "], "endings": [["", "s"]], "singular_endings": [["", "s"]]}
    language = replace(load_language("en"), plurals=data)
    assert plural(noun, language) == many
    assert singular(many, language) == noun


@pytest.mark.parametrize(
    ("said", "value"), [("eleven twenty ten", 99), ("hundred eleven twenty ten", 199)]
)
def test_numbers_of_several_words(said: str, value: float) -> None:
    english = load_language("en")
    numbers = {**english.numbers, "compounds": {"eleven twenty": 90, "eleven twenty ten": 99}}
    language = replace(english, numbers=numbers)
    slots = Slots(names_of(language, Lexicon()), tokenise(said, language.spelling), {})
    end, _, found = max(slots.matches("{number}", 0))
    assert (end, found) == (len(said.split()), value)


def test_names_go_by_what_speakers_call_them() -> None:
    language = replace(
        load_language("en"), speech={"aliases_first": True, "looks": {"red": "rouge"}}
    )
    cup = Lexicon(objects=(Name("cup", aliases=("tasse", "gobelet")), Name("bed")))
    assert naming(cup, language).called("red cup") == "tasse rouge"
    assert naming(cup, language).called("bed") == "bed"
    assert naming(cup, load_language("en")) == Naming()
    assert place_called("kitchen", cup, load_language("en")) == "the kitchen"


def test_little_words_run_together_but_for_what_is_quoted() -> None:
    words = msgspec.structs.replace(speech("en"), joined=((r"\bto the\b", "tothe"),))
    assert words.joined_up("go to the lift and say “to the lift”") == (
        "go tothe lift and say “to the lift”"
    )


def test_articles_by_the_noun() -> None:
    nouns = msgspec.structs.replace(
        speech("en").nouns, articles=(("tass", "la {noun}", "une {noun}"),)
    )
    assert nouns.the("tasse") == "la tasse"
    assert nouns.indefinite("tasse") == "une tasse"
    assert nouns.the("cup") == "the cup"
