"""The robot's face: the page for the tablet on the robot, at `/face`.

It shows how the robot feels and what its screen shows, and what people touch and type there reaches
the program (`tablet`); from there people talk to an operator (`video`). It is a plain page, for a
tablet may be slow: what it is to show is in it when it comes; the event "face" tells of changes.
"""

from __future__ import annotations

import threading
from collections.abc import Mapping
from pathlib import Path
from string import Template
from typing import Any, Final, TypedDict

import msgspec
from starlette.requests import Request
from starlette.responses import HTMLResponse
from starlette.routing import Route

from nl2robot.console.face import video
from nl2robot.console.face.choices import called, language_of_program
from nl2robot.console.face.forgetting import Forgetting
from nl2robot.console.face.sites import Answer, lets_itself_be_framed
from nl2robot.console.face.tablet import FaceTablet
from nl2robot.console.face.visitor_language import VisitorLanguage
from nl2robot.console.visitor import LANGUAGES, texts, visitor_of
from nl2robot.run.runlog import LogError
from nl2robot.run.state import Phase
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import an_object, schema_of
from robot_api.driver import Event, StopFlag
from robot_api.drivers import ComposedDriver
from robot_api.errors import NotPossible
from robot_api.methods import MAX_TEXT
from robot_api.server import Context, Service

PAGE: Final = Path(__file__).parents[1] / "templates" / "face.html"
LONGEST_PAGE: Final = 100_000
"""Of HTML, in characters, as for `show`."""

SEARCHING: Final = ("find", "wait_for", "sees", "count", "objects", "people", "describe", "scan")
"""The calls during which the robot looks as if it thought."""

EVENTS: Final = {
    "face": "version and what has changed of: language, chosen (whether a visitor has chosen it),"
    " emotion, mood (thinking | null), screen, asking (number, question, options, person, called:"
    " the options in each language, language: of the program, or null), speech, robot (the state,"
    " as of the event `state`), stopped, unconfirmed (whether the last stop was not confirmed),"
    " lost (since when the robot is, or null); as `face.state` tells all of it",
    "face.act": "number, act (click | type), selector, text: what this face is to do to its page",
}

HEADERS: Final = {
    # The pages that the robot shows stand in frames, which are bound by this as well.
    "Content-Security-Policy": (
        "default-src 'self'; script-src 'self' 'unsafe-inline'; style-src 'self' 'unsafe-inline';"
        " img-src * data: blob:; media-src * data: blob:; font-src * data:; frame-src *;"
        " connect-src 'self' ws: wss:; object-src 'none'; base-uri 'none'; form-action 'none';"
        " frame-ancestors 'self'"
    ),
    "Permissions-Policy": "camera=(self), microphone=(self), geolocation=()",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}


class FaceState(TypedDict):
    """What a face shows, as the event `face` says."""

    version: int
    language: str
    chosen: bool
    emotion: str
    mood: str | None
    screen: dict[str, Any]
    asking: dict[str, Any] | None
    speech: dict[str, Any] | None
    robot: Phase
    stopped: int | None
    unconfirmed: bool
    lost: float | None


class FaceHere(FaceState):
    """The same, and the face's own name."""

    name: str


class Face:
    """What all the faces show."""

    def __init__(self, backstage: Backstage) -> None:
        self._backstage = backstage
        self._lock = threading.Lock()  # for what follows
        self._state = _at_the_start(backstage)

    @property
    def state(self) -> dict[str, Any]:
        with self._lock:
            return dict(self._state)

    def change(self, name: str, value: Any) -> None:
        """Show something else from now on, on all faces."""
        with self._lock:
            version = self._state["version"] + 1
            self._state |= {name: value, "version": version}
            # Within the lock, so that changes arrive in their order.
            self._backstage.publish("face", {"version": version, name: value})

    def on_event(self, kind: str, data: Event) -> None:
        """What the robot does, or a program, and the face shows."""
        match kind:
            case "emotion":
                self.change("emotion", data["name"])
            case "language":
                self.change("language", data["code"])
            case "speech":
                self.change("speech", {**data, "number": self.state["version"]})
            case "state":
                self._stands(data)
            case "program" if data["what"] == "call":
                self._thinks(data["method"] in SEARCHING)
            case "program" if data["what"] in ("result", "state"):
                self._thinks(False)

    def _stands(self, now: Event) -> None:
        """How the robot stands, as everybody is told."""
        before = self.state
        for name, value in (
            ("unconfirmed", now["unconfirmed"]),
            ("lost", now["lost_since"]),
            ("robot", now["state"]),
        ):
            if before[name] != value:
                self.change(name, value)
        if now["state"] == "stopped" != before["robot"]:
            self.change("stopped", self.state["version"])
        if now["state"] == "stopping":
            self._thinks(False)

    def _thinks(self, thinking: bool) -> None:
        mood = "thinking" if thinking else None
        if self.state["mood"] != mood:
            self.change("mood", mood)


def part(backstage: Backstage) -> Part:
    face = Face(backstage)
    calls = video.Calls(backstage.publish)
    runner = backstage.runner
    tablet = FaceTablet(
        backstage.publish,
        face.change,
        calls,
        face.state["screen"],
        called=lambda options, code: called(options, runner.knowledge.world, code),
        speaks=lambda: language_of_program(runner),
    )
    if isinstance(backstage.driver, ComposedDriver):
        backstage.driver.attach(tablet)

    def set_language(code: str, theirs: bool) -> None:
        backstage.driver.call("set_language", {"code": code}, StopFlag())
        face.change("chosen", theirs)

    theirs = VisitorLanguage(set_language)
    forgetting = Forgetting(
        backstage.driver,
        hush=lambda: face.change("speech", None),
        typed=lambda: tablet.typed,
        fresh=lambda: tablet.fresh,
    )

    def on_event(kind: str, data: Event) -> None:
        if kind == "screen":
            tablet.shown(data)
        else:
            face.on_event(kind, data)
        if kind == "program":
            forgetting.on_event(data)
            theirs.on_event(data)

    def left(connection: str) -> None:
        calls.left(connection)
        tablet.left(connection)

    spoken = backstage.driver.capabilities().languages
    languages = {code: name for code, name in LANGUAGES.items() if code in spoken}
    unsubscribe = backstage.subscribe(on_event)

    def close() -> None:
        unsubscribe()
        forgetting.close()
        theirs.close()
        calls.close()

    async def page(request: Request) -> HTMLResponse:
        seat = visitor_of(request).seat
        return HTMLResponse(_page(face.state, seat, languages), headers=HEADERS)

    return Part(
        services={**_services(backstage, face, tablet, forgetting, theirs), **calls.services()},
        events={**EVENTS, **video.EVENTS},
        routes=[Route("/face", page)],
        left=left,
        close=close,
    )


def _services(
    backstage: Backstage,
    face: Face,
    tablet: FaceTablet,
    forgetting: Forgetting,
    theirs: VisitorLanguage,
) -> dict[str, Service]:
    number = {"type": "integer", "minimum": 1}
    html = {"type": ["string", "null"], "maxLength": LONGEST_PAGE}

    def here(p: Mapping[str, Any], context: Context) -> dict[str, Any]:
        tablet.came(context.connection, p["visible"])
        return {**face.state, "name": context.connection}

    def touched(p: Mapping[str, Any], context: Context) -> bool:
        forgetting.noticed()
        return tablet.touched(context.connection, p["number"], p["answer"])

    def told(p: Mapping[str, Any], context: Context) -> None:
        forgetting.noticed()
        tablet.told(context.connection, p["page"], p["html"])

    def language(p: Mapping[str, Any], context: Context) -> None:
        theirs.choose(p["code"], before=face.state["language"])

    return {
        "face.state": Service(
            lambda p, context: face.state,
            an_object({}, ""),
            "Tell what the robot's face shows.",
            right="know",
            result=schema_of(FaceState),
        ),
        "face.here": Service(
            here,
            an_object({"visible": {"type": "boolean"}}, "visible"),
            "Be a face of the robot: people may touch it. Tells what to show, and its own name.",
            right="face",
            result=schema_of(FaceHere),
        ),
        "face.touch": Service(
            touched,
            an_object(
                {
                    "number": number,
                    "answer": {"type": "string", "minLength": 1, "maxLength": MAX_TEXT},
                },
                "number answer",
            ),
            "Answer what is asked on the screen; the result says whether nobody was faster.",
            right="face",
            result=schema_of(bool),
        ),
        "face.stand_in": Service(
            lambda p, context: _stood_in(backstage, tablet, p, context),
            an_object(
                {
                    "number": number,
                    "answer": {"type": "string", "minLength": 1, "maxLength": MAX_TEXT},
                    "who": {"type": "string", "maxLength": 200},
                    "language": {"enum": list(LANGUAGES)},
                },
                "number answer who",
            ),
            "Answer, from the desk, for whoever is asked and is silent or not there; the run's log"
            " says so, with `who`. The result says whether nobody was faster.",
            result=schema_of(bool),
        ),
        "face.page": Service(
            told,
            an_object(
                {"page": {"type": "integer"}, "html": {**html, "type": "string"}}, "page html"
            ),
            "Tell what people have made of the page of HTML that is shown.",
            right="face",
            result=schema_of(None),
        ),
        "face.did": Service(
            lambda p, context: tablet.did(context.connection, p["number"], p["html"]),
            an_object({"number": number, "html": html}, "number html"),
            'Tell how the page is after a "face.act"; null if it could not be done.',
            right="face",
            result=schema_of(None),
        ),
        "face.used": Service(
            lambda p, context: forgetting.noticed(),
            an_object({}, ""),
            "Tell that somebody touches the web page that is shown, which tells nothing itself.",
            right="face",
            result=schema_of(None),
        ),
        "face.language": Service(
            language,
            an_object({"code": {"enum": list(LANGUAGES)}}, "code"),
            "Let the robot speak and hear this language from now on.",
            right="face",
            result=schema_of(None),
        ),
        "face.site": Service(
            lambda p, context: _shows_in_frames(face.state["screen"].get("url")),
            an_object({}, ""),
            "Tell whether the web page at the address that is shown lets itself be shown here:"
            " yes, refuses or away.",
            right="know",
            result=schema_of(Answer),
        ),
    }


def _stood_in(
    backstage: Backstage, tablet: FaceTablet, p: Mapping[str, Any], context: Context
) -> bool:
    """The answer of somebody at the desk; the log says whose. Raises `NotPossible`."""
    run = backstage.runner.state()  # before: with the answer a program may be over
    first = tablet.touched(context.connection, p["number"], p["answer"])
    if first and run is not None:
        words = texts("desk", p.get("language", "en"))
        who = p["who"].strip() or words["somebody"]
        said = words["answered_for"].format(who=who, answer=p["answer"])
        try:
            backstage.runner.log.printed(run.run, said)
        except LogError as error:
            raise NotPossible(str(error)) from error
    return first


def _at_the_start(backstage: Backstage) -> dict[str, Any]:
    robot = backstage.simulation.robot if backstage.simulation is not None else None
    screen = (robot.screen if robot else None) or {"text": ""}
    return {
        "version": 1,
        "language": robot.language if robot else "en",
        "chosen": False,
        "emotion": robot.emotion if robot else "neutral",
        "mood": None,
        "screen": {**screen, "number": 0, "page": 0, "by": None},
        "asking": None,
        "speech": None,
        "robot": "idle",
        "stopped": None,
        "unconfirmed": False,
        "lost": None,
    }


def _page(state: Mapping[str, Any], role: str, languages: Mapping[str, str]) -> str:
    words = {code: dict(texts("face", code)) | dict(texts("call", code)) for code in LANGUAGES}
    data = {"state": state, "role": role, "languages": languages, "words": words}
    # A text in it that says "</script>" must not end it.
    written = msgspec.json.encode(data).decode().replace("<", "\\u003c")
    said = words.get(state["language"], words["en"])
    return Template(PAGE.read_text(encoding="utf-8")).substitute(
        language=state["language"], title=said["title"], stop=said["stop"], data=written
    )


def _shows_in_frames(url: str | None) -> Answer:
    return "yes" if url is None else lets_itself_be_framed(url)
