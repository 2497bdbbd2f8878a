"""What keeps the folders of the languages tidy: nothing dead, and no name shared by accident."""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from string import Formatter

import pytest

from grammar.discourse import EACH, SETTING
from grammar.language import languages, load_language
from grammar.languages import registry
from grammar.meanings import speaking
from grammar.meanings.registry import MEANINGS
from grammar.network import RuleError

FOLDER = registry.FOLDER


def sources(language: str) -> dict[str, str]:
    return {path.stem: path.read_text(encoding="utf-8") for path in (FOLDER / language).glob("*")}


def rules_of(source: str) -> list[str]:
    """The names of the rules that a file writes down itself."""
    _, found, rest = f"\n{source}".partition("\nrules:\n")
    ours = re.split(r"\n(?=\w)", rest)[0] if found else ""
    return re.findall(r"^  (\w+):", ours, re.MULTILINE)


def test_every_meaning_is_used_by_some_language() -> None:
    used = {
        production.means or production.rule
        for language in languages()
        for production in load_language(language).network.productions
    }
    assert MEANINGS.keys() - used - {EACH, SETTING} == set()


@pytest.mark.parametrize("language", languages())
def test_every_rule_is_used_by_another(language: str) -> None:
    files = sources(language)
    everything = "\n".join(files.values())
    written = {rule for source in files.values() for rule in rules_of(source)}
    referred = set(re.findall(r"[<~](\w+)", everything))
    assert written - referred == {"utterance", "standing_order"}


@pytest.mark.parametrize("language", languages())
def test_a_rule_that_is_said_to_be_extended_is(language: str) -> None:
    control = sources(language)["control"]
    extended = re.search(r"^extended:\n((?:  .*\n)+)", control, re.MULTILINE)
    assert extended
    files_with = Counter(rule for source in sources(language).values() for rule in rules_of(source))
    assert [rule for rule in re.findall(r"\w+", extended[1]) if files_with[rule] < 2] == []


@pytest.mark.parametrize("language", languages())
def test_a_phrase_that_any_language_has_the_robot_say_can_be_said_in_every_other(
    language: str,
) -> None:
    """ "Sprich Englisch und sag Alice, wenn du fertig bist"."""
    productions = [each for code in languages() for each in load_language(code).network.productions]
    said = {str(each.fixed["phrase"]) for each in productions if each.means == "phrase"}
    meanings = Path(speaking.__file__).parent.glob("*.py")
    for source in meanings:
        said |= set(re.findall(r'ready_made\(d, "(\w+)"', source.read_text(encoding="utf-8")))
    assert {"finished", "greetings", "hello_name"} <= said
    assert said - load_language(language).phrases.keys() == set()


@pytest.mark.parametrize("language", languages())
def test_every_phrase_that_a_language_or_the_code_names_is_there(language: str) -> None:
    pack = load_language(language)
    named = {str(each.fixed.get("phrase", "hello")) for each in pack.network.productions}
    for folder in ("grammar", "nl2robot"):
        for source in (FOLDER.parents[1] / folder).rglob("*.py"):
            text = source.read_text(encoding="utf-8")
            named |= set(re.findall(r'\.(?:phrase\(|sentence\(|phrases\[)\s*"(\w+)"', text))
    assert named - pack.phrases.keys() == set()


@pytest.mark.parametrize("language", languages())
def test_a_phrase_has_the_same_gaps_in_every_language(language: str) -> None:
    ours, english = load_language(language).phrases, load_language("en").phrases
    shared = ours.keys() & english.keys()
    assert [name for name in shared if gaps(ours[name]) != gaps(english[name])] == []


def gaps(phrase: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(phrase) if name}


@pytest.mark.parametrize(
    ("driving", "people", "told"),
    [
        (
            'rules:\n  way: "to the ward"\n',
            'rules:\n  way: "by the lift"\n',
            r"people.yaml and driving.yaml both have a rule 'way'",
        ),
        (
            "speech:\n  all: [both]\n",
            "speech:\n  all: [everybody]\n",
            r"people.yaml gives 'all' in 'speech'",
        ),
        (
            'rules:\n  way: "to the ward"\n  way: "by the lift"\n',
            "rules: {}\n",
            r"driving.yaml: 'way' stands twice in line 2",
        ),
    ],
    ids=["a rule in two files", "a list in two files", "a rule twice in one file"],
)
def test_what_is_named_twice_is_not_loaded(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, driving: str, people: str, told: str
) -> None:
    folder = tmp_path / "xx"
    folder.mkdir()
    (folder / "driving.yaml").write_text(driving)
    (folder / "people.yaml").write_text(people)
    monkeypatch.setitem(registry._TRIED, "xx", folder)
    with pytest.raises(RuleError, match=told):
        load_language("xx")
