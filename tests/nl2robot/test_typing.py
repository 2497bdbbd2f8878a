"""At the keyboard: earlier commands come back, Tab completes, and a line tells where it drives."""

import functools
import io
import stat

import pytest
from rich.console import Console

from grammar.language import load_language
from grammar.naming import joined_up
from grammar.samples import samples
from nl2robot.cli.live_line import LiveLine
from nl2robot.cli.main import COMMANDS
from nl2robot.cli.on_the_way import OnTheWay
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from nl2robot.translate.completing import Named, completions, named_here, names_said
from sim.world.loading import load_world

CHAT = ("chat", "--world", "ward")
UP, TAB, CTRL_U = "\x1b[A", "\t", "\x15"

SENTENCES = ["go to the lobby", "go home", "wave", "what do you see?"]
NAMES = ["ward a", "ward b", "lobby"]
NAMED = [
    *(Named("places", name, "the lobby" if name == "lobby" else name) for name in NAMES),
    Named("people", "Rosa", "Rosa"),
]


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("", ["go", "wave", "what"]),
        ("go ", ["go to the lobby", "go home"]),
        ("GO H", ["go home"]),
        ("go to the lobby and then to wa", ["ward a", "ward b"]),
        ("wave in ward ", ["ward a", "ward b"]),
        ("go to the l", ["go to the lobby"]),
        ("wave", []),
        ("go to the moon", []),
    ],
)
def test_a_line_becomes_what_can_be_said_here(typed, offered) -> None:
    assert [
        each if each in SENTENCES or " " not in typed else each.removeprefix(typed[: _shared(each)])
        for each in completions(typed, SENTENCES, NAMED)
    ] == offered


def _shared(line: str) -> int:
    """Where the name begins that a line ends with."""
    return next((len(line) - len(name) for name in NAMES if line.endswith(name)), 0)


def test_french_names_behind_an_apostrophe() -> None:
    assert completions("va à l'acc", [], [Named("places", "accueil", "l'accueil")]) == [
        "va à l'accueil"
    ]


@pytest.mark.parametrize(
    ("language", "typed", "offered", "not_offered"),
    [
        ("en", "go to ", ["go to the pharmacy", "go to ward a"], ["go to Alice", "go to stapler"]),
        ("en", "wave and then go to the ", ["wave and then go to the kitchen"], []),
        ("en", "ask ", ["ask Bob"], ["ask pharmacy"]),
        ("en", "say ", [], ["say Bob", "say pharmacy"]),
        ("de", "fahr zum ", ["fahr zum Empfang"], ["fahr zum Apotheke", "fahr zum pharmacy"]),
        ("de", "frag ", ["frag Bob"], ["frag Apotheke"]),
        ("fr", "va à la ", ["va à la pharmacie"], ["va à la hall"]),
        ("fr", "va à ", ["va à la pharmacie"], ["va à le hall"]),
    ],
)
def test_behind_a_blank_stand_the_names_that_may_stand_there(
    language: str, typed: str, offered: list[str], not_offered: list[str]
) -> None:
    world, pack = load_world("city-hospital"), load_language(language)
    said = samples(Knowledge(world).lexicon(language), language).values()
    sentences = [each for topic in said for each in topic]
    joins = functools.partial(joined_up, language=pack)
    found = set(completions(typed, sentences, named_here(world, language), joins))
    assert set(offered) <= found
    assert not found & set(not_offered)


def test_names_are_those_of_the_language() -> None:
    names = names_said(load_world("city-hospital"), "de")
    assert "Apotheke" in names and "pharmacy" in names
    assert "Apotheke" not in names_said(load_world("city-hospital"), "en")


def test_commands_come_back_and_answers_do_not(start, home) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type("go to ward a\n")
    chat.until("eject? ")
    chat.type("no, ward b\n")  # a correction is a command
    chat.until("eject? ")
    chat.type("r\n")
    chat.until("you: ")
    chat.type("bye\n")
    assert chat.end() == ExitStatus.OK
    kept = home / "history"
    assert kept.read_text() == "go to ward a\nno, ward b\nbye\n"
    assert stat.S_IMODE(kept.stat().st_mode) == 0o600

    kept.chmod(0o644)
    again = start(*CHAT, at_terminal=True)
    again.until("you: ")
    again.type(UP * 3 + "\n")
    assert 'robot.goto("ward a")' in again.until("eject? ")
    again.type("r\n")
    again.until("you: ")
    again.type("bye\n")
    assert again.end() == ExitStatus.OK
    assert stat.S_IMODE(kept.stat().st_mode) == 0o600


def test_tab_completes_a_place_in_chat(start) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type(f"go to the corr{TAB}\n")
    assert 'robot.goto("corridor")' in chat.until("eject? ")
    chat.type("r\n")
    chat.until("you: ")
    chat.type("bye\n")
    assert chat.end() == ExitStatus.OK


def test_tab_offers_the_places_behind_a_blank(start) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type(f"please go to {TAB}{TAB}")
    chat.until("please go to ward b")
    chat.type(f"{CTRL_U}bye\n")
    assert chat.end() == ExitStatus.OK


# --- the way ------------------------------------------------------------------------------------

ROUND_THE_CORNER = [(0.0, 0.0), (4.0, 0.0), (4.0, 3.0)]


def on_the_way(path, **arguments) -> OnTheWay:
    way = OnTheWay()
    way.plan(path)
    way.begin("goto", arguments)
    return way


def test_what_is_left_is_measured_along_the_way_and_not_through_walls() -> None:
    way = on_the_way(ROUND_THE_CORNER, x=4, y=3)
    assert way.at(0, 0) == pytest.approx(7)
    assert way.at(2, 0.5) == pytest.approx(3 + 4.25**0.5, abs=0.1)
    assert way.at(4, 2) == pytest.approx(1)
    assert way.at(4, 3) == pytest.approx(0)


def test_who_comes_by_again_is_not_there_already() -> None:
    there_and_back = [*ROUND_THE_CORNER, (4.0, 0.0), (0.0, 0.0)]
    way = on_the_way(there_and_back, x=4, y=3)
    assert way.at(1, 0) == pytest.approx(6)
    assert way.at(4, 3) == pytest.approx(0)
    way.begin("goto", {"x": 0, "y": 0})
    assert way.at(4, 2) == pytest.approx(6)


def test_off_the_way_it_is_as_the_crow_flies() -> None:
    way = on_the_way(ROUND_THE_CORNER, x=4, y=3)
    assert way.at(0, 3) == pytest.approx(4)
    assert on_the_way([], x=3, y=4).at(0, 0) == pytest.approx(5)


def test_a_place_that_nobody_knows_has_a_name_and_no_distance() -> None:
    way = on_the_way(ROUND_THE_CORNER, place="attic")
    assert (way.place, way.at(0, 0)) == ("attic", None)
    way.begin("say", {"text": "Hello"})
    assert way.place is None


def test_docking_is_a_drive_to_the_charger() -> None:
    world = load_world("ward")
    way = OnTheWay(world)
    way.begin("dock", {})
    assert way.place == "charger"
    assert way.at(*_at(world, "charger")) == pytest.approx(0)


def _at(world, name: str) -> tuple[float, float]:
    pose = world.place(name).pose
    return pose.x, pose.y


def test_the_line_is_written_again_above_what_somebody_types() -> None:
    written, now = io.StringIO(), [0.0]
    console = Console(file=written, force_terminal=True, width=40, _environ={"TERM": "xterm"})
    line = LiveLine(console, lambda: now[0])
    line.show("3 m")
    line.show("2 m")  # too soon
    now[0] = 1.0
    line.show("1 m")
    assert written.getvalue() == "3 m\n\x1b7\x1b[1A\r\x1b[2K1 m\x1b8"
    line.leave()
    now[0] = 2.0
    line.show("5 m")
    assert written.getvalue().endswith("\x1b85 m\n")


def test_a_pipe_gets_no_line_that_lives() -> None:
    written = io.StringIO()
    LiveLine(Console(file=written)).show("3 m")
    assert written.getvalue() == ""


# --- in a shell ---------------------------------------------------------------------------------


@pytest.fixture
def tab(start, tmp_path, monkeypatch):
    """What the shell is told when Tab is pressed behind this line."""

    def tab(line: str) -> list[str]:
        told = tmp_path / "told"
        for name, value in {
            "_ARGCOMPLETE": "1",
            "COMP_LINE": line,
            "COMP_POINT": str(len(line)),
            "_ARGCOMPLETE_IFS": "\n",
            "_ARGCOMPLETE_STDOUT_FILENAME": str(told),
        }.items():
            monkeypatch.setenv(name, value)
        assert start().end() == 0
        return [each.strip() for each in told.read_text().split("\n")]

    return tab


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("nl2robot tra", ["translate"]),
        ("nl2robot translate --world war", ["ward"]),
        ("nl2robot completion ", ["bash", "zsh", "fish"]),
        ('nl2robot run --world ward "wave and go to war', ["wave and go to ward"]),
    ],
)
def test_the_shell_completes_commands_worlds_and_sentences(tab, line, offered) -> None:
    told = tab(line)
    assert all(any(each.startswith(word) for each in told) for word in offered), told


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_each_shell_gets_its_code(nl2robot, shell) -> None:
    status, out, _ = nl2robot("completion", shell)
    assert status == ExitStatus.OK
    assert "_ARGCOMPLETE" in out and "nl2robot" in out
    assert ("compinit" in out) == (shell == "zsh")


# --- alone --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("setting", "word"),
    [("C", "your own words"), ("de_CH.UTF-8", "Ihren Worten"), ("fr_FR", "vos mots")],
)
def test_alone_it_says_what_it_is_and_what_to_try(nl2robot, monkeypatch, setting, word) -> None:
    for name in ("LC_ALL", "LC_MESSAGES", "LANG"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("LANG", setting)
    status, out, err = nl2robot()
    assert (status, err) == (ExitStatus.OK, "")
    assert word in out
    commands = [line.split()[1] for line in out.splitlines() if line.startswith("  nl2robot ")]
    assert set(commands) <= set(COMMANDS)
    assert len(commands) == len(set(commands)) >= 3


# --- refused ------------------------------------------------------------------------------------


def test_a_script_sees_that_a_sentence_was_refused(nl2robot, monkeypatch) -> None:
    assert nl2robot("translate", "go to the lobby")[0] == ExitStatus.OK
    assert nl2robot("translate", "colour the moon")[0] == ExitStatus.NOT_UNDERSTOOD
    assert nl2robot("translate", "--json", "colour the moon")[0] == ExitStatus.OK
    monkeypatch.setattr("sys.stdin", io.StringIO("colour the moon\ngo to the lobby\n"))
    status, out, _ = nl2robot("translate", "-")
    assert status == ExitStatus.NOT_UNDERSTOOD
    assert 'robot.goto("lobby")' in out
