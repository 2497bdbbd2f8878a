"""The reference page in the docs is the method table, as it stands."""

from robot_api.driver import EVENTS
from robot_api.methods import METHODS
from robot_api.reference import PAGE, reference


def test_the_page_in_the_docs_is_up_to_date() -> None:
    page = PAGE.read_text(encoding="utf-8")
    assert page == reference(), "run: python -m robot_api.reference --write"


def test_every_method_parameter_error_and_event_is_on_the_page() -> None:
    page = reference()
    for method in METHODS.values():
        assert f"### `{method.name}`" in page
        assert all(parameter.doc in page for form in method.forms for parameter in form)
        assert all(f"`{error}`" in page for error in method.errors)
    assert all(f"`event.{kind}`" in page for kind in EVENTS)
    for number in range(1, 17):
        assert f"[{number}]" in page
        assert f"\n| {number} | `" in page, "in the message style too"
