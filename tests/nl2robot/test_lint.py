"""A new ward is set up; the linter finds the names that would go wrong when spoken."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.language import languages
from nl2robot.checks import lint as linter
from nl2robot.checks.lint import alike, lint
from nl2robot.cli.main import main
from sim.world.builtin import builtin_worlds
from sim.world.model import WorldError


@pytest.fixture
def world(tmp_path):
    def world(text: str) -> str:
        file = tmp_path / "ward.yaml"
        file.write_text(f"name: ward\n{text}", encoding="utf-8")
        return str(file)

    return world


def found(file: str, language: str = "en") -> list[tuple[int, str, str]]:
    return [(each.line, each.severity, each.code) for each in lint(file, [language])]


@pytest.mark.parametrize("name", builtin_worlds())
@pytest.mark.parametrize("language", languages())
def test_the_built_in_worlds_have_no_errors(name, language) -> None:
    assert [each for each in lint(name, [language]) if each.severity == "error"] == []


def test_good_names_are_left_alone(world) -> None:
    file = world(
        "places:\n"
        "  - {name: pharmacy, aliases: {en: [drugstore]}}\n"
        "  - {name: alice's office}\n"
        "  - {name: bob's office}\n"
        "  - {name: ward a}\n"
        "  - {name: ward b}\n"
        "people:\n  - {name: Alice}\n  - {name: Bob}\n"
        "objects:\n  - {name: stapler}\n  - {name: stapler, is: [red]}\n"
        "furniture:\n  - {name: counter, at: pharmacy}\n"
        "contacts:\n  - Alice\n"
    )
    assert found(file) == []


def test_names_that_sound_alike(world) -> None:
    file = world(
        "places:\n"
        "  - {name: room 13}\n"
        "  - {name: room 30}\n"
        "people:\n"
        "  - {name: Anna Meier}\n"
        "  - {name: Hannah Meier}\n"
        "  - name: Bob\n"
        "    aliases:\n"
        "      en: [Anna Mayer]\n"
    )
    assert found(file) == [
        (4, "warning", "sounds-alike"),
        (7, "warning", "sounds-alike"),
        (10, "warning", "sounds-alike"),
    ]


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("thirteen", "thirty"),
        ("fifteen", "fifty"),
        ("meier", "meyer"),
        ("maier", "mayr"),
        ("stefan", "stephen"),
        ("kate", "cate"),
        ("anna", "hannah"),
        ("ward", "word"),
        ("cardiology", "kardiology"),
        ("cup", "cap"),
    ],
)
def test_these_are_taken_for_each_other(one, other) -> None:
    assert alike(one, other)
    assert alike(other, one)


@pytest.mark.parametrize(
    ("one", "other"),
    [
        ("lab", "lobby"),
        ("bob", "rob"),
        ("radiology", "pharmacy"),
        ("alice", "clara"),
        ("twelve", "twenty"),
        ("a", "b"),
        ("zwei", "drei"),
        ("supply", "surgery"),
    ],
)
def test_these_are_not(one, other) -> None:
    assert not alike(one, other)


def test_names_that_are_words_of_commands(world) -> None:
    file = world(
        "places:\n"
        "  - {name: charger, aliases: {en: [wave]}}\n"
        "  - {name: here}\n"
        "people:\n  - {name: go home}\n"
    )
    assert {(line, code) for line, _, code in found(file)} >= {
        (3, "command-word"),
        (4, "command-word"),
        (6, "command-word"),
    }


def test_a_name_that_no_sentence_reaches(world) -> None:
    file = world("people:\n  - {name: Kim}\n  - {name: me}\n  - {name: everybody}\n")
    assert found(file) == [(4, "error", "not-reached"), (5, "error", "not-reached")]


def test_one_name_for_two_things(world) -> None:
    file = world(
        "places:\n"
        "  - {name: pharmacy, aliases: {en: [the heart]}}\n"
        "  - {name: reception, aliases: {en: [reception desk]}}\n"
        "people:\n  - {name: The Heart}\n"
        "objects:\n  - {name: pharmacy}\n  - {name: monitor}\n"
        "furniture:\n"
        "  - {name: monitor, at: pharmacy}\n"
        "  - {name: reception desk, at: reception}\n"
        "contacts:\n  - reception\n"
    )
    assert found(file) == [
        (6, "error", "same-name"),
        (8, "error", "same-name"),
        (11, "warning", "same-name"),
    ]


class Deaf:
    """A recogniser that does not know one word."""

    def unknown_words(self, phrases):
        return ["microbiology"] if any("microbiology" in phrase for phrase in phrases) else []

    def knows(self, word):
        return word in ("micro", "biology")


def test_a_word_that_the_speech_model_lacks(world, monkeypatch) -> None:
    monkeypatch.setattr(linter._Linter, "recogniser", lambda self: Deaf())
    file = world("places:\n  - {name: lobby}\n  - {name: microbiology lab}\n")
    [finding] = lint(file, ["en"])
    assert (finding.line, finding.severity, finding.code) == (4, "warning", "not-heard")
    assert "micro biology" in finding.message
    known = world("places:\n  - {name: microbiology lab, aliases: {en: [germ lab]}}\n")
    assert lint(known, ["en"]) == []


def test_the_command_line_tells_file_and_line(world, capsys) -> None:
    bad = world("places:\n  - {name: lobby}\npeople:\n  - {name: lobby}\n")
    assert main(["lint", bad, "--lang", "en"]) == 1
    shown = capsys.readouterr().out
    assert f"{bad}:5: error" in shown
    assert "1 errors" in shown
    assert main(["lint", bad, "--json", "--lang", "en"]) == 1
    data = json.loads(capsys.readouterr().out)
    assert (data["file"], data["line"], data["language"]) == (bad, 5, "en")
    warned = world("places:\n  - {name: room 13}\n  - {name: room 30}\n")
    assert main(["lint", warned, "--lang", "en"]) == 0
    assert main(["lint", "nowhere.yaml"]) == 2


letters = st.characters(categories=("L", "N", "P", "S", "Zs"))
names = st.lists(
    st.text(letters, min_size=1, max_size=15), min_size=1, max_size=4, unique_by=str.lower
)


@settings(max_examples=25, deadline=None)
@given(names, names)
def test_any_names_are_looked_at(tmp_path_factory, places, people) -> None:
    file = tmp_path_factory.mktemp("any") / "world.yaml"
    data = {
        "name": "any",
        "places": [{"name": name} for name in places],
        "people": [{"name": name} for name in people],
    }
    file.write_text(json.dumps(data), encoding="utf-8")  # which is YAML, too
    try:
        findings = lint(str(file), ["en"])
    except WorldError:
        return
    assert all(finding.message for finding in findings)
