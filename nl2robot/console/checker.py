"""Whether a page that another package adds keeps to what is promised (`nl2robot.station.part`).

    for trouble in check_page("visits"):
        print(trouble)

It is looked at in a console of its own, with a simulated robot; once in a process, as any console.
"""

from __future__ import annotations

import re
import tempfile
import threading
import urllib.error
import urllib.request
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from string import Formatter
from typing import Any, Final

import yaml
from jsonschema import Draft202012Validator
from jsonschema.exceptions import SchemaError

from grammar.languages import registry
from nl2robot.console.app import Console
from nl2robot.errors import UserError
from nl2robot.run.runlog import RunLog
from nl2robot.station.part import Backstage, Link, Part
from nl2robot.station.station import simulated_station
from robot_api.errors import cause
from robot_api.plugins import PAGES, plugins
from robot_api.server import Service
from sim.world.loading import load_world

CLOSES_WITHIN: Final = 5.0
"""Seconds."""
ANSWERS_WITHIN: Final = 20.0
"""Seconds for a page, the first time."""
WORLD: Final = "ward"

_LOADED: Final = re.compile(
    r"<(?:script|link|img|iframe)\b[^>]*?\b(?:src|href)=[\"']([^\"']+)", re.I
)
_ELSEWHERE: Final = re.compile(r"(?:[a-z]+:)?//", re.I)


def check_page(name: str) -> list[str]:
    """A sentence for each thing that is wrong with what a package adds under this name. Raises
    `UserError` if there is no such page."""
    known = plugins(PAGES)
    if name not in known:
        there = f"There are: {', '.join(known)}." if known else "No package adds any."
        raise UserError(f"There is no page {name!r} of another package. {there}")
    made: list[Console] = []

    def console(backstage: Backstage) -> Console:
        made.append(Console(backstage))
        return made[0]

    with tempfile.TemporaryDirectory() as folder:
        log = RunLog(Path(folder) / "runs.sqlite")
        with simulated_station(load_world(WORLD), log, console=console) as station:
            found = made[0].others
            if name in found.troubles:
                return [found.troubles[name]]
            part = found.parts[name]
            troubles = list(_troubles(part, f"http://{station.address}"))
            # It is closed here, where it can be waited for, and not once more with the others.
            at = made[0].parts.index(part)
            made[0].parts[at] = replace(part, close=lambda: None)
            troubles += _closed(part)
    return troubles


def _troubles(part: Part, address: str) -> Iterator[str]:
    for name, service in part.services.items():
        yield from _of_service(name, service)
    for name, about in part.events.items():
        if not about.strip():
            yield f"The event {name!r} does not say what its data is."
    if not part.links:
        yield "No link leads to it: people have to know its address."
    for link in part.links:
        yield from _of_texts(link)
        for language in registry.ours():
            yield from _of_page(f"{address}{link.address}", link, language)


def _of_service(name: str, service: Service) -> Iterator[str]:
    if not service.doc.strip():
        yield f"The service {name!r} does not say what it does."
    try:
        Draft202012Validator.check_schema(service.params)
    except SchemaError as error:
        yield f"The schema of what {name!r} takes is none: {error.message}."
        return
    if service.params.get("type") != "object" or service.params.get("additionalProperties", True):
        yield f"The service {name!r} takes anything: name its params (nl2robot.wire.service)."


def _of_texts(link: Link) -> Iterator[str]:
    said: Mapping[str, Any] = yaml.safe_load(link.texts.read_text(encoding="utf-8"))
    for name, ways in said.items():
        missing = [code for code in registry.ours() if not ways.get(code)]
        if missing:
            yield f"The text {name!r} of {link.name!r} is missing in: {', '.join(missing)}."
        elif len({frozenset(_gaps(ways[code])) for code in registry.ours()}) > 1:
            yield f"The text {name!r} of {link.name!r} has other gaps in one language."


def _gaps(text: str) -> set[str]:
    return {name for _, name, _, _ in Formatter().parse(str(text)) if name}


def _of_page(url: str, link: Link, language: str) -> Iterator[str]:
    request = urllib.request.Request(url, headers={"Accept-Language": language})
    try:
        with urllib.request.urlopen(request, timeout=ANSWERS_WITHIN) as answer:
            html = answer.read().decode("utf-8", errors="replace")
    except urllib.error.HTTPError as error:
        yield f"{link.address} answers {error.code} in the language {language!r}."
        return
    except OSError as error:
        yield f"{link.address} does not answer ({cause(error)})."
        return
    for loaded in dict.fromkeys(_LOADED.findall(html)):
        if _ELSEWHERE.match(loaded):
            yield f"{link.address} loads {loaded} from elsewhere: ship it with the package."


def _closed(part: Part) -> list[str]:
    closing = threading.Thread(target=part.close, name="closing a page", daemon=True)
    closing.start()
    closing.join(CLOSES_WITHIN)
    if closing.is_alive():
        return [f"It has not closed {CLOSES_WITHIN:g} s after it was told to."]
    return []
