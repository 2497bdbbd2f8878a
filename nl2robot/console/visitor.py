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

from robot_api.access import Role

LANGUAGES: Final = {"en": "English", "de": "Deutsch", "fr": "Français"}
TEXTS: Final = Path(__file__).parent / "texts"
LONGEST_NAME: Final = 60

Look = Literal["auto", "light", "dark"]


@dataclass(frozen=True)
class Visitor:
    """What a request says of who sent it."""

    language: str
    look: Look
    role: Role
    name: str
    """What they call themselves; empty if they did not say."""

    @property
    def operates(self) -> bool:
        return self.role == "operator"


def visitor_of(request: HTTPConnection) -> Visitor:
    """Who sent this request; cookies of the page (`static/page.js`) say what was chosen."""
    cookies = request.cookies
    look = cookies.get("look", "auto")
    return Visitor(
        language=_language(request),
        look=look if look in ("light", "dark") else "auto",  # type: ignore[arg-type]
        role=getattr(request.state, "role", "observer"),
        name=unquote(cookies.get("who", ""))[:LONGEST_NAME].strip(),
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


@cache
def texts(page: str, language: str) -> Mapping[str, str]:
    """The texts of a page in a language."""
    file = TEXTS / f"{page}.yaml"
    said: dict[str, Any] = yaml.safe_load(file.read_text(encoding="utf-8"))
    return {key: ways[language] for key, ways in said.items()}
