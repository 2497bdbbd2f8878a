"""The JSON Schema of a plan, which knows the method table.

`msgspec` makes it from the nodes; here each robot method gets a schema of its own, with the names
of its parameters, so that a plan from elsewhere cannot ask for what no robot has. What a value, a
condition and a step can be is written once and referred to.
"""

from __future__ import annotations

from typing import Any, Final

import msgspec

from grammar import plan as p
from grammar.kinds import FIELDS
from robot_api.methods import METHODS, Method, Parameter

Schema = dict[str, Any]

NULL: Final[Schema] = {"type": "null"}
VALUE: Final[Schema] = {"$ref": "#/$defs/Value"}


def plan_schema() -> Schema:
    """The JSON Schema (draft 2020-12) of `to_data(plan)`."""
    whole = msgspec.json.schema(p.Plan)
    nodes: dict[str, Schema] = whole["$defs"]
    unions = {
        "Value": nodes["Remember"]["properties"]["value"],
        "Condition": nodes["If"]["properties"]["condition"],
        "Step": nodes["Plan"]["properties"]["steps"]["items"],
    }
    named = {name: _by_name(node, unions) for name, node in nodes.items()}
    for name in ("Call", "Ask"):
        named[name] = _robot_call(named[name])
    return {**whole, "$defs": {**{name: _one_of(each) for name, each in unions.items()}, **named}}


def _by_name(part: Any, unions: dict[str, Schema]) -> Any:
    """A part of a schema in which the unions are referred to."""
    if isinstance(part, list):
        return [_by_name(each, unions) for each in part]
    if not isinstance(part, dict):
        return part
    choices = part.get("anyOf", [])
    for name, union in unions.items():
        if [each for each in choices if each != NULL] == union["anyOf"]:
            reference: Schema = {"$ref": f"#/$defs/{name}"}
            optional = {"anyOf": [reference, NULL], "default": None}
            return optional if NULL in choices else reference
    return {name: _by_name(each, unions) for name, each in part.items()}


def _one_of(union: Schema) -> Schema:
    """The nodes of a union, told apart by their tags. With `anyOf` alone, a validator would go into
    each of them, and into each of theirs, and never come back."""
    nodes: dict[str, str] = union["discriminator"]["mapping"]
    return {
        "type": "object",
        "properties": {"is": {"enum": list(nodes)}},
        "required": ["is"],
        "allOf": [_where("is", tag, {"$ref": node}) for tag, node in nodes.items()],
    }


def _where(name: str, value: str, schema: Schema) -> Schema:
    """What also holds where a property has this value."""
    return {"if": {"properties": {name: {"const": value}}, "required": [name]}, "then": schema}


def _robot_call(node: Schema) -> Schema:
    """A call of a robot method, which has the parameters of that method."""
    properties = {**node["properties"], "method": {"enum": list(METHODS)}}
    cases = []
    for method in METHODS.values():
        case = _arguments(method)
        if "field" in properties:  # a part of what the method gives
            parts = FIELDS.get(method.returns.annotation, ())
            case["properties"]["field"] = {"enum": [None, *parts]}
        cases.append(_where("method", method.name, case))
    return {**node, "properties": properties, "allOf": cases}


def _arguments(method: Method) -> Schema:
    """The arguments of a method, in one of its forms."""
    forms = [_parameters(form, extra=method.extra) for form in method.forms]
    arguments = forms[0] if len(forms) == 1 else {"anyOf": forms}
    needs_some = all(form["required"] for form in forms)
    return {
        "description": method.doc,
        "properties": {"arguments": arguments},
        "required": ["arguments"] if needs_some else [],
    }


def _parameters(form: tuple[Parameter, ...], *, extra: bool) -> Schema:
    return {
        "type": "object",
        "properties": {each.name: {**VALUE, "description": each.doc} for each in form},
        "required": [each.name for each in form if each.required],
        "additionalProperties": VALUE if extra else False,
    }
