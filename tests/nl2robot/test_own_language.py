"""A ward speaks Dutch: a language that somebody else's package brings, found, used and checked."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from grammar.language import languages, load_language, speech, troubles
from grammar.languages import registry
from grammar.lexicon import Lexicon
from grammar.understand import understand
from nl2robot.checks.languages import check
from nl2robot.cli.main import main
from nl2robot.console.visitor import texts, texts_of
from nl2robot.knowledge import DEFAULT_WORLD
from nl2robot.texts import texts_in
from robot_api.driver import StopFlag
from robot_api.drivers import emulated
from robot_api.plugins import LANGUAGES
from sim.world.loading import load_world
from sim.world.model import World
from tests.robots.packages import install

TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorials" / "own-language.md"
BLOCK = re.compile(r'^```yaml title="([\w./]+)"\n(.*?)^```$', re.M | re.S)
FILES = dict(BLOCK.findall(TUTORIAL.read_text(encoding="utf-8")))
"""What the tutorial has its reader write, each file as it is in the end."""
DUTCH = {f"robot_dutch/{name}": text for name, text in FILES.items() if name.startswith("nl/")}

Install = Callable[..., None]


@pytest.fixture
def pip_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Forgets what was known of such packages, before and after."""
    known = (load_language, speech, texts_of, texts_in)

    def forget() -> None:
        for each in known:
            each.cache_clear()

    def pip_install(entry: str, changed: dict[str, str] | None = None) -> None:
        files = {"robot_dutch/__init__.py": "", **DUTCH, **(changed or {})}
        monkeypatch.syspath_prepend(
            str(install(tmp_path / "site", "robot-dutch", entry, LANGUAGES, files))
        )
        monkeypatch.delitem(sys.modules, "robot_dutch", raising=False)

    forget()
    yield pip_install
    forget()


@pytest.fixture
def ward(tmp_path: Path) -> Path:
    file = tmp_path / "ward.yaml"
    file.write_text(FILES["ward.yaml"], encoding="utf-8")
    return file


@pytest.fixture
def world(ward: Path) -> World:
    return load_world(str(ward))


# --- a package brings it


def test_a_command_in_it_becomes_a_program(
    pip_install: Install, ward: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pip_install("nl = robot_dutch.nl")
    said = ["ga naar de apotheek", "--lang", "nl", "--world", str(ward)]
    assert main(["translate", *said]) == 0
    out, err = capsys.readouterr()
    assert 'robot.goto("pharmacy")' in out and "naar de apotheek rijden" in out
    assert err == (
        "English stands in for what Nederlands has no words for."
        " `nl2robot languages check nl` tells what that is.\n"
    )


def test_it_is_listed_with_what_it_has(
    pip_install: Install, ward: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pip_install("nl = robot_dutch.nl")
    assert main(["languages", "--world", str(ward)]) == 0
    _, _, dutch = capsys.readouterr().out.partition("nl  Nederlands: ")
    assert "2 sample sentences" in dutch
    assert "a robot asks in it: yes" in dutch
    assert "texts: 0 %" in dutch
    assert "speech model: none" in dutch


def test_a_robot_speaks_it_and_understands_its_answers(pip_install: Install) -> None:
    pip_install("nl = robot_dutch.nl")
    robot = emulated(answers=["ja graag"])
    assert "nl" in robot.capabilities().languages
    robot.call("set_language", {"code": "nl"}, StopFlag())
    assert robot.call("ask", {"question": "Koffie?", "options": ["ja", "nee"]}, StopFlag()) == "ja"


def test_the_pages_are_english_but_for_what_it_brings(pip_install: Install) -> None:
    said = 'conversation: "Gesprek"\n'
    pip_install("nl = robot_dutch.nl", {"robot_dutch/nl/texts/console/desk.yaml": said})
    words = texts("desk", "nl")
    assert words["conversation"] == "Gesprek"
    assert words["welcome"] == texts("desk", "en")["welcome"]


# --- what is broken stands in nobody's way


@pytest.mark.parametrize(
    ("entry", "changed", "sentence"),
    [
        ("nl = robot_danish.nl", {}, "cannot be loaded (ModuleNotFoundError"),
        ("nl = robot_dutch.nothing", {}, "is no package with a folder"),
        ("nl = robot_dutch", {}, "has no files"),
        ("dutch = robot_dutch.nl", {}, "is not called by the two letters of its code"),
        ("de = robot_dutch.nl", {}, "is left out: one of ours has this name"),
        (
            "nl = robot_dutch.nl",
            {"robot_dutch/nl/more.yaml": "rules: ["},
            "Run `nl2robot languages check nl` to see why",
        ),
        (
            "nl = robot_dutch.nl",
            {"robot_dutch/nl/explain.yaml": "nouns: 7"},
            "Run `nl2robot languages check nl` to see why",
        ),
        (
            "nl = robot_dutch.nl",
            {"robot_dutch/nl/more.yaml": 'rules:\n  command: "<nowhere>"\n'},
            "Run `nl2robot languages check nl` to see why",
        ),
    ],
)
def test_a_language_that_is_broken_is_a_sentence_and_disturbs_nobody(
    pip_install: Install, entry: str, changed: dict[str, str], sentence: str
) -> None:
    pip_install(entry, changed)
    assert languages() == ["de", "en", "fr"]
    assert sentence in troubles()[entry.split()[0]]
    assert understand("stop", Lexicon(), "en").status == "ok"
    assert understand("halt an", Lexicon(), "de").status == "ok"


# --- it is checked, and found wanting where it is


def errors(world: World, code: str = "nl") -> list[str]:
    return [str(each) for each in check(code, world) if each.severity == "error"]


@pytest.mark.parametrize("code", registry.ours())
def test_nothing_is_wrong_with_ours(code: str) -> None:
    assert [str(each) for each in check(code, load_world(DEFAULT_WORLD))] == []


def test_nothing_is_wrong_with_what_the_tutorial_writes(pip_install: Install, world: World) -> None:
    pip_install("nl = robot_dutch.nl")
    found = check("nl", world)
    assert {each.severity for each in found} == {"note"}
    lacking = " ".join(map(str, found))
    assert "explain.yaml: What these do is explained in English" in lacking
    assert "38 of 44 methods have no command" in lacking
    assert "100 % of what the application says" in lacking


@pytest.mark.parametrize(
    ("file", "old", "new", "finding"),
    [
        ("commands", "means: go,", "means: fly,", "commands.yaml:7: There is no meaning and no"),
        (
            "commands",
            'naar <spot>"}',
            'naar <sport>"}',
            "commands.yaml:7: The rule <command> refers to <sport>",
        ),
        ("commands", 'naar <spot>"}', 'naar [<spot>"}', "commands.yaml:7: <command>: a"),
        ("commands", "{gesture}", "{gebaar}", "commands.yaml:11: Nothing can stand for {gebaar}"),
        ("commands", "fillers:", "filler:", "commands.yaml:26: 'filler' is nothing"),
        ("commands", "“{part}” begrijp", "Ik begrijp", "commands.yaml:36: The phrase"),
        ("commands", "not_understood:", "not_heard:", "commands.yaml:36: Nothing is said by"),
        ("commands", "ga naar {place}", "vlieg naar {place}", "commands.yaml:39: “vlieg naar"),
        ("commands", "closed: [", "closed: {", "commands.yaml:27: This cannot be read as YAML"),
        ("explain", "do: [", "done: [", "explain.yaml: This has another shape"),
        ("methods", "wait: ", "jump: ", "methods.yaml:4: “wacht twee seconden”: There is no robot"),
        ("methods", "stop: stop", "stop: zwaai", "methods.yaml:6: “zwaai”: This does not ask"),
        ("robot", "own_name:", "ownname:", "robot.yaml: Object"),
        ("texts/terminal", "", "programm: x", "texts/terminal.yaml:1: Nothing is said by the name"),
        ("texts/terminals", "", "program: x", "texts/terminals.yaml: Nothing reads this file"),
    ],
)
def test_what_is_wrong_is_told_with_its_line(
    pip_install: Install, world: World, file: str, old: str, new: str, finding: str
) -> None:
    path = f"robot_dutch/nl/{file}.yaml"
    before = DUTCH.get(path, "")
    assert old in before
    pip_install("nl = robot_dutch.nl", {path: before.replace(old, new, 1) or new})
    assert any(finding in each for each in errors(world)), errors(world)
