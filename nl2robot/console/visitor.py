"""Who looks at a page: their language, their name, what they may do; and the page's texts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final, Literal
from urllib.parse import unquote

import yaml
from starlette.requests import HTTPConnection

from grammar.language import languages
from grammar.languages import registry
from nl2robot.texts import CONSOLE, brought
from robot_api.capabilities.languages import language_data
from robot_api.serving.access import Guest

LANGUAGES: Final = {
    code: language_data(code).own_name or code for code in registry.codes() if code in languages()
}
"""What the pages can be seen in, each with what it calls itself."""
LONGEST_NAME: Final = 60

Look = Literal["auto", "light", "dark"]
Seat = Literal["face", "observer", "operator"]
"""As what somebody sits before a page: an administrator does there what operators do."""


@dataclass(frozen=True)
class Visitor:
    """What a request says of who sent it."""

    language: str
    look: Look
    guest: Guest | None
    """As whom they were let in; None on the pages that anybody may see."""
    name: str
    """Who they are, if they have signed in, else what they call themselves; empty if they did not
    say."""

    @property
    def seat(self) -> Seat:
        role = self.guest.role if self.guest else "observer"
        match role:
            case "administrator":
                return "operator"
            case "assistant":  # what it may do besides, it does on the wire
                return "observer"
            case _:
                return role

    @property
    def operates(self) -> bool:
        return self.seat == "operator"

    @property
    def signed_in(self) -> bool:
        return self.guest is not None and self.guest.name is not None


def visitor_of(request: HTTPConnection) -> Visitor:
    """Who sent this request; cookies of the page (`static/page.js`) say what was chosen."""
    cookies = request.cookies
    look = cookies.get("look", "auto")
    guest: Guest | None = getattr(request.state, "guest", None)
    signed_in = guest.name if guest else None
    return Visitor(
        language=_language(request),
        look=look if look in ("light", "dark") else "auto",  # type: ignore[arg-type]
        guest=guest,
        name=signed_in or unquote(cookies.get("who", ""))[:LONGEST_NAME].strip(),
    )


def _language(request: HTTPConnection) -> str:
    """The one chosen, else the first that the browser prefers and we speak."""
    chosen = request.cookies.get("language", "")
    if chosen in LANGUAGES:
        return chosen
    for wanted in request.headers.get("accept-language", "").split(","):
        code = wanted.strip()[:2].lower()
        if code in LANGUAGES:
            return code
    return "en"


def texts(page: str, language: str) -> Mapping[str, str]:
    """The texts of a page in a language; in English what a language that somebody added has none
    for."""
    return texts_of(CONSOLE / f"{page}.yaml", language)


@cache
def texts_of(file: Path, language: str) -> Mapping[str, str]:
    """The same of a page whose texts are in this file."""
    said: dict[str, Any] = yaml.safe_load(file.read_text(encoding="utf-8"))
    theirs = brought(language, f"console/{file.stem}") if file.parent == CONSOLE else {}
    return {key: ways.get(language) or theirs.get(key, ways["en"]) for key, ways in said.items()}
