"""Programs are type-checked against the stub: what it lets through and what it catches."""

import ast
import inspect

import pydantic_monty
import pytest

from robot_api.calls import Calls
from robot_api.driver import Capabilities
from robot_api.methods import METHODS
from robot_api.stub import CALLS, calls, stub

ROUNDS = """
desk = robot.location()
for visitor in range(3):
    robot.wait_for("person")
    place = robot.ask("To radiology or to the pharmacy?", ["radiology", "pharmacy"])
    robot.guide("person", place)
    robot.goto(desk)
robot.goto(12.0, 3.5)
robot.goto(x=12, y=3, theta=90)
robot.do("sit", slowly=True)
robot.say(f"It is {robot.clock().time} and I am in {desk.place}, {robot.battery() - 1} percent.")
"""


def complaints(program: str, stubs: str) -> str:
    with (
        pydantic_monty.Monty() as pool,
        pool.checkout(
            type_check=True, type_check_stubs=stubs, type_check_format="concise"
        ) as session,
    ):
        try:
            session.feed_start(program)
        except pydantic_monty.MontyTypingError as error:
            return error.display()
        except pydantic_monty.MontyError:
            pass  # it passed the check, and there is no robot to run it on
    return ""


def test_a_round_of_guiding_visitors_passes_the_type_check() -> None:
    assert complaints(ROUNDS, stub()) == ""


@pytest.mark.parametrize(
    "line, complaint",
    [
        ("robot.gotoo('pharmacy')", "gotoo"),
        ("robot.goto(1)", "Location"),
        ("robot.goto(1, 2, 3, 4)", "overload"),
        ("robot.say()", "text"),
        ("robot.say(5)", "str"),
        ("robot.set_volume('loud')", "int"),
        ("robot.location().room", "room"),
        ("robto.say('hello')", "robto"),
    ],
)
def test_a_slip_in_a_program_is_found_before_it_runs(line: str, complaint: str) -> None:
    assert complaint in complaints(line, stub())


def test_a_robot_without_hands_has_no_grab_in_its_stub() -> None:
    no_hands = Capabilities(name="Tablet", kind="emulator", methods=("say", "stop"))
    assert "grab" in complaints("robot.grab('stapler')", stub(no_hands))
    assert complaints("robot.say('I have no hands.')", stub(no_hands)) == ""


def test_a_robot_that_can_do_nothing_still_has_a_stub_that_parses() -> None:
    ast.parse(stub(Capabilities(name="Brick", kind="emulator", methods=())))


def test_every_method_of_the_table_is_in_the_stub_with_its_doc() -> None:
    robot = next(
        node
        for node in ast.parse(stub()).body
        if isinstance(node, ast.ClassDef) and node.name == "Robot"
    )
    found = [node for node in robot.body if isinstance(node, ast.FunctionDef)]
    assert {function.name for function in found} == set(METHODS)
    assert len(found) == sum(len(method.forms) for method in METHODS.values())
    assert all(ast.get_docstring(function) == METHODS[function.name].doc for function in found)


def test_the_clients_methods_are_made_from_the_table_as_it_stands() -> None:
    assert CALLS.read_text(encoding="utf-8") == calls(), "run: python -m robot_api.stub --write"


@pytest.mark.parametrize("name", METHODS)
def test_a_method_of_the_client_passes_on_what_it_was_given(name: str) -> None:
    class Recorder(Calls):
        def _call(self, method: str, /, *arguments: object, **named: object) -> object:
            self.made = (method, arguments, named)
            return None

    recorder = Recorder()
    form = METHODS[name].forms[0]
    given = {parameter.name: object() for parameter in form}
    getattr(recorder, name)(**given)
    assert recorder.made == (name, (), given)
    if len(METHODS[name].forms) == 1:
        assert list(inspect.signature(getattr(Calls, name)).parameters)[1:][: len(form)] == list(
            given
        )
