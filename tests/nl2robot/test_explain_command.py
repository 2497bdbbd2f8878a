"""`nl2robot explain` shows a curious nurse how her sentence was read, and why not."""

import json

import pytest

from nl2robot.cli.main import main


@pytest.fixture
def explained(capsys):
    def explained(words: str, *options: str):
        status = main(["explain", words, "--json", *options])
        return status, json.loads(capsys.readouterr().out)

    return explained


def reading(data) -> dict:
    return {part["words"]: (part["meaning"], part["value"]) for part in data["parts"]}


def test_it_tells_which_words_became_what(explained) -> None:
    status, data = explained("go to the drugstore and take the visitor to Bob's office")
    assert status == 0
    assert reading(data)["drugstore"] == ("place", "pharmacy")
    assert reading(data)["Bob's office"] == ("place", "bob's office")
    assert reading(data)["take the visitor to Bob's office"] == ("guide", None)
    starts = [part["start"] for part in data["parts"] if part["depth"] == 0]
    assert starts == [0, 24]
    assert data["program"] == 'robot.goto("pharmacy")\nrobot.guide("visitor", "bob\'s office")\n'
    assert data["explanation"]
    assert data["unclear"] == ""


def test_its_json_is_that_of_translate_and_more(explained, capsys) -> None:
    _, data = explained("wave")
    assert main(["translate", "wave", "--json"]) == 0
    assert data.keys() == json.loads(capsys.readouterr().out).keys() | {"parts", "unclear"}


def test_it_tells_which_part_was_not_understood(explained) -> None:
    status, data = explained("go to the pharmacy and brumble the frozz")
    assert status == 3
    assert data["program"] is None
    assert "brumble the frozz" in data["unclear"]
    assert reading(data)["pharmacy"] == ("place", "pharmacy")
    _, data = explained("go to Mars")
    assert "Mars" in data["unclear"]


def test_it_tells_what_could_mean_several_things(explained) -> None:
    status, data = explained("wave and go to the office")
    assert (status, data["status"]) == (3, "clarify")
    assert data["unclear"] == "the office"
    assert len(data["suggestions"]) == 3


def test_it_tells_which_word_it_took_for_another(explained) -> None:
    _, data = explained("go to the pharmcy")
    assert data["confidence"] < 1
    assert reading(data)["pharmcy"] == ("“pharmacy”", None)


def test_people_see_the_sentence_the_tree_and_the_program(capsys) -> None:
    assert main(["explain", "if you see a nurse, go to the drugstore and say hello"]) == 0
    shown = capsys.readouterr().out
    for part in ("place: pharmacy", "100% sure", "In words:", 'robot.goto("pharmacy")'):
        assert part in shown
    assert main(["explain", "go to the pharmacy and brumble"]) == 3
    shown = capsys.readouterr().out
    assert "not understood" in shown
    assert "place: pharmacy" in shown


@pytest.mark.parametrize("words", ["", " ", "\x1b[31m", "[bold]", "😀 " * 5, "a" * 3000])
def test_any_words_are_explained(words, capsys) -> None:
    assert main(["explain", words]) == 3
    shown = capsys.readouterr().out
    assert "\x1b[31m" not in shown
    assert "not understood" in shown


def test_a_routine_is_read_as_one(explained, capsys) -> None:
    assert main(["routines", "learn", "tea dance", "wave", "--yes"]) == 0
    capsys.readouterr()
    status, data = explained("do the tea dance")
    assert status == 0
    assert reading(data)["tea dance"] == ("routine", "tea dance")


def test_it_tells_in_which_other_words_it_was_read(capsys) -> None:
    assert main(["explain", "Keep Alice company"]) == 0
    out = capsys.readouterr().out
    assert out.startswith("Keep Alice company\nin other words\nstay with Alice\n")
    main(["explain", "go to the pharmacy"])
    assert "in other words" not in capsys.readouterr().out


ROUND = 'for place in robot.places("ward"):\n    robot.goto(place)\nrobot.say("Tea!")\n'


def test_a_program_is_read_line_by_line(tmp_path, capsys) -> None:
    file = tmp_path / "round.py"
    file.write_text(ROUND, encoding="utf-8")
    assert main(["explain", str(file)]) == 0
    told = capsys.readouterr().out
    assert "say “Tea!”" in told and "Error" not in told
    assert main(["explain", str(file), "--json", "--lang", "de"]) == 0
    data = json.loads(capsys.readouterr().out)
    assert data["program"] == ROUND and [each["line"] for each in data["reading"]] == [1, 2, 3]


def test_what_is_wrong_with_a_program_is_told_with_its_line(tmp_path, capsys) -> None:
    file = tmp_path / "round.py"
    file.write_text(ROUND + 'robot.goto("Utopia")\n', encoding="utf-8")
    assert main(["explain", str(file)]) == 1
    told = capsys.readouterr().out
    assert "line 4" in told and "Utopia" in told and "In words" not in told


@pytest.mark.parametrize(("command", "says"), [("explain", "cannot be read"), ("lint", "explain")])
def test_a_program_that_is_not_there_or_no_world_is_said(command: str, says: str, capsys) -> None:
    assert main([command, "no-such-round.py"]) == 2
    assert says in capsys.readouterr().err
