"""What a call may carry: JSON Schemas from the method table, and the reading of parameters.

`read_arguments` is what stands between the wire (or a program) and a driver: it takes parameters by
name or by position, refuses what the table does not allow with a sentence that a beginner
understands, and hands on exactly the arguments of one form of the method, defaults filled in and
locations as `Location`. Values are validated with `jsonschema`, imported on first use.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Final

import msgspec

from robot_api.errors import InvalidCall
from robot_api.methods import CLOCK, LOCATION, METHODS, PLACE_OR_LOCATION, Kind, Method, Parameter
from robot_api.values import Clock, Location

if TYPE_CHECKING:
    from jsonschema import Draft202012Validator

Form = tuple[Parameter, ...]


# --- schemas -------------------------------------------------------------------------------------


def params_schema(method: Method) -> dict[str, Any]:
    """The JSON Schema of a method's params, given by name."""
    forms = [_form_schema(form, extra=method.extra) for form in method.forms]
    return forms[0] if len(forms) == 1 else {"anyOf": forms}


def result_schema(method: Method) -> dict[str, Any]:
    """The JSON Schema of a method's result."""
    return method.returns.schema


def _form_schema(form: Form, *, extra: bool) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {parameter.name: parameter_schema(parameter) for parameter in form},
        "required": [parameter.name for parameter in form if parameter.required],
        "additionalProperties": extra,
    }


def parameter_schema(parameter: Parameter) -> dict[str, Any]:
    """The JSON Schema of one parameter, with its doc and default."""
    schema = {**parameter.kind.schema, "description": parameter.doc}
    return schema if parameter.required else {**schema, "default": parameter.default}


# --- reading the parameters of a call ------------------------------------------------------------


def find_method(name: str) -> Method:
    """The row of the table; `InvalidCall` with the nearest name if there is none."""
    try:
        return METHODS[name]
    except KeyError:
        raise InvalidCall(no_such_method(name, METHODS)) from None


def no_such_method(name: str, known: Iterable[str]) -> str:
    """The sentence for a method that is not among the known ones."""
    return f"There is no method {_shown(name)}{did_you_mean(name, known)}"


def read_arguments(
    name: str, positional: Sequence[Any] = (), named: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """The arguments of a call, checked and complete.

    Of the form of the method that was meant, every parameter is there: defaults are filled in, a
    place given as a location (`Location` or its JSON object) is a `Location`, and a whole number
    written 5.0 is 5. Raises `InvalidCall`.
    """
    method = find_method(name)
    form, given = _bind(method, positional, named or {})
    arguments = {
        parameter.name: _read_value(method, parameter, given[parameter.name])
        if parameter.name in given
        else parameter.default
        for parameter in form
    }
    return {**given, **arguments} if method.extra else arguments


def bind(name: str, positional: Sequence[Any], named: Mapping[str, Any]) -> dict[str, Any]:
    """The parameters that were given, by name, unchecked. Raises `InvalidCall` if they fit no form
    of the method."""
    return _bind(find_method(name), positional, named)[1]


def _bind(
    method: Method, positional: Sequence[Any], named: Mapping[str, Any]
) -> tuple[Form, dict[str, Any]]:
    """The form of the method that was meant, and what was given for it by name."""
    for form in method.forms:
        if _fits(form, method, len(positional), named):
            names = (parameter.name for parameter in form)
            return form, {**dict(zip(names, positional, strict=False)), **named}
    raise InvalidCall(_does_not_fit(method, positional, named))


def _fits(form: Form, method: Method, count: int, named: Mapping[str, Any]) -> bool:
    """Whether so many values and these names can fill the form."""
    if count > len(form):
        return False
    by_position = {parameter.name for parameter in form[:count]}
    known = {parameter.name for parameter in form}
    return (
        by_position.isdisjoint(named)
        and (method.extra or known.issuperset(named))
        and all(
            parameter.name in named
            for parameter in form
            if parameter.required and parameter.name not in by_position
        )
    )


def _read_value(method: Method, parameter: Parameter, value: Any) -> Any:
    kind = parameter.kind
    if kind is PLACE_OR_LOCATION and not isinstance(value, str):
        return _read_location(method, parameter, value)
    if isinstance(value, float) and not math.isfinite(value):
        raise InvalidCall(wrong_value(method, parameter, value))
    if not _accepts(kind, value):
        raise InvalidCall(wrong_value(method, parameter, value))
    if isinstance(value, float) and kind.schema.get("type") == "integer":
        return int(value)
    return value


def _read_location(method: Method, parameter: Parameter, value: Any) -> Location:
    try:
        location = msgspec.convert(value, Location, from_attributes=True)
    except msgspec.ValidationError:
        raise InvalidCall(wrong_value(method, parameter, value)) from None
    if not all(math.isfinite(number) for number in (location.x, location.y, location.theta)):
        raise InvalidCall(wrong_value(method, parameter, value))
    return location


def _accepts(kind: Kind, value: Any) -> bool:
    return not is_oversize(kind.schema, value) and _validator(kind)(value)


MOST_SHOWN: Final = 10
"""Of what was given, in a sentence that refuses it."""
LARGEST: Final = 2**63 - 1
"""Whole number, either side of 0: what stores and computes numbers takes no larger ones."""
MOST: Final = 1000
"""Items of a list, and fields of an object, where a schema does not say how many it may have."""


def is_oversize(schema: Mapping[str, Any], value: Any) -> bool:
    """Whether something is longer than its JSON Schema allows, wherever within: what is in it is
    looked at only if not. A validator looks at each item before it counts them."""
    forms = [schema, *schema.get("anyOf", ())]

    def within(name: str, otherwise: int) -> bool:
        most = [form[name] for form in forms if name in form]
        return len(value) <= max(most, default=otherwise)

    match value:
        case int():
            return abs(value) > LARGEST
        case str():
            return not within("maxLength", len(value))
        case list():
            if not within("maxItems", MOST):
                return True
            inner: Mapping[str, Any] = next(
                (form["items"] for form in forms if "items" in form), {}
            )
            return any(is_oversize(inner, each) for each in value)
        case dict():
            if not within("maxProperties", MOST):
                return True
            fields = {k: v for form in forms for k, v in form.get("properties", {}).items()}
            return any(is_oversize(fields.get(name, {}), each) for name, each in value.items())
        case _:
            return False


def with_whole_numbers(schema: Mapping[str, Any], value: Any) -> Any:
    """A value that was checked, with whole numbers where its JSON Schema asks for them: in JSON 5
    and 5.0 are the same."""
    match value:
        case float() if "integer" in schema.get("type", ()) and value.is_integer():
            return int(value)
        case list() if "items" in schema:
            return [with_whole_numbers(schema["items"], each) for each in value]
        case dict():
            fields = schema.get("properties", {})
            return {k: with_whole_numbers(fields.get(k, {}), each) for k, each in value.items()}
        case _:
            return value


_validators: dict[int, Callable[[Any], bool]] = {}


def _validator(kind: Kind) -> Callable[[Any], bool]:
    """Compiled once for each kind of the table; kinds live as long as the table."""
    found = _validators.get(id(kind))
    if found is None:
        found = _validators[id(kind)] = compiled(kind.schema).is_valid
    return found


def compiled(schema: Mapping[str, Any]) -> Draft202012Validator:
    """A validator of a JSON Schema (draft 2020-12)."""
    from jsonschema import Draft202012Validator

    return Draft202012Validator(schema)


# Learned now: two threads that met a type first, both at once, would crash msgspec (0.22).
msgspec.json.Decoder(tuple[Location, Clock])


# --- results -------------------------------------------------------------------------------------


def read_result(method: Method, result: Any) -> Any:
    """A result from the wire as the value that the table promises. Raises msgspec's
    `ValidationError` if it is no such value."""
    if method.returns is LOCATION:
        return msgspec.convert(result, Location)
    if method.returns is CLOCK:
        return msgspec.convert(result, Clock)
    return result


# --- sentences for what was wrong ----------------------------------------------------------------


def _does_not_fit(method: Method, positional: Sequence[Any], named: Mapping[str, Any]) -> str:
    known = list(dict.fromkeys(parameter.name for form in method.forms for parameter in form))
    strange = next((name for name in named if name not in known), None)
    if strange is not None and not method.extra:
        takes = f"; it takes {_listed(known)}." if known else "; it takes nothing."
        return f"{method.name} has no parameter {_shown(strange)}" + did_you_mean(
            strange, known, otherwise=takes
        )
    got = [*map(_shown, positional[:MOST_SHOWN]), *map(_cut, map(str, named))][:MOST_SHOWN]
    if len(positional) + len(named) > MOST_SHOWN:
        got.append(f"{len(positional) + len(named) - MOST_SHOWN} more")
    wanted = ", or ".join(_needed(form) for form in method.forms)
    return f"{method.name} needs {wanted}; got {_listed(got) if got else 'nothing'}."


def _needed(form: Form) -> str:
    required = [_with_article(parameter.name) for parameter in form if parameter.required]
    if required:
        return _listed(required)
    return f"at most {_listed([parameter.name for parameter in form])}" if form else "no parameters"


def _with_article(name: str) -> str:
    if len(name) == 1 or name.endswith("s"):
        return name
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name}"


def wrong_value(method: Method, parameter: Parameter, value: Any) -> str:
    """The sentence for a value that a parameter cannot have."""
    schema = parameter.kind.schema
    if isinstance(value, str) and len(value) > 200:
        got = f"a text of {len(value)} characters"
    else:
        got = _shown(value)
    if _has_pattern(schema):
        return f"{parameter.name} of {method.name} cannot be {got}. Expected: {parameter.doc}."
    return f"{parameter.name} of {method.name} must be {_expectation(schema)}; got {got}."


def _has_pattern(schema: Mapping[str, Any]) -> bool:
    return "pattern" in schema or any(map(_has_pattern, schema.get("anyOf", ())))


def _expectation(schema: Mapping[str, Any]) -> str:
    match schema:
        case {"anyOf": choices}:
            return " or ".join(
                _expectation(choice) for choice in choices if choice != {"type": "null"}
            )
        case {"type": "string", "minLength": least, "maxLength": most}:
            return f"a text of {least} to {most} characters"
        case {"type": "string", "maxLength": most}:
            return f"a text of at most {most} characters"
        case {"type": "number", "minimum": low, "maximum": high}:
            return f"a number from {low} to {high}"
        case {"type": "integer", "minimum": low, "maximum": high}:
            return f"a whole number from {low} to {high}"
        case {"type": "array", "minItems": least, "maxItems": most}:
            return f"a list of {least} to {most} texts"
        case {"enum": [*names, last]}:
            return " or ".join(filter(None, [", ".join(names), last]))
        case {"type": "object"}:
            return "a location with x and y"
    return "of another kind"


def _listed(words: Sequence[str]) -> str:
    return " and ".join(filter(None, [", ".join(words[:-1]), words[-1]]))


def _shown(value: Any) -> str:
    return _cut(repr(value))


def _cut(text: str) -> str:
    return text if len(text) <= 60 else text[:57] + "..."


def did_you_mean(name: str, known: Iterable[str], otherwise: str = ".") -> str:
    """How a sentence about an unknown name ends: with the nearest known one, if one is near."""
    near = difflib.get_close_matches(name[:100], list(known), n=1)
    return f"; did you mean {near[0]}?" if near else otherwise
