"""What German asks of the language engine, each as data that any language may use."""

from __future__ import annotations

import pytest

from grammar.language import load_language, speech
from grammar.naming import Naming
from grammar.tokens import Spelling, tokenise, words_of
from grammar.verbs import forms, ordered

TENSES = {
    "infinitive": "en",
    "irregular": {"nehmen": "nimm"},
    "changing": ["you"],
    "forms": {"bare": [["en$", ""]], "you": [["en$", "st"]]},
    "first": ["{bare}", "{you}"],
    "first_rarely": ["{infinitive}"],
    "last": ["{infinitive}"],
    "last_parted": ["{particle}{infinitive}"],
}


def test_a_verb_has_forms_for_the_beginning_and_the_end_of_a_clause() -> None:
    made = forms({"fetch": ["holen", "mit|nehmen"]}, TENSES)
    words = {name: [rule["say"] for rule in rules] for name, rules in made.items()}
    assert words == {
        "fetch_1": ["(holen|nehmen)", "(hol|holst|nehm|nimmst)"],
        "fetch_2": ["(holen|mitnehmen)"],
        "fetch_off": ["(mit)"],
        "fetch_whole": ["(holen)", "(hol|holst)"],
        "fetch_parting": ["(nehmen)", "(nehm|nimmst)"],
    }
    assert made["fetch_1"][0]["cost"] > made["fetch_1"][1]["cost"]


def test_a_marked_verb_stands_where_the_language_puts_it() -> None:
    orders = ["<VERB_1> REST <VERB_off>", "REST <VERB_2>"]
    assert list(ordered("~go <place>", orders, {})) == ["<go_1> <place>", "<place> <go_2>"]
    assert next(ordered("~get it", orders, {"get_off": []})) == "<get_1> it <get_off>"
    both = {"get_off": [], "get_whole": [], "get_parting": []}
    assert list(ordered("~get it", orders[:1], both)) == [
        "<get_whole> it",
        "<get_parting> it <get_off>",
    ]
    assert list(ordered("~tell her >> , why", orders, {})) == [
        "<tell_1> her , why",
        "her <tell_2> , why",
    ]
    assert list(ordered("stop", orders, {})) == ["stop"]


def test_letters_that_are_written_in_two_ways_are_the_same() -> None:
    spelling = Spelling(letters={"ü": "ue", "ß": "ss"})
    assert words_of("Grüße", spelling) == words_of("gruesse", spelling)
    token = tokenise("Küche", spelling)[0]
    assert (token.spelled, token.capital) == ("küche", True)


def test_names_keep_what_stands_before_them_where_the_language_does() -> None:
    naming = Naming({"cup": "Tasse"}, {"red": "rot"}, before_noun=True)
    assert naming.called("red cup") == "rot Tasse"


@pytest.mark.parametrize(
    ("marked", "written"),
    [
        ("zu ⟨dat⟩ die Apotheke fahren", "zur Apotheke fahren"),
        ("zu ⟨dat⟩ der Eingang fahren", "zum Eingang fahren"),
        ("⟨akk⟩ ein⟨m⟩ rot⟨e⟩ Becher nehmen", "einen roten Becher nehmen"),
        ("ein⟨n⟩ rot⟨e⟩ Buch", "ein rotes Buch"),
        ("⟨dat⟩ die jung⟨e⟩ Frau folgen", "der jungen Frau folgen"),
        ("auf ⟨akk⟩ ein⟨m⟩ Patient warten", "auf einen Patienten warten"),
        ("0.5 Meter fahren und „2.5“ sagen", "0,5 Meter fahren und „2.5“ sagen"),
    ],
)
def test_marks_become_cases(marked: str, written: str) -> None:
    assert speech("de").joined_up(marked) == written


def test_german_is_compiled_once_and_small() -> None:
    assert len(load_language("de").network.states) < 18_000  # English has 16,700
