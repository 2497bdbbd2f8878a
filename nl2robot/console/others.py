"""The parts that other packages add to the console, kept from what is ours and from each other.

A part that cannot be made, or that would take a name or an address of somebody else's, is left out
with a sentence that says why. One that raises later is noted in the log, and disturbs nobody.
"""

from __future__ import annotations

import logging
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Final, ParamSpec

from starlette.routing import BaseRoute

from nl2robot.console.visitor import texts_of
from nl2robot.station.part import Backstage, Part
from nl2robot.texts import ENGLISH
from robot_api.errors import cause
from robot_api.plugins import PAGES, Plugin, PluginError, left_out, plugins
from robot_api.server import Service

OURS: Final = frozenset(
    {"authority", "devices", "face", "favicon", "healthz", "join", "map", "openrpc", "program"}
    | {"robot", "rpc", "run", "schema", "sign-in", "sign-out", "static", "stop", "trust", "voice"}
    | {"_nicegui"}
)
"""Names that the server and the door have taken, besides those of the parts."""

_NAME: Final = re.compile(r"[a-z][a-z0-9_]*")
_log = logging.getLogger(__name__)
_P = ParamSpec("_P")


@dataclass(frozen=True)
class Others:
    """What other packages add."""

    parts: Mapping[str, Part]
    troubles: Mapping[str, str]
    """By name, a sentence each: parts that are left out."""


def others(backstage: Backstage, ours: Iterable[Part]) -> Others:
    """The parts of other packages, made; `ours` have been made before."""
    taken = OURS | {name for part in ours for name in _taken(part)}
    found: dict[str, Part] = {}
    troubles = left_out(PAGES, taken)
    for name, plugin in plugins(PAGES, taken).items():
        try:
            found[name] = _made(plugin, backstage)
        except PluginError as error:
            troubles[name] = str(error)
    for trouble in troubles.values():
        _log.warning(trouble)
    return Others(found, troubles)


def _taken(part: Part) -> Iterator[str]:
    """The first words of all that a part of ours adds."""
    for name in (*part.services, *part.events):
        yield name.partition(".")[0]
    for route in part.routes:
        yield _first(_path(route))


def _first(path: str) -> str:
    return path.strip("/").partition("/")[0].partition(".")[0]


def _path(route: BaseRoute) -> str:
    return str(getattr(route, "path", "/"))


def _made(plugin: Plugin, backstage: Backstage) -> Part:
    make = plugin.load()
    try:
        part: Part = make(backstage)
    except (Exception, SystemExit) as error:
        raise plugin.broken(error) from error
    wrong = next(_wrong(part, plugin.name), None)
    if wrong is not None:
        raise plugin.unusable(wrong)
    return replace(
        part,
        pages=_pages(part, plugin),
        left=_safely(part.left, plugin.name),
        close=_safely(part.close, plugin.name),
    )


def _wrong(part: Any, name: str) -> Iterator[str]:
    """What a part must not be, as the end of a sentence."""
    if not isinstance(part, Part):
        yield f"is no Part: {type(part).__name__} is something else."
        return
    if not _NAME.fullmatch(name):
        yield "has a name that is no word of small letters, digits and underlines."
    for each in (*part.services, *part.events):
        if each.partition(".")[0] != name:
            yield f"adds {each!r}, which does not begin with {name!r}."
    for each, service in part.services.items():
        if not isinstance(service, Service):
            yield f"has a service {each!r} that is no robot_api.server.Service."
    for path in (*map(_path, part.routes), *(link.address for link in part.links)):
        if not is_below(path, name):
            yield f"adds the address {path!r}, which does not begin with '/{name}'."
    for link in part.links:
        try:
            assert "title" in texts_of(link.texts, ENGLISH), "no title"
        except Exception as error:  # noqa: BLE001 - what is in the file may be anything
            yield f"has texts that cannot be read ({type(error).__name__}: {cause(error)})."


def is_below(path: str, name: str) -> bool:
    """Whether an address is the part's own, or below it."""
    return path == f"/{name}" or path.startswith(f"/{name}/")


def _pages(part: Part, plugin: Plugin) -> Callable[[], None]:
    """Registers its pages; what stands elsewhere is taken away again."""

    def register() -> None:
        from nicegui import app

        routes = app.router.routes
        before = len(routes)
        _safely(part.pages, plugin.name)()
        for route in routes[before:]:
            if not is_below(_path(route), plugin.name):
                routes.remove(route)
                wrong = f"adds the page {_path(route)!r}, which does not begin with its name."
                _log.warning(str(plugin.unusable(wrong)))

    return register


def _safely(call: Callable[_P, None], name: str) -> Callable[_P, None]:
    def called(*arguments: _P.args, **named: _P.kwargs) -> None:
        try:
            call(*arguments, **named)
        except Exception:  # noqa: BLE001 - others' code may do anything
            _log.exception("the page %r of another package", name)

    return called
