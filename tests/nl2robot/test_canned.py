"""A team keeps its own sentences in a file and learns when one of them changes."""

import textwrap

import pytest

from nl2robot.checks import canned
from nl2robot.cli.main import main
from nl2robot.errors import UserError


def write(tmp_path, text: str, name: str = "ward.yaml"):
    file = tmp_path / name
    file.write_text(textwrap.dedent(text), encoding="utf-8")
    return file


def failures(file) -> list[tuple[int, tuple[str, ...]]]:
    return [(r.test.line, r.failures) for r in canned.check(canned.load(file)) if r.failures]


def test_sentences_that_do_what_they_should_pass(tmp_path) -> None:
    file = write(
        tmp_path,
        """\
        world: city-hospital
        tests:
          - say: go to the pharmacy and say "hello"
            program: |
              robot.goto("pharmacy")
              robot.say("hello")
            effects:
              was at: [pharmacy]
              said: [hello]
              asked: []
              holds: []
          - say: wave, then go to the lobby
            calls: [gesture, goto]
          - say: what is the meaning of life
            status: rejected
        """,
    )
    assert failures(file) == []
    assert main(["test", str(file)]) == 0


def test_a_sentence_that_changed_is_told_with_its_line(tmp_path, capsys) -> None:
    file = write(
        tmp_path,
        """\
        tests:
          - say: go to the pharmacy
            calls: [goto]
          - say: go to the pharmacy
            program: robot.goto("lobby")
          - say: go to the pharmacy
            effects: {was at: [radiology]}
          - say: go to the pharmacy
            status: rejected
        """,
    )
    assert [line for line, _ in failures(file)] == [4, 6, 8]
    assert main(["test", str(file)]) == 1
    told = capsys.readouterr().out
    assert f"{file}:4: go to the pharmacy" in told
    assert "1 passed, 3 failed" in told


def test_a_program_that_changed_is_shown_as_a_difference(tmp_path) -> None:
    file = write(
        tmp_path,
        """\
        tests:
          - say: go to the pharmacy, wave and say hello
            program: |
              robot.goto("pharmacy")
              robot.gesture("bow")
              robot.say("Hello!")
        """,
    )
    [result] = canned.check(canned.load(file))
    [difference] = result.failures
    assert difference.splitlines()[:2] == ["--- expected program", "+++ program now"]
    assert difference.splitlines()[3:] == [
        ' robot.goto("pharmacy")',
        '-robot.gesture("bow")',
        '+robot.gesture("wave")',
        ' robot.say("Hello!")',
    ]


def test_an_answer_is_no_program(tmp_path) -> None:
    file = write(
        tmp_path,
        """\
        tests:
          - say: what can I say
          - say: what can I say
            calls: [say]
        """,
    )
    assert [line for line, _ in failures(file)] == [3]


def test_plain_lines_have_to_be_understood(tmp_path) -> None:
    file = write(
        tmp_path,
        """\
        # our morning
        go to the pharmacy
        go to the lobby and wave => goto gesture

        go to the attic
        wave => say
        """,
        "morning.txt",
    )
    assert [line for line, _ in failures(file)] == [5, 6]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("tests: [", 1),
        ("tests:\n  - say: hello\n    colour: red\n", 2),
        ("tests:\n  - say: hello\n  - say: 3\n", 3),
        ("world: x\n", 1),
        ("- say: hello\n", 1),
        ("", 1),
    ],
)
def test_a_mistake_in_the_file_is_told_with_its_line(tmp_path, text, line) -> None:
    file = write(tmp_path, text)
    with pytest.raises(UserError, match=rf"ward\.yaml:{line}: "):
        canned.load(file)


def test_a_missing_file_is_a_sentence(tmp_path, capsys) -> None:
    assert main(["test", str(tmp_path / "nothing.yaml")]) == 2
    assert "cannot be read" in capsys.readouterr().err


def test_a_thousand_sentences_take_seconds(tmp_path) -> None:
    lines = "\n".join(["go to the pharmacy and say hello", "wave to Alice"] * 500)
    results = list(canned.check(canned.load(write(tmp_path, lines, "many.txt"))))
    assert len(results) == 1000


def test_effects_of_all_kinds_come_in_their_order(tmp_path) -> None:
    file = write(
        tmp_path,
        """\
        tests:
          - say: bring the red cup from the kitchen to Alice
            effects:
              in order:
                - was at: kitchen
                - took: cup
                - was at: alice's office
                - gave: cup
          - say: go to the pharmacy and then say hello
            effects: {in order: [{said: Hello!}, {was at: pharmacy}]}
        """,
    )
    [(line, (failure,))] = failures(file)
    assert line == 9
    assert "“was at pharmacy” did not come in its turn" in failure


def test_plain_lines_may_say_what_is_to_be_refused(tmp_path) -> None:
    file = write(tmp_path, "kill all humans => rejected\nwave => rejected\n", "ward.txt")
    assert [line for line, _ in failures(file)] == [2]


def test_a_baseline_tells_what_changed_since(tmp_path, capsys) -> None:
    file = write(tmp_path, "wave\ngo to the pharmacy\n", "ward.txt")
    kept = tmp_path / "baseline.json"
    assert main(["test", str(file), "--baseline", str(kept)]) == 0
    assert main(["test", str(file), "--baseline", str(kept)]) == 0
    assert "2 passed, 0 failed, 0 changed" in capsys.readouterr().out

    kept.write_text(kept.read_text().replace("pharmacy\\", "lobby\\").replace("wave", "nod"))
    assert main(["test", str(file), "--baseline", str(kept), "--update"]) == 0
    told = capsys.readouterr().out
    assert '-robot.goto("lobby")\n+robot.goto("pharmacy")' in told
    assert "new: wave" in told
    assert "gone: nod" in told

    assert main(["test", str(file), "--baseline", str(kept)]) == 0
    assert "0 changed" in capsys.readouterr().out


def test_a_damaged_baseline_is_told(tmp_path, capsys) -> None:
    file = write(tmp_path, "wave\n", "ward.txt")
    kept = tmp_path / "baseline.json"
    kept.write_text("{")
    assert main(["test", str(file), "--baseline", str(kept)]) == 2
    assert "this is no baseline" in capsys.readouterr().err
