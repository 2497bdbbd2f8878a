"""What stands around every page: navigation, STOP, language, look, the name of who operates.

@ui.page("/runs")
def runs() -> None:
    with frame(backstage, "runs") as visit:
        ui.label(visit.words["title"])
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from typing import Any, Final

import msgspec

from nl2robot.console.visitor import (
    LANGUAGES,
    LONGEST_NAME,
    Seat,
    Visitor,
    texts,
    texts_of,
    visitor_of,
)
from nl2robot.station.part import Backstage, Link

PAGES: Final = {
    "desk": ("/", "M4 5h16v11H9l-5 4z"),
    "map": ("/map", "M9 4 3 6.5v13L9 17l6 2.5 6-2.5V4l-6 2.5zM9 4v13M15 6.5v13"),
    "drive": ("/drive", "M12 3v18M3 12h18M12 3 9 6m3-3 3 3M12 21l-3-3m3 3 3-3M3 12l3-3m-3 3 3 3"),
    "routines": (
        "/routines",
        "M4 12a8 8 0 0 1 13.7-5.6L20 9M20 4v5h-5M20 12a8 8 0 0 1-13.7 5.6L4 15M4 20v-5h5",
    ),
    "schedule": ("/schedule", "M4 6h16v14H4zM4 10h16M8 3v4M16 3v4M12 13v3l2 1"),
    "runs": ("/runs", "M8 6h13M8 12h13M8 18h13M3.5 6h.01M3.5 12h.01M3.5 18h.01"),
    "fleet": (
        "/fleet",
        "M5 16h6v4H5zM13 16h6v4h-6zM9 6h6v4H9zM12 10v3M8 16v-3h8v3",
    ),
    "face": ("/face", "M4 4h16v16H4zM9 10h.01M15 10h.01M8.5 14.5c2 2 5 2 7 0"),
}
"""The pages, each with its address and the line of its icon, in a square of 24."""


@dataclass(frozen=True)
class Visit:
    """A page as one visitor sees it."""

    visitor: Visitor
    words: Mapping[str, str]
    """The texts of this page."""

    @property
    def language(self) -> str:
        return self.visitor.language

    @property
    def role(self) -> Seat:
        return self.visitor.seat

    @property
    def who(self) -> str:
        """The name that is noted with what they approve."""
        return self.visitor.name or texts("frame", self.language)["somebody"]

    def hand_over(self, data: Mapping[str, Any]) -> None:
        """Give data to the page's scripts, as `pageData` of `/static/page.js`; once a page."""
        from nicegui import ui

        about = {"language": self.language, "role": self.role, "who": self.who}
        ui.add_head_html(_data("page-data", {**about, **data}))


@contextmanager
def frame(backstage: Backstage, page: str) -> Iterator[Visit]:
    """Build a page inside; to be called in the function of a `ui.page`."""
    from nicegui import ui

    request = ui.context.client.request
    assert request is not None
    visitor = visitor_of(request)
    link = next((each for each in backstage.links if each.name == page), None)
    visit = Visit(visitor, _texts(page, link, visitor.language))
    words = texts("frame", visitor.language)
    name = _name(backstage, words)
    title = visit.words["title"] if link else words[page]
    ui.page_title(f"{title} · {name}")
    ui.dark_mode({"auto": None, "light": False, "dark": True}[visitor.look])
    ui.add_head_html(_head(visitor, words, name))
    ui.add_body_html(_header(page, name, visitor, words, backstage))
    with ui.element("div").props('id="main" tabindex="-1"').classes(f"page page-{page}"):
        if page not in (
            "runs",
            "routines",
            "schedule",
            "fleet",
        ):  # whose pages have headings of their own
            ui.html(f'<h1 class="sr">{escape(title)}</h1>', sanitize=False)
        yield visit


def _texts(page: str, link: Link | None, language: str) -> Mapping[str, str]:
    return texts_of(link.texts, language) if link else texts(page, language)


def _name(backstage: Backstage, words: Mapping[str, str]) -> str:
    """What the robot is called."""
    if backstage.simulation is not None:
        return words["simulated"]
    capabilities = backstage.runner.knowledge.capabilities
    return capabilities.name if capabilities else "nl2robot"


def _head(visitor: Visitor, words: Mapping[str, str], robot: str) -> str:
    about = {
        "look": visitor.look,
        "language": visitor.language,
        "words": words,
        "role": visitor.seat,
        "who": visitor.name or words["somebody"],
        "name": visitor.name,
        "robot": robot,
        "call": texts("call", visitor.language),
        "microphone": texts("microphone", visitor.language),
    }
    return (
        f"{_data('frame-data', about)}"
        '<script src="/static/look.js"></script>'
        '<link rel="stylesheet" href="/static/reset.css">'
        '<link rel="stylesheet" href="/static/console.css">'
        '<script type="module" src="/static/console.js"></script>'
    )


def _data(name: str, data: Mapping[str, Any]) -> str:
    # A text in it that says "</script>" must not end it.
    written = msgspec.json.encode(data).decode().replace("<", "\\u003c")
    return f'<script type="application/json" id="{name}">{written}</script>'


def _header(
    page: str, name: str, visitor: Visitor, words: Mapping[str, str], backstage: Backstage
) -> str:
    def said(key: str) -> str:
        return escape(words[key], quote=True)

    shown = [
        (key, address, line, words[key])
        for key, (address, line) in PAGES.items()
        if key != "fleet" or backstage.fleet is not None
    ]
    for link in backstage.links:
        title = texts_of(link.texts, visitor.language)["title"]
        shown.append((link.name, link.address, escape(link.icon, quote=True), title))
    links = "".join(
        f'<a href="{address}"{" aria-current=page" if key == page else ""}>{_icon(line)}'
        f"<span>{escape(title)}</span></a>"
        for key, address, line, title in shown
    )
    languages = "".join(
        f'<option value="{code}"{" selected" if code == visitor.language else ""}>{own}</option>'
        for code, own in LANGUAGES.items()
    )
    looks = "".join(
        f'<option value="{look}"{" selected" if look == visitor.look else ""}>{said(look)}</option>'
        for look in ("auto", "light", "dark")
    )
    hint = f'title="{said("observer_hint")}"'
    observer = "" if visitor.operates else f'<span class="chip" {hint}>{said("observer")}</span>'
    # The desk has a microphone of its own, beside the line to type in.
    microphone = (
        f'<button type="button" id="frame-microphone" class="icon-button"'
        f' aria-label="{said("hold_to_talk")}" title="{said("hold_to_talk")}"></button>'
        if visitor.operates and page != "desk"
        else ""
    )
    return f"""
<header class="frame">
  <button type="button" id="stop" class="stop" title="{said("stop_hint")}"
    aria-keyshortcuts="Escape Space">{said("stop")}</button>
  <a class="skip" href="#main">{said("skip")}</a>
  <a class="brand" href="/" aria-label="{escape(name, quote=True)}">
    <img src="/static/icon.svg" alt="" width="28" height="28">
    <span>{escape(name)}</span></a>
  <nav aria-label="{said("pages")}">{links}</nav>
  <span class="frame-tools">
    {observer}
    {microphone}
    <span id="robot-badge" class="chip" role="status" hidden></span>
    <span id="connection" role="status" data-state="waiting"><span class="sr">…</span></span>
    <button type="button" id="bell" class="icon-button" aria-haspopup="dialog"
      aria-label="{said("notices")}" title="{said("notices")}">{_icon(_BELL)}<span class="count"
      hidden></span></button>
    <button type="button" id="settings-button" class="icon-button" aria-haspopup="dialog"
      aria-label="{said("settings")}" title="{said("settings")}">{_icon(_GEAR)}</button>
  </span>
</header>
<div id="calls"></div>
<div id="proposals" role="status"></div>
<p id="robot-state" class="robot-state" role="alert" hidden></p>
<p id="notice" class="notice" role="alert" hidden></p>
<div id="toasts" role="status"></div>
<dialog id="notices" aria-label="{said("notices")}">
  <h2>{said("notices")}</h2>
  <ul tabindex="0"></ul>
  <form method="dialog" class="row">
    <a class="button" href="/schedule">{said("notices_all")}</a>
    <button class="button primary">{said("close")}</button>
  </form>
</dialog>
<dialog id="settings" aria-label="{said("settings")}">
  <form method="dialog">
    <h2>{said("settings")}</h2>
    <label>{said("language")}<select id="language" class="field">{languages}</select></label>
    <label>{said("look")}<select id="look" class="field">{looks}</select></label>
    {_who(visitor, words)}
    <button class="button primary">{said("close")}</button>
  </form>
  {_door(visitor, words) if backstage.entrance is not None else ""}
</dialog>
"""


def _who(visitor: Visitor, words: Mapping[str, str]) -> str:
    """Where people say who they are, unless that is known."""
    name = escape(visitor.name, quote=True)
    if visitor.signed_in:
        told = escape(words["signed_in"].format(name=visitor.name))
        return f'<p>{told}</p><input type="hidden" id="who" value="{name}">'
    hint = escape(words["who_hint"])
    return (
        f'<label>{escape(words["who"])}<input id="who" class="field" maxlength="{LONGEST_NAME}"'
        f' autocomplete="name" value="{name}"><small class="muted">{hint}</small></label>'
    )


def _door(visitor: Visitor, words: Mapping[str, str]) -> str:
    """The ways in and out."""
    devices = f'<a class="button" href="/devices">{escape(words["devices"])}</a>'
    out = f'<button class="button quiet">{escape(words["sign_out"])}</button>'
    return '<div class="row">{}{}</div>'.format(
        devices if visitor.operates else "",
        f'<form method="post" action="/sign-out">{out}</form>' if visitor.signed_in else "",
    )


_BELL: Final = "M6 16V11a6 6 0 0 1 12 0v5l2 2H4zM10 21h4"
_GEAR: Final = (
    "M4 7h9M17 7h3M4 17h3M11 17h9M15 7m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0"
    "M9 17m-2 0a2 2 0 1 0 4 0a2 2 0 1 0-4 0"
)


def _icon(line: str) -> str:
    return (
        '<svg viewBox="0 0 24 24" width="22" height="22" fill="none" stroke="currentColor"'
        ' stroke-width="1.8" stroke-linecap="round" stroke-linejoin="round" aria-hidden="true">'
        f'<path d="{line}"/></svg>'
    )
