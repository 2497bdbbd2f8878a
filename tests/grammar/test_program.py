"""Plans become programs that a beginner can read and that do what the plan says."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grammar import plan as p
from grammar.layout import WIDTH
from grammar.program import PlanError, program_lines, write_program
from tests.grammar.random_plans import plans

MODEST = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))


def text(value: str) -> p.Text:
    return p.Text(value)


def call(method: str, save_as: str | None = None, /, **arguments: p.Value) -> p.Call:
    return p.Call(method, dict(arguments), save_as)


def written(*steps: p.Step) -> str:
    return write_program(p.Plan(steps))


VISITORS = (
    call("location", "desk"),
    p.Repeat(
        p.Number(3),
        (
            call("wait_for", thing=text("person")),
            call(
                "ask",
                "place",
                question=text("Would you like to go to radiology or to the pharmacy?"),
                options=p.Items((text("radiology"), text("pharmacy"))),
            ),
            call("guide", person=text("person"), place=p.Recall("place")),
            call("goto", place=p.Recall("desk")),
        ),
    ),
    call("say", text=text("Three visitors have been shown the way.")),
)


def test_the_visitors_of_the_design_are_shown_the_way() -> None:
    assert written(*VISITORS) == (
        "desk = robot.location()\n"
        "for visitor in range(3):\n"
        '    robot.wait_for("person")\n'
        "    place = robot.ask(\n"
        '        "Would you like to go to radiology or to the pharmacy?", '
        '["radiology", "pharmacy"]\n'
        "    )\n"
        '    robot.guide("person", place)\n'
        "    robot.goto(desk)\n"
        'robot.say("Three visitors have been shown the way.")\n'
    )


def test_what_may_be_left_out_is_named() -> None:
    assert written(call("find", thing=text("stapler"), place=text("lab"))) == (
        'robot.find("stapler", place="lab")\n'
    )
    assert written(call("show", url=text("https://example.org"))) == (
        'robot.show(url="https://example.org")\n'
    )
    assert written(call("goto", x=p.Number(1.5), y=p.Number(-2.0), theta=p.Number(90))) == (
        "robot.goto(1.5, -2, theta=90)\n"
    )
    assert written(p.Call("do", {"skill": text("sit"), "How long": p.Number(3)})) == (
        'robot.do("sit", how_long=3)\n'
    )


def test_an_answer_is_compared_in_lower_case() -> None:
    coffee = call("ask", "answer", question=text("Coffee?"))
    yes = p.Compare(text("Yes"), "in", p.Recall("answer"))
    program = written(coffee, p.If(yes, (call("say", text=text("Here you are.")),)))
    assert 'if "yes" in answer.lower():' in program
    exactly = p.Compare(p.Recall("answer"), "==", text("YES"))
    assert 'if answer.lower() == "yes":' in written(coffee, p.If(exactly, ()))
    one_of = p.Compare(p.Recall("answer"), "in", p.Items((text("Yes"), text("Sure"))))
    assert 'if answer.lower() in ["yes", "sure"]:' in written(coffee, p.If(one_of, ()))


def test_alice_is_found_among_the_people_whatever_the_case() -> None:
    here = p.Compare(text("Alice"), "in", p.Ask("people"))
    assert 'if "alice" in [name.lower() for name in robot.people()]:' in written(p.If(here, ()))


def test_where_the_robot_is_can_be_compared_with_a_place() -> None:
    for ask in (p.Ask("location"), p.Ask("location", field="place")):
        at = p.Compare(ask, "==", text("Pharmacy"))
        assert 'if str(robot.location()).lower() == "pharmacy":' in written(p.If(at, ()))


def test_a_number_that_was_heard_is_counted_with() -> None:
    asked = call("ask", "answer", question=text("How many rounds?"))
    program = written(asked, p.Repeat(p.Recall("answer"), (call("turn", degrees=p.Number(90)),)))
    assert "for repetition in range(number_in(answer)):" in program


def test_a_loop_that_only_looks_pauses_between_looks() -> None:
    nobody = p.Not(p.Holds(p.Ask("sees", {"thing": text("person")})))
    assert written(p.While(nobody, ())) == ('while not robot.sees("person"):\n    robot.wait(1)\n')
    assert "robot.wait(1)" in written(p.Forever((call("emotion", name=text("happy")),)))
    assert "robot.wait(1)" not in written(p.Forever((call("say", text=text("hello")),)))
    maybe = p.If(nobody, (call("say", text=text("hello")),))
    assert "robot.wait(1)" in written(p.Forever((maybe,)))


def test_otherwise_if_reads_as_elif() -> None:
    def hears(word: str) -> p.Compare:
        return p.Compare(p.Recall("answer"), "==", text(word))

    program = written(
        call("ask", "answer", question=text("Where to?")),
        p.If(
            hears("lab"),
            (call("goto", place=text("lab")),),
            (p.If(hears("ward"), (call("goto", place=text("ward")),), (call("dock"),)),),
        ),
    )
    assert [line.split()[0] for line in program.splitlines() if not line.startswith(" ")] == [
        "answer",
        "if",
        "elif",
        "else:",
    ]


def test_sentences_are_f_strings_lists_are_spoken_with_commas() -> None:
    sentence = p.Sentence(
        (text("I see "), p.Ask("objects"), text(" at "), p.Ask("clock", field="time"), text("."))
    )
    assert written(call("say", text=sentence)) == (
        """robot.say(f"I see {', '.join(robot.objects())} at {robot.clock().time}.")\n"""
    )


def test_quotes_within_and_without() -> None:
    sentence = p.Sentence((text('"Hello", I said to '), p.Ask("people")))
    assert written(call("say", text=sentence)) == (
        """robot.say(f'"Hello", I said to {", ".join(robot.people())}')\n"""
    )


def test_names_cannot_hide_python_or_the_robot() -> None:
    program = written(
        *(p.Remember(name, p.Number(1)) for name in ("robot", "class", "len", "Übung", "uebung"))
    )
    names = [line.split()[0] for line in program.splitlines()]
    assert len(set(names)) == 5
    assert all(name.isidentifier() for name in names)
    assert not {"robot", "class", "len"} & set(names)


def test_a_helper_and_an_import_stand_at_the_top_only_when_used() -> None:
    share = p.Share(p.Recall("yes"), p.Recall("all"))
    program = written(
        p.Remember("yes", p.Number(1)),
        p.Remember("all", p.Number(4)),
        call("say", text=p.Sentence((share, text(" percent")))),
        call("say", text=p.Choice(p.Items((text("a"), text("b"))))),
    )
    assert program.startswith("import random\n\n\ndef percent(part, whole):\n")
    # The name "all" would hide a function of Python's.
    assert 'robot.say(f"{percent(yes, all_)} percent")' in program
    assert "import" not in written(call("dock"))


@pytest.mark.parametrize(
    "step",
    [
        p.End(),
        call("fly"),
        call("goto"),
        call("goto", place=text("lab"), speed=p.Number(3)),
        call("wait", seconds=p.Number(float("nan"))),
        call("wait", seconds=p.Number(10**5000)),
        p.If(p.Compare(p.Number(1), "is", p.Number(1)), ()),
    ],
)
def test_what_no_program_can_do_is_refused(step: p.Step) -> None:
    with pytest.raises(PlanError):
        written(step)


def test_every_line_knows_its_step() -> None:
    plan = p.Plan(VISITORS)
    lines = program_lines(plan)
    assert "".join(f"{line.text}\n" for line in lines) == write_program(plan)
    assert [line.step for line in lines][:3] == [VISITORS[0], VISITORS[1], VISITORS[1].steps[0]]  # type: ignore[union-attr]


@MODEST
@given(plans)
def test_every_plan_becomes_a_program(plan: p.Plan) -> None:
    program = write_program(plan)
    ast.parse(program)
    assert "\t" not in program
    assert program.endswith("\n")


@settings(max_examples=300, deadline=None)
@given(st.text(min_size=1))
def test_no_text_can_break_out_of_its_quotes(words: str) -> None:
    for said in (text(words), p.Sentence((text(words), p.Ask("battery")))):
        tree = ast.parse(written(call("say", text=said)))
        [statement] = tree.body
        assert isinstance(statement, ast.Expr)
        assert isinstance(statement.value, ast.Call)
        [argument] = statement.value.args
        if isinstance(argument, ast.JoinedStr):
            argument = argument.values[0]
        assert isinstance(argument, ast.Constant)
        assert argument.value == words


@given(st.text())
def test_hidden_characters_are_visible_in_the_program(words: str) -> None:
    program = written(call("say", text=text(words + "\u202e")))
    assert all(
        character.isprintable() for character in program.removesuffix("\n") if character != "\n"
    )
    assert "\\u202e" in program


STRANGE = re.compile(
    r"^ *("
    r"(if|elif|while|for) .*[(\[{]"  # a condition
    r"|[-+*/%]+ .*|.* [-+*/%]+ .*[(\[{]"  # a sum
    r"|.*[\]})]\.\w+\("  # something done to a whole list
    r"|.{80,}\] [-+]?= .*|.*\] = (\w+\.get)?\("  # a key
    r"|.*\{|\}.*"  # a record
    r"|.{80,}\.join\("  # what is put between
    r")$",
    re.MULTILINE,
)
"""What is too long for a line where ruff might cut it elsewhere."""


def ordinary(program: str) -> bool:
    """Whether nothing in it is so strange that ruff might cut a line elsewhere, and all characters
    are one column wide."""
    return max(program) < "\u0300" and not STRANGE.search(program.rpartition("\n\n\n")[2])


def test_programs_are_laid_out_as_ruff_would(tmp_path: Path) -> None:
    entries = ((text(f"the waiting room on floor {n}"), p.Number(n)) for n in range(4))
    record = p.Remember("visitors", p.Record(tuple(entries)))
    programs: list[str] = [written(*VISITORS, record)]

    @MODEST
    @given(plans)
    def collect(plan: p.Plan) -> None:
        programs.append(write_program(plan))

    collect()
    programs = [programs[0], *filter(ordinary, programs[1:])]
    assert all(len(line) <= WIDTH for program in programs for line in program.splitlines())
    assert len(programs) > 5
    for number, program in enumerate(programs):
        (tmp_path / f"program{number}.py").write_text(program, encoding="utf-8")
    config = Path(__file__).parents[2] / "pyproject.toml"
    checked = subprocess.run(
        [sys.executable, "-m", "ruff", "format", "--diff", "--config", config, tmp_path],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout[:3000] + checked.stderr[-500:]
