"""What clumsy and hostile users type: a sentence each, the right exit status, never a traceback."""

import hashlib
import io
import json
import sys
from pathlib import Path

import pytest

from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog
from robot_api.client import Robot
from robot_api.errors import AccessDenied, InvalidCall, LostConnection

WARD = ("--world", "ward")


@pytest.fixture
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def check(said: tuple[int, str, str], status: ExitStatus, words: str) -> None:
    got, out, err = said
    assert words in out + err
    assert "Traceback" not in out + err
    assert "Something went wrong" not in out + err
    assert got == status, out + err


# --- on the command line -------------------------------------------------------------------------

TYPED_WRONG = [
    (["run", *WARD], "Say what to do"),
    (["run", *WARD, "--speed", "0", "wave"], "'0' is not a number above 0"),
    (["run", *WARD, "--speed", "-2", "wave"], "'-2' is not a number above 0"),
    (["run", *WARD, "--speed", "nan", "wave"], "'nan' is not a number above 0"),
    (["run", *WARD, "--speed", "fast", "wave"], "'fast' is not a number above 0"),
    (["run", *WARD, "--seed", "lucky", "wave"], "'lucky' is not a whole number"),
    (["run", *WARD, "--seed", "9" * 30, "wave"], "is not a whole number"),
    (["run", *WARD, "--planner", "model", "wave"], "no language model"),
    (["run", *WARD, "--picture", "run.bmp", "wave"], ".svg, .png, .webp or .gif"),
    (["run", *WARD, "--picture", "", "wave"], ".svg, .png, .webp or .gif"),
    (["run", *WARD, "--picture", "/dev/null/run.png", "wave"], "cannot be saved"),
    (["run", *WARD, "--picture", "run.png", "--robot", "ws://there", "wave"], "Only a robot sim"),
    (
        ["run", *WARD, "--robot", "ws://", "wave"],
        "is no address of a robot. Write it as KIND://HOST",
    ),
    (["run", *WARD, "--program", "nothing.py"], "cannot be read (No such file"),
    (["run", *WARD, "--program", "/"], "cannot be read (Is a directory)"),
    (["serve", *WARD, "--port", "99999"], "'99999' is not a whole number from 0 to 65535"),
    (["serve", *WARD, "--speed", "0"], "'0' is not a number above 0"),
    (["serve", *WARD, "--host", "192.0.2.1", "--port", "0"], "no address of this machine"),
    (["serve", *WARD, "--host", "", "--port", "0"], "An empty text is no address"),
    (["translate", "--world", "atlantis", "wave"], "no such world"),
    (["translate", "--world", "/", "wave"], "Is a directory"),
    (["log", "999"], "There is no run 999"),
    (["log", "9" * 30], "is not a whole number"),
    (["log", "--last", "0"], "is not a whole number"),
    (["log", "--replay"], "Say which run"),
    (["log", "1", "--picture", "run.png"], "Add --replay"),
    (["listen", "--wav", "nothing.wav"], "nl2robot models get en"),
    (["models", "get", "xx"], "no model called"),
    (["test", "nothing.yaml"], "cannot be read"),
    (["dance"], "invalid choice"),
]


@pytest.mark.parametrize(("typed", "told"), TYPED_WRONG, ids=lambda value: str(value)[:60])
def test_what_was_typed_wrong_is_told_before_anything_moves(nl2robot, here, typed, told) -> None:
    check(nl2robot(*typed), ExitStatus.BAD_INPUT, told)
    assert list(here.iterdir()) in ([], [here / "home"])


def test_an_unknown_place_is_not_driven_to(nl2robot) -> None:
    check(nl2robot("run", *WARD, "-y", "go to the attic"), ExitStatus.NOT_UNDERSTOOD, "attic")
    check(nl2robot("log"), ExitStatus.OK, "Nothing was run yet")


def test_a_program_with_an_unknown_place_or_person_is_refused(nl2robot, here) -> None:
    (here / "attic.py").write_text('robot.goto("attic")\n')
    said = nl2robot("run", *WARD, "-y", "--program", "attic.py")
    check(said, ExitStatus.NOT_APPROVED, 'no place "attic"')
    (here / "call.py").write_text('robot.call("Zorro")\n')
    said = nl2robot("run", *WARD, "-y", "--program", "call.py")
    check(said, ExitStatus.NOT_APPROVED, 'no contact "Zorro"')


def test_debug_shows_the_traceback_and_the_same_status(nl2robot) -> None:
    status, _, err = nl2robot("translate", "--debug", "--world", "atlantis", "wave")
    assert status == ExitStatus.BAD_INPUT
    assert "Traceback" in err
    assert "no such world" in err


def test_a_fault_of_our_own_is_told_as_such(nl2robot, monkeypatch) -> None:
    monkeypatch.setattr("nl2robot.cli.commands.translate.run", lambda options: 1 / 0)
    status, _, err = nl2robot("translate", "wave")
    assert status == ExitStatus.INTERNAL
    assert "ZeroDivisionError" in err
    assert "--debug" in err
    assert "Traceback" not in err


# --- worlds and programs -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "told"),
    [
        (
            b"name: x\nplaces:\n  - {name: a, colour: red}\n",
            'world.yaml:3: A place has no field "c',
        ),
        (b"name: x\nplaces: [\n", "world.yaml:3: This is not valid YAML"),
        (b"name: x\nplaces: 7\n", "world.yaml:2"),
        (b"", "The file is empty"),
        (b"\xff\xfe\x00", "no text in UTF-8"),
    ],
)
def test_a_broken_world_is_told_with_its_line(nl2robot, here, text, told) -> None:
    (here / "world.yaml").write_bytes(text)
    for command in ("translate", "run", "serve"):
        words = () if command == "serve" else ("wave",)
        check(nl2robot(command, "--world", "world.yaml", *words), ExitStatus.BAD_INPUT, told)


def test_a_world_without_a_map_translates_and_does_not_run(nl2robot, here) -> None:
    (here / "names.yaml").write_text("name: names\nplaces: [{name: studio}, {name: attic}]\n")
    said = nl2robot("translate", "--world", "names.yaml", "go to the attic")
    check(said, ExitStatus.OK, 'robot.goto("attic")')
    said = nl2robot("run", "--world", "names.yaml", "-y", "go to the attic")
    check(said, ExitStatus.BAD_INPUT, "has no map to drive on. Give its places a pose")


@pytest.mark.parametrize(
    ("program", "told"),
    [
        (b'robot.say("caf\xe9")\n', "Save it as UTF-8"),
        ('robot.say("hi")\n'.encode("utf-16"), "Save it as UTF-8"),
        (b"# long\n" * 10_000, "longer than 64 kB"),
    ],
)
def test_a_program_that_is_none_is_not_run(nl2robot, here, program, told) -> None:
    (here / "program.py").write_bytes(program)
    said = nl2robot("run", *WARD, "-y", "--program", "program.py")
    check(said, ExitStatus.BAD_INPUT, told)


def test_a_program_from_another_system_runs(nl2robot, here) -> None:
    (here / "program.py").write_bytes('\ufeffrobot.say("one")\r\nrobot.say("two")\r\n'.encode())
    said = nl2robot("run", *WARD, "-y", "--program", "program.py")
    check(said, ExitStatus.OK, "2 say(text='two')")


def test_a_program_that_prints_without_end_is_ended(nl2robot, here) -> None:
    (here / "program.py").write_text('while True:\n    print("x" * 5000)\n')
    said = nl2robot("run", *WARD, "-y", "--program", "program.py")
    check(said, ExitStatus.FAILED, "printed more than it may")


def test_the_review_shows_what_a_terminal_would_hide(nl2robot, here, monkeypatch) -> None:
    monkeypatch.setattr(sys, "stdin", io.StringIO(""))
    (here / "program.py").write_text('robot.say("hi")  # \x1b[2K \u202e evil\rrobot.dock()\n')
    said = nl2robot("run", *WARD, "--program", "program.py")
    check(said, ExitStatus.NOT_APPROVED, r"\x1b[2K \u202e evil")
    assert "2 robot.dock()" in said[1]


# --- the input and the output --------------------------------------------------------------------


def feed(monkeypatch, data: bytes) -> None:
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data), encoding="utf-8"))


def test_lines_of_junk_are_answered_one_by_one(nl2robot, monkeypatch) -> None:
    long = b"go to ward a and " * 12_000
    feed(monkeypatch, b"\xff\xfe\x00\n\n" + long + b"\ngo to\0 ward a\ngo to ward a\r\n")
    status, out, _ = nl2robot("translate", *WARD, "--json", "-")
    assert status == ExitStatus.OK
    answers = [json.loads(line) for line in out.splitlines()]
    assert [answer["status"] for answer in answers] == ["rejected"] * 4 + ["ok"]
    assert "too much at once" in answers[2]["message"]
    assert answers[-1]["program"] == 'robot.goto("ward a")\n'


def test_quoted_junk_does_not_reach_the_terminal(nl2robot) -> None:
    status, out, _ = nl2robot("translate", *WARD, "go to \x1b]0;evil\x07")
    assert status == ExitStatus.NOT_UNDERSTOOD
    assert "\x1b" not in out
    assert "\x07" not in out


def test_an_argument_that_is_no_text_is_answered(nl2robot) -> None:
    status, out, _ = nl2robot("translate", *WARD, "--json", "go to ward \udcff")
    assert (status, json.loads(out)["status"]) == (ExitStatus.OK, "rejected")


def test_no_input_at_all_is_no_approval(nl2robot, monkeypatch) -> None:
    monkeypatch.setattr(sys, "stdin", None)
    check(nl2robot("run", *WARD, "wave"), ExitStatus.NOT_APPROVED, "Nobody is there to answer")
    check(nl2robot("log"), ExitStatus.OK, "Nothing was run yet")


def test_a_terminal_without_columns_shows_the_program(nl2robot, monkeypatch) -> None:
    monkeypatch.setenv("COLUMNS", "0")
    check(nl2robot("run", *WARD, "-y", "say hello"), ExitStatus.OK, 'robot.say("Hello!")')


@pytest.mark.parametrize("encoding", ["ascii", "latin-1"])
def test_a_terminal_that_knows_few_letters_is_no_obstacle(nl2robot, monkeypatch, encoding) -> None:
    output = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    monkeypatch.setattr(sys, "stdout", output)
    assert nl2robot("run", *WARD, "-y", "go to ward a")[0] == ExitStatus.OK
    assert b"Done." in output.buffer.getvalue()


def test_a_reader_that_leaves_is_no_fault(start) -> None:
    command = start("run", *WARD, "-y", "go to ward a")
    command.until("Program")
    command.hang_up()
    assert command.process.wait(30) == ExitStatus.OK


@pytest.mark.skipif(sys.platform != "linux", reason="/dev/full is Linux's")
def test_an_output_that_cannot_be_written_is_told(nl2robot, monkeypatch) -> None:
    with Path("/dev/full").open("w") as full:
        monkeypatch.setattr(sys, "stdout", full)
        status, _, err = nl2robot("translate", *WARD, "wave")
        monkeypatch.undo()
    assert status == ExitStatus.BAD_INPUT
    assert "No space left on device" in err


# --- where things are kept -----------------------------------------------------------------------


def test_a_home_that_cannot_be_is_told(nl2robot, here, monkeypatch) -> None:
    (here / "file").touch()
    monkeypatch.setenv("NL2ROBOT_HOME", str(here / "file"))
    for typed in (["run", *WARD, "-y", "wave"], ["log"], ["serve", "--port", "0"]):
        check(nl2robot(*typed), ExitStatus.BAD_INPUT, "NL2ROBOT_HOME")


def test_a_log_that_is_none_is_told(nl2robot, home) -> None:
    home.mkdir()
    (home / "runs.sqlite").write_bytes(b"this is no database" * 100)
    check(nl2robot("run", *WARD, "-y", "wave"), ExitStatus.BAD_INPUT, "not a database")


def test_a_full_disk_stops_the_run_and_loses_nothing(start, home, tmp_path) -> None:
    (tmp_path / "beat.py").write_text("for beat in range(400):\n    robot.wait(0.1)\n")
    program = ("run", *WARD, "-y", "--program", str(tmp_path / "beat.py"))
    command = start(*program, largest_file=80_000)
    assert command.end() == ExitStatus.FAILED
    assert "Stopped." in command.output
    assert "Free some disk space" in " ".join(command.output.split())
    assert "Traceback" not in command.output
    log = RunLog(home / "runs.sqlite")
    assert 0 < len(log.calls(log.runs()[0].id)) < 400


def test_a_program_file_is_listed_whatever_is_in_it(nl2robot, here) -> None:
    (here / "empty.py").touch()
    (here / "marked.py").write_text('robot.say("[/red] [bold]")\n')
    for file, end in (("empty.py", "Done."), ("marked.py", "\n[/red] [bold]\n")):
        check(nl2robot("run", *WARD, "-y", "--program", file), ExitStatus.OK, end)
    check(nl2robot("log"), ExitStatus.OK, "[/red] [bold]")
    check(nl2robot("log", "2"), ExitStatus.OK, "say(text='[/red] [bold]')")
    assert json.loads(nl2robot("log", "1", "--json")[1])["program"] == ""


# --- on the wire ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "parameters", "error", "told"),
    [
        ("program.translate", {"utterance": 7}, InvalidCall, "not of type 'string'"),
        ("program.translate", {}, InvalidCall, "utterance"),
        (
            "program.translate",
            {"utterance": "go", "planner": "model"},
            InvalidCall,
            "models get planner",
        ),
        ("program.translate", {"utterance": "go", "language": "xx"}, InvalidCall, "no language"),
        ("program.translate", {"utterance": "x" * 300_000}, InvalidCall, "too long"),
        ("program.check", {"program": "x" * 100_000}, InvalidCall, "program.check"),
        ("program.check", {"program": "", "language": "xx"}, InvalidCall, "no language"),
        ("program.phrases", {"language": "xx"}, InvalidCall, "no language"),
        ("program.list", {"last": 10**9}, InvalidCall, "maximum"),
        ("program.run", {"approval": "made up"}, AccessDenied, "no approval"),
        ("program.fly", {}, InvalidCall, "no method"),
    ],
)
def test_wrong_calls_are_answered_in_words(station, method, parameters, error, told) -> None:
    with station.connect() as robot:
        with pytest.raises(error, match=told):
            robot.request(method, parameters)
        assert robot.request("program.translate", {"utterance": "wave"})["status"] == "ok"


def test_a_refused_program_cannot_be_slipped_past_the_review(station) -> None:
    program = 'robot.goto("attic")\n'
    sha256 = hashlib.sha256(program.encode()).hexdigest()
    with station.connect() as robot, pytest.raises(AccessDenied, match="attic"):
        robot.request("program.approve", {"program": program, "sha256": sha256, "by": "me"})


def test_nobody_at_the_address(nl2robot) -> None:
    said = nl2robot("run", *WARD, "-y", "--robot", "ws://127.0.0.1:9", "wave")
    check(said, ExitStatus.NO_ROBOT, "no robot at 127.0.0.1:9")
    with pytest.raises(LostConnection):
        Robot("127.0.0.1:9")
