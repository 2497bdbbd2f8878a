"""The method table is the contract: everything else is made from it."""

import jsonschema
import pytest

from robot_api import errors
from robot_api.methods import METHODS

PAPER_FUNCTIONS = set(range(1, 17))


def test_every_function_of_the_paper_has_a_method() -> None:
    assert {m.paper for m in METHODS.values() if m.paper} == PAPER_FUNCTIONS


@pytest.mark.parametrize("method", METHODS.values(), ids=METHODS.keys())
def test_a_row_of_the_table_is_well_formed(method) -> None:
    assert method.doc.endswith(".")
    for name in method.errors:
        assert issubclass(errors.error_named(name), errors.RobotError)
        assert errors.error_named(name).__name__ == name
    for form in method.forms:
        optional_seen = False
        for parameter in form:
            jsonschema.Draft202012Validator.check_schema(parameter.kind.schema)
            assert not (optional_seen and parameter.required), "required after optional"
            optional_seen |= not parameter.required
            if not parameter.required:
                jsonschema.validate(parameter.default, parameter.kind.schema)


def test_a_stop_cannot_be_swallowed_by_a_program() -> None:
    assert not issubclass(errors.Stopped, Exception)
