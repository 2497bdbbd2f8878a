"""The console's templates, filled at the server, and how numbers and times are written in them."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime
from functools import cache
from typing import Any
from urllib.parse import quote

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup

from nl2robot.plain import visible


def duration(seconds: float) -> str:
    """ "42 s", "1:42 min", "2:05 h"."""
    whole = max(0, round(seconds))
    if whole < 60:
        return f"{whole} s"
    if whole < 3600:
        return f"{whole // 60}:{whole % 60:02} min"
    return f"{whole // 3600}:{whole // 60 % 60:02} h"


def clock(seconds: float) -> str:
    """ "1:05", minutes and seconds of a run."""
    whole = max(0, int(seconds))
    return f"{whole // 60}:{whole % 60:02}"


def _when(seconds: float, words: Mapping[str, str]) -> str:
    return datetime.fromtimestamp(seconds).strftime(words["when"])


def _iso(seconds: float) -> str:
    return datetime.fromtimestamp(seconds).astimezone().isoformat(timespec="seconds")


def _visible(text: str) -> str | Markup:
    return text if isinstance(text, Markup) else visible(text)


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=PackageLoader("nl2robot.console"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "visible": _visible,
        "when": _when,
        "iso": _iso,
        "duration": duration,
        "clock": clock,
        "encoded": lambda text: quote(text, safe=""),
    }
    return environment


def rendered(template: str, **about: Any) -> str:
    """A template of `templates/`; what is put in is escaped unless it is `Markup`."""
    return _environment().get_template(template).render(**about)
