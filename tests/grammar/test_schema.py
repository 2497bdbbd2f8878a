"""The JSON Schema of a plan knows the robot's methods."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from jsonschema import Draft202012Validator

from grammar import plan as p
from grammar.schema import plan_schema
from robot_api.methods import METHODS
from tests.grammar import random_plans, sensible_plans

VALIDATOR = Draft202012Validator(plan_schema())
TEXT = {"is": "text", "value": "Hello"}


def valid(*steps: dict[str, Any]) -> bool:
    return VALIDATOR.is_valid({"steps": list(steps)})


def test_it_is_a_schema() -> None:
    Draft202012Validator.check_schema(plan_schema())


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(st.one_of(random_plans.plans, sensible_plans.plans))
def test_every_plan_is_valid_and_comes_back_from_json(plan: p.Plan) -> None:
    data = json.loads(json.dumps(p.to_data(plan)))
    VALIDATOR.validate(data)
    assert p.from_data(data) == plan


@pytest.mark.parametrize("method", METHODS)
def test_every_method_takes_its_parameters_and_no_other(method: str) -> None:
    for form in METHODS[method].forms:
        required = {each.name: TEXT for each in form if each.required}
        everything = {each.name: TEXT for each in form}
        assert valid({"is": "call", "method": method, "arguments": everything})
        assert valid({"is": "call", "method": method, "arguments": required})
        for left_out in required:
            less = {name: each for name, each in required.items() if name != left_out}
            others = [
                set(less) >= {each.name for each in other if each.required}
                for other in METHODS[method].forms
            ]
            assert valid({"is": "call", "method": method, "arguments": less}) is any(others)
    strange = {**required, "speed_of_light": TEXT}
    call = {"is": "call", "method": method, "arguments": strange}
    assert valid(call) is METHODS[method].extra


def test_what_no_robot_has_is_not_valid() -> None:
    assert valid({"is": "call", "method": "say", "arguments": {"text": TEXT}})
    assert not valid({"is": "call", "method": "fly"})
    assert not valid({"is": "call", "method": "say"})
    assert not valid({"is": "call", "method": "say", "arguments": {"words": TEXT}})
    assert not valid({"is": "call", "method": "dock", "save": "x"})
    clock = {"is": "ask", "method": "clock"}
    assert valid({"is": "remember", "name": "x", "value": {**clock, "field": "time"}})
    assert not valid({"is": "remember", "name": "x", "value": {**clock, "field": "hour"}})
    assert not valid({"is": "remember", "name": "x", "value": {"is": "ask", "method": "fly"}})


def test_operators_are_those_there_are() -> None:
    number = {"is": "number", "value": 1}

    def calculated(operator: str) -> bool:
        value = {"is": "arithmetic", "left": number, "operator": operator, "right": number}
        return valid({"is": "remember", "name": "x", "value": value})

    def compared(operator: str) -> bool:
        value = {"is": "compare", "left": number, "operator": operator, "right": number}
        return valid({"is": "if", "condition": value, "then": []})

    assert calculated("//") and not calculated("**")
    assert compared("<=") and compared("in") and not compared("is")
