"""A conversation at the terminal: nothing moves before it was approved, nothing ends it but you."""

import io

import pytest

from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.run.runlog import RunLog

CHAT = ("chat", "--world", "ward")
CTRL_C, CTRL_D = "\x03", "\x04"


@pytest.fixture
def log_of(home):
    def log_of() -> list[tuple[str | None, str | None]]:
        log = RunLog(home / "runs.sqlite")
        runs = [(row.utterance, row.status) for row in reversed(log.runs())]
        log.close()
        return runs

    return log_of


@pytest.fixture
def run_piped(nl2robot, monkeypatch):
    """Run a command with these lines as its input; returns what it said."""

    def run_piped(*arguments: str, said: list[str]) -> str:
        monkeypatch.setattr("sys.stdin", io.StringIO("\n".join([*said, ""])))
        _, out, _ = nl2robot(*arguments)
        return out

    return run_piped


def test_a_nurse_talks_with_the_robot(start, log_of) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type("help\n")
    assert "go to the corridor" in chat.until("you: ")
    chat.type("go to the attic\n")
    assert "attic" in chat.until("you: ")
    chat.type("go to ward a\n")
    assert "It would take" in chat.until("eject? ")
    chat.type("what?\n")  # no answer to the question
    chat.until("eject? ")
    chat.type("approve\n")
    assert "goto(place='ward a')" in chat.until("Done.")
    chat.until("you: ")
    chat.type("no, ward b\n")
    assert 'robot.goto("ward b")' in chat.until("eject? ")
    chat.type("a\n")
    chat.until("you: ")
    chat.type("wave\n")
    chat.until("eject? ")
    chat.type("reject\n")
    assert "Nothing was run" in chat.until("you: ")
    chat.type("bye\n")
    chat.until("Goodbye.")
    assert chat.end() == ExitStatus.OK
    assert log_of() == [("go to ward a", "done"), ("no, ward b", "done")]


def test_what_did_not_come_to_its_end_needs_more_than_a_yes(start, log_of) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    for answer in ("", "reject"):
        chat.type("grab the unicorn\n")
        assert "Risk, line 1: When it was tried" in chat.until("(Enter rejects) ")
        chat.type("yes\n")
        chat.until("(Enter rejects) ")
        chat.type(f"{answer}\n")
        assert "Nothing was run" in chat.until("you: ")
    chat.type("grab the unicorn\n")
    chat.until("(Enter rejects) ")
    chat.type("run it all the same\n")
    assert "unicorn" in chat.until("could not finish")
    chat.until("you: ")
    chat.type("bye\n")
    assert chat.end() == ExitStatus.OK
    assert log_of() == [("grab the unicorn", "failed")]


def test_a_reception_that_goes_on_until_it_is_stopped_needs_no_more_than_a_yes(
    start, log_of
) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type("go to ward a and ward b forever\n")
    shown = " ".join(chat.until("[a]pprove, [e]dit or [r]eject? ").split())
    assert "would go on until somebody stops it" in shown
    chat.type("yes\n")
    chat.until("goto(")
    chat.interrupt()
    chat.until("you: ")
    chat.type("bye\n")
    assert chat.end() == ExitStatus.OK
    assert log_of() == [("go to ward a and ward b forever", "stopped")]


def test_whoever_asks_for_german_is_spoken_to_in_german(start, log_of) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type("sprich Deutsch\n")
    assert "Ich werde von da an Deutsch sprechen" in chat.until("eject? ")
    chat.type("a\n")
    chat.until("Sie: ")
    chat.type("fahr zu ward b\n")
    assert "Ich werde zu Station B fahren" in chat.until("erwerfen? ")
    chat.type("f\n")
    chat.until("Sie: ")
    chat.type("tschüss\n")
    assert chat.end() == ExitStatus.OK
    assert "Traceback" not in chat.output


def test_a_new_command_that_cannot_be_done_leaves_the_one_that_waits(start, log_of) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type("go to ward a\n")
    chat.until("eject? ")
    chat.type("take out the trash\n")
    said = chat.until("eject? ")
    assert "I cannot do that with my hands" in said and "leave out:" not in said
    assert "still waits for your decision" in said and 'robot.goto("ward a")' in said
    chat.type("a\n")
    assert "goto(place='ward a')" in chat.until("Done.")
    chat.type("bye\n")


def test_ctrl_c_stops_what_is_going_on_and_the_talk_goes_on(start, log_of) -> None:
    chat = start(*CHAT, "--speed", "1", at_terminal=True)
    chat.until("you: ")
    chat.type("half a line")
    chat.until("half a line")
    chat.interrupt()
    chat.until("you: ")
    chat.type("go to ward b\n")
    chat.until("eject? ")
    chat.interrupt()
    assert "Nothing was run" in chat.until("you: ")
    chat.type("go to ward b\n")
    chat.until("eject? ")
    chat.type("a\n")
    chat.until("goto(place='ward b')")
    chat.type(CTRL_C)
    chat.until("Stopped.")
    chat.until("you: ")
    chat.type(CTRL_D)
    assert chat.end() == ExitStatus.OK
    assert "Traceback" not in chat.output
    assert log_of() == [("go to ward b", "stopped")]


def test_an_edited_program_is_reviewed_again_and_logged_as_it_ran(start, home) -> None:
    editor = 'sh -c \'echo "robot.say(\\"Good night.\\")" > $0\''
    command = start("run", "--world", "ward", "go to ward a", at_terminal=True, editor=editor)
    command.until("eject? ")
    command.type("e\n")
    assert 'robot.say("Good night.")' in command.until("eject? ")
    command.type("a\n")
    assert command.end() == ExitStatus.OK
    log = RunLog(home / "runs.sqlite")
    [row] = log.runs()
    assert row.program == 'robot.say("Good night.")\n'
    assert (row.utterance, row.plan) == ("go to ward a", None)
    assert (row.proposed, row.changed_by) == ('robot.goto("ward a")\n', row.approved_by)
    assert [call.method for call in log.calls(row.id)] == ["say"]
    log.close()


def test_an_edit_that_breaks_the_program_cannot_be_approved(start, log_of) -> None:
    command = start(
        *("run", "--world", "ward", "go to ward a"),
        at_terminal=True,
        editor="sh -c 'echo \"import os\" > $0'",
    )
    command.until("eject? ")
    command.type("e\n")
    assert "[a]pprove" not in command.until("[e]dit or [r]eject? ")
    command.type("a\n")  # is not offered
    command.until("[e]dit or [r]eject? ")
    command.type("r\n")
    assert command.end() == ExitStatus.NOT_APPROVED
    assert log_of() == []


@pytest.mark.parametrize(
    ("editor", "reason"),
    [
        ("/no/such/editor", "No such file"),
        ("false", "ended with status 1"),
        ("sh -c 'rm $0'", "No such file"),
        ("sh -c 'printf \"\\377\\376\" > $0'", "text in UTF-8"),
        ("'", "closing quotation"),
    ],
)
def test_an_editor_that_fails_leaves_the_program_as_it_was(
    monkeypatch, capsys, editor, reason
) -> None:
    monkeypatch.delenv("VISUAL", raising=False)
    monkeypatch.setenv("EDITOR", editor)
    assert Terminal().edit("robot.dock()\n") == "robot.dock()\n"
    told = " ".join(capsys.readouterr().out.split())
    assert "did not work" in told
    assert reason.lower() in told.lower()
    assert "stays as it was" in told


def test_the_end_of_the_input_is_no_approval(start, log_of) -> None:
    command = start("run", "--world", "ward", "wave", at_terminal=True)
    command.until("eject? ")
    command.type(CTRL_D)
    assert command.end() == ExitStatus.NOT_APPROVED
    assert "Nobody is there to answer" in command.output
    assert log_of() == []


def test_a_correction_instead_of_a_decision_is_reviewed_in_its_place(start, log_of) -> None:
    chat = start(*CHAT, at_terminal=True)
    chat.until("you: ")
    chat.type("go to ward a\n")
    chat.until("eject? ")
    chat.type("no, ward b\n")
    assert 'robot.goto("ward b")' in chat.until("eject? ")
    chat.type("and then wave\n")
    assert 'robot.gesture("wave")' in chat.until("eject? ")
    chat.type("what will you do?\n")
    assert "wave" in chat.until("eject? ")
    chat.type("x\n")  # the key beside: asked again, and nothing else
    assert len(chat.until("eject? ")) < 60
    chat.type("oh yes, please\n")  # no decision, and no command either
    chat.until("eject? ")
    chat.type("Yes.\n")
    chat.until("Done.")
    chat.until("you: ")
    chat.type("wave\n")
    chat.until("eject? ")
    chat.type("never mind\n")
    assert "Nothing was run" in chat.until("you: ")
    chat.type(CTRL_D)
    assert chat.end() == ExitStatus.OK
    assert log_of() == [("and then wave", "done")]


def test_stop_needs_no_approval_even_while_a_program_runs(start, log_of) -> None:
    chat = start(*CHAT, "--speed", "1", at_terminal=True)
    chat.until("you: ")
    chat.type("stop\n")
    chat.until("Stopped.")
    chat.until("you: ")
    chat.type("go to ward b\n")
    chat.until("eject? ")
    chat.type("ok\n")
    chat.until("goto(place='ward b')")
    chat.type("are you done?\n")
    chat.until("Not yet.")
    chat.type("wave\n")
    chat.until("when this is done")
    chat.type("stop!\n")
    chat.until("Stopped.")
    assert 'robot.gesture("wave")' in chat.until("eject? ")  # its turn has come
    chat.type("n\n")
    chat.until("you: ")
    chat.type("quit\n")
    assert chat.end() == ExitStatus.OK
    assert log_of() == [("go to ward b", "stopped")]


def test_a_piped_conversation_loses_no_line(run_piped) -> None:
    told = run_piped(
        *CHAT,
        said=["go to ward a", "no, ward b", "yes", "what happened?", "go to ward a", "n", "quit"],
    )
    assert told.count('robot.goto("ward b")') == 1
    assert "“no, ward b” is done." in told
    assert "Nothing was run" in told
    assert told.rstrip().endswith("Goodbye.")


def test_the_terminal_speaks_german_and_french(run_piped) -> None:
    told = run_piped(*CHAT, "--lang", "de", said=["geh in die Station A", "ja", "ende"])
    assert "In Worten:" in told and "Fertig." in told and "Auf Wiedersehen." in told
    told = run_piped(*CHAT, "--lang", "fr", said=["va au service A", "oui", "fin"])
    assert "En clair :" in told and "C'est fait." in told and "Au revoir." in told
