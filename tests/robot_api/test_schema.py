"""What a call may carry: what is let through, and the sentence for what is not."""

import subprocess
import sys
from typing import Any

import jsonschema
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from robot_api.errors import InvalidCall
from robot_api.methods import METHODS, Method
from robot_api.schema import params_schema, read_arguments, read_result, result_schema
from robot_api.values import Clock, Location


def test_defaults_are_filled_in_so_that_a_driver_finds_every_parameter() -> None:
    assert read_arguments("listen") == {"prompt": None, "timeout": 10}


def test_a_call_by_position_is_the_call_by_name() -> None:
    assert read_arguments("goto", [1, 2.5]) == {"x": 1, "y": 2.5, "theta": None}
    assert read_arguments("goto", [1], {"y": 2, "theta": 90}) == {"x": 1, "y": 2, "theta": 90}
    assert read_arguments("goto", ["pharmacy"]) == {"place": "pharmacy"}


@pytest.mark.parametrize(
    "place", [Location(1.0, 2.0, 90.0), {"x": 1, "y": 2, "theta": 90, "place": None}]
)
def test_a_place_may_be_a_remembered_location(place: object) -> None:
    assert read_arguments("goto", [place]) == {"place": Location(1.0, 2.0, 90.0)}
    assert read_arguments("guide", ["person", place])["place"] == Location(1.0, 2.0, 90.0)


def test_a_whole_number_may_be_written_with_a_point() -> None:
    percent = read_arguments("set_volume", [50.0])["percent"]
    assert percent == 50
    assert isinstance(percent, int)


def test_a_robots_own_skill_takes_parameters_of_its_own() -> None:
    assert read_arguments("do", ["sit"], {"slowly": True}) == {"skill": "sit", "slowly": True}


@pytest.mark.parametrize(
    "name, positional, named, sentence",
    [
        ("gotoo", [], {}, "There is no method 'gotoo'; did you mean goto?"),
        ("goto", [], {"z": 1}, "goto has no parameter 'z'; it takes place, x, y and theta."),
        ("goto", [], {}, "goto needs a place, or x and y; got nothing."),
        ("goto", [1, 2, 3, 4], {}, "goto needs a place, or x and y; got 1, 2, 3 and 4."),
        ("goto", [], {"place": "lab", "x": 1}, "goto needs a place, or x and y; got place and x."),
        ("goto", [1], {}, "place of goto must be a text of 1 to 200 characters or a location"),
        ("say", [], {"txt": "hi"}, "say has no parameter 'txt'; did you mean text?"),
        ("say", [""], {}, "text of say must be a text of 1 to 2000 characters; got ''."),
        ("say", ["a" * 2001], {}, "got a text of 2001 characters."),
        (
            "say",
            ["hi", "english"],
            {},
            "language of say cannot be 'english'. Expected: such as \"de\"",
        ),
        ("set_volume", [150], {}, "percent of set_volume must be a whole number from 0 to 100"),
        ("set_volume", [True], {}, "whole number"),
        ("move", [float("nan")], {}, "metres of move must be a number from -100 to 100; got nan."),
        ("goto", [{"x": float("inf"), "y": 0}], {}, "place of goto must be"),
        ("goto", [{"x": 10**400, "y": 0}], {}, "place of goto must be"),
        ("touch", [[]], {}, "options of touch must be a list of 1 to 20 texts; got []."),
        ("battery", [1], {}, "battery needs no parameters; got 1."),
        ("do", [], {"slowly": True}, "do needs a skill; got slowly."),
    ],
)
def test_a_wrong_call_is_refused_in_a_sentence(
    name: str, positional: list[Any], named: dict[str, Any], sentence: str
) -> None:
    with pytest.raises(InvalidCall) as refusal:
        read_arguments(name, positional, named)
    assert sentence in str(refusal.value)
    assert "\n" not in str(refusal.value)


numbers = st.integers(-2000, 40000) | st.floats(allow_nan=False, allow_infinity=False)
texts = st.sampled_from(["en", "pharmacy", "", "x" * 201, "http://a"]) | st.text(max_size=5)
locations = st.fixed_dictionaries(
    {}, optional={"x": numbers, "y": numbers, "theta": numbers, "place": st.none() | texts}
)
values = (
    numbers | texts | st.none() | st.booleans() | locations | st.lists(texts | numbers, max_size=3)
)


@st.composite
def calls(draw: st.DrawFn) -> tuple[Method, dict[str, Any]]:
    method = draw(st.sampled_from(list(METHODS.values())))
    names = [parameter.name for form in method.forms for parameter in form] + ["other"]
    return method, draw(st.dictionaries(st.sampled_from(names), values, max_size=4))


@given(calls())
@settings(max_examples=600, deadline=None)
def test_exactly_what_the_published_schema_allows_is_let_through(
    call: tuple[Method, dict[str, Any]],
) -> None:
    method, params = call
    valid = jsonschema.Draft202012Validator(params_schema(method)).is_valid(params)
    try:
        arguments = read_arguments(method.name, named=params)
    except InvalidCall:
        assert not valid
    else:
        assert valid
        assert set(params) <= set(arguments)


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS.keys())
def test_the_schemas_are_schemas(method: Method) -> None:
    jsonschema.Draft202012Validator.check_schema(params_schema(method))
    jsonschema.Draft202012Validator.check_schema(result_schema(method))


def test_results_come_back_as_the_values_the_table_promises() -> None:
    assert read_result(METHODS["location"], {"x": 1, "y": 2, "new field": 3}) == Location(1.0, 2.0)
    clock = {"time": "14:05", "weekday": "Friday", "date": "2026-11-20"}
    assert read_result(METHODS["clock"], clock) == Clock(**clock)
    assert read_result(METHODS["places"], ["lab"]) == ["lab"]


def test_the_table_and_the_schemas_load_without_the_validator() -> None:
    code = "import sys, robot_api.schema; print('jsonschema' in sys.modules)"
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert ran.stdout.strip() == "False"
