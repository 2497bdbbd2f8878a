"""A page of HTML without a browser: enough to click, to type and to read in tests and simulations.

No script runs and nothing is fetched. Real CSS selectors work, so that a program that finds its
elements here finds them on a robot's tablet too.
"""

from __future__ import annotations

import functools
import re
from typing import TYPE_CHECKING, Final

from robot_api.errors import InvalidCall, NotFound
from robot_api.methods import MAX_TEXT

if TYPE_CHECKING:
    from bs4 import BeautifulSoup, Tag

_COMMENT: Final = re.compile(r"<!--.*?(?:-->|\Z)", re.DOTALL)

_NO_TEXT = ("button", "submit", "checkbox", "radio", "reset", "image", "hidden", "file")
"""Kinds of `input` that cannot be typed into."""


class Page:
    """The page that the screen shows. It is read only when something is done on it: to show it, a
    browser need not understand it."""

    def __init__(self, html: str) -> None:
        self._shown = html

    @functools.cached_property
    def _soup(self) -> BeautifulSoup:
        """Raises `InvalidCall` for what is no HTML."""
        from bs4 import BeautifulSoup
        from bs4.exceptions import ParserRejectedMarkup

        # Python's parser takes quadratic time for comments that do not end.
        seen = _COMMENT.sub("", self._shown)
        try:
            return BeautifulSoup(seen, "html.parser")
        except (ParserRejectedMarkup, ValueError, AssertionError):
            raise InvalidCall(
                "The page on the screen is no HTML that can be read. Show another one."
            ) from None

    @property
    def html(self) -> str:
        """The page as it is now."""
        read = "_soup" in self.__dict__
        return str(self._soup) if read else self._shown

    def click(self, selector: str) -> None:
        """Click on the first such element: ticks boxes, picks options, opens details."""
        element = self._find(selector)
        kind = str(element.get("type", "")).lower()
        if element.name == "input" and kind == "checkbox":
            _set(element, "checked", "checked" not in element.attrs)
        elif element.name == "input" and kind == "radio":
            group = element.get("name")
            for other in self._soup.select('input[type="radio"]'):
                if group and other.get("name") == group:
                    _set(other, "checked", False)
            _set(element, "checked", True)
        elif element.name == "option":
            choice = element.find_parent("select")
            for other in choice.select("option") if choice else ():
                _set(other, "selected", False)
            _set(element, "selected", True)
        elif element.name == "summary" and element.parent is not None:
            _set(element.parent, "open", "open" not in element.parent.attrs)

    def type_text(self, selector: str, text: str) -> None:
        """Put the text into the field in place of what was in it."""
        element = self._find(selector)
        kind = str(element.get("type", "text")).lower()
        if element.name == "textarea":
            element.string = text
        elif element.name == "input" and kind not in _NO_TEXT:
            element["value"] = text
        else:
            raise NotFound(
                f"'{selector}' on the page is not a field to type into. Choose an input field."
            )

    def read_text(self, selector: str) -> str:
        """The text of the first such element, or what a field holds."""
        element = self._find(selector)
        if element.name == "input":
            text = str(element.get("value", ""))
        elif element.name == "select":
            chosen = element.select_one("option[selected]") or element.select_one("option")
            text = chosen.get_text(" ") if chosen else ""
        else:
            text = element.get_text() if element.name == "textarea" else element.get_text(" ")
        return " ".join(text.split())[:MAX_TEXT]

    def _find(self, selector: str) -> Tag:
        from soupsieve import SelectorSyntaxError

        try:
            element = self._soup.select_one(selector)
        except (SelectorSyntaxError, NotImplementedError):
            raise InvalidCall(
                f"'{selector}' is not a CSS selector. Write one such as '#name' or 'button.yes'."
            ) from None
        if element is None:
            raise NotFound(
                f"There is no '{selector}' on the page on the screen. Look at what the page has."
            )
        return element


def _set(element: Tag, attribute: str, present: bool) -> None:
    if present:
        element[attribute] = ""
    else:
        element.attrs.pop(attribute, None)
