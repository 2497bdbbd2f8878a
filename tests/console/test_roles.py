"""Who may do what: every method of the wire and every page, for every role."""

from __future__ import annotations

import http.client
import time
from collections.abc import Iterator

import pytest

from nl2robot.fleet.key import make_key
from nl2robot.station.accounts import Accounts
from robot_api.client import Robot
from robot_api.errors import AccessDenied, RobotError
from robot_api.serving import roles
from robot_api.serving.roles import ROLES, Role
from tests.console.conftest import Look, Served, serving
from tests.console.test_looks import READY

FACE = {
    *("robot.stop", "robot.capabilities", "rpc.discover", "program.stop", "fleet.stop"),
    *("face.state", "face.site", "face.here", "face.touch", "face.page", "face.did"),
    *(
        "sentence.told",
        "face.language",
        "face.used",
        "call.ready",
        "call.answer",
        "call.end",
        "call.signal",
    ),
    *("schedule.buttons", "schedule.press"),
}
"""All that the tablet on the robot may call: visitors have their hands on it."""
OBSERVER = {
    *("robot.stop", "robot.capabilities", "rpc.discover", "program.stop"),
    *("face.state", "face.site", "sentence.told"),
    *("desk.run", "scene.floor", "zones.list", "zones.history", "places.list", "places.export"),
    *("location.history", "helm.state", "helm.body", "helm.log", "runs.list", "runs.show"),
    *("schedule.list", "schedule.week", "schedule.history", "schedule.notices"),
    *("schedule.reminders",),
    *("routines.list", "routines.show", "routines.export", "station.state"),
    *("program.phrases", "program.wait", "program.state", "program.list"),
    *("program.answer", "program.unfinished"),
    *("proposal.list", "proposal.show", "proposal.wait"),
    *("fleet.list", "fleet.plans", "fleet.fit", "fleet.wait", "fleet.stop"),
}
ASSISTANT = OBSERVER | {
    *("program.translate", "program.check", "proposal.make", "proposal.withdraw"),
}
PAGES = {
    "/": {"observer", "assistant", "operator", "administrator"},
    "/map": {"observer", "assistant", "operator", "administrator"},
    "/drive": {"observer", "assistant", "operator", "administrator"},
    "/runs": {"observer", "assistant", "operator", "administrator"},
    "/routines": {"observer", "assistant", "operator", "administrator"},
    "/schedule": {"observer", "assistant", "operator", "administrator"},
    "/fleet": {"observer", "assistant", "operator", "administrator"},
    "/devices": {"operator", "administrator"},
    "/face": set(ROLES),
    "/static/wire.js": set(ROLES),
    "/openrpc.json": set(ROLES),
    "/nothing/here": {"observer", "assistant", "operator", "administrator"},
}
OPEN = ("/healthz", "/sign-in", "/join/nonsense", "/trust", "/static/console.css")
"""What somebody gets to see whom nobody knows."""
NO_SUCH = {"no such parameter": 1}
"""Refused by every method that can be called at all: nothing is done."""


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    home = tmp_path_factory.mktemp("house")
    make_key(home / "fleet.key")
    with serving(home, "--host", "0.0.0.0", "--fleet", "ward a") as served:
        port = served.address.rpartition(":")[2]
        yield Served(f"127.0.0.1:{port}", served.process, home, served.said)


@pytest.fixture(scope="module")
def secrets(house: Served) -> Iterator[dict[Role, str]]:
    """What somebody in each role comes in by."""
    accounts = Accounts(house.home / "accounts.sqlite")
    accounts.add("Ann", "administrator", "correct horse battery")
    secrets: dict[Role, str] = {
        "administrator": accounts.sign_in("Ann", "correct horse battery", "", "") or "",
        **{role: accounts.join(accounts.invite(role, role, None)) or "" for role in roles.PAIRED},
        "assistant": accounts.let_in("assistant", "Sam", None),
    }
    # The server notices what another process has changed.
    ends = time.monotonic() + 30
    while status(house, "/static/wire.js", secrets["operator"])[0] != 200:
        assert time.monotonic() < ends
    yield secrets
    accounts.close()


def status(house: Served, path: str, secret: str | None) -> tuple[int, str]:
    """What a browser is answered that shows this secret, and where it is sent."""
    connection = http.client.HTTPConnection(house.address, timeout=60)
    port = house.address.rpartition(":")[2]
    cookie = {"Cookie": f"robot-{port}={secret}"} if secret else {}
    connection.request("GET", path, headers={"Accept": "text/html", **cookie})
    answer = connection.getresponse()
    answer.read()
    connection.close()
    return answer.status, answer.headers.get("Location", "")


def denied(robot: Robot, method: str) -> bool:
    try:
        robot.request(method, NO_SUCH)
    except AccessDenied:
        return True
    except RobotError:
        return False
    return False


@pytest.mark.parametrize("role", ROLES)
def test_every_method_is_for_whom_it_should_be(
    house: Served, secrets: dict[Role, str], role: Role
) -> None:
    with Robot(house.address, token=secrets[role]) as robot:
        described = robot.request("rpc.discover", {})
        methods = {method["name"] for method in described["methods"]} | {"rpc.discover"}
        assert {"devices.pair", "robot.move", "program.run", "voice.open"} <= methods
        allowed = {method for method in methods if not denied(robot, method)}
        kinds = sorted(kind.removeprefix("event.") for kind in described["x-events"])
        heard = set(robot.request("rpc.subscribe", {"events": ["*"]})) and {
            kind for kind in kinds if not _unheard(robot, kind)
        }
    of_everybody = {"rpc.cancel", "rpc.subscribe", "rpc.unsubscribe"}
    every = {"face": FACE, "observer": OBSERVER, "assistant": ASSISTANT}.get(
        role, methods
    ) | of_everybody
    assert allowed == every
    assert heard == ({*roles.TOLD_TO_FACES} & {*kinds} if role == "face" else {*kinds})


def _unheard(robot: Robot, kind: str) -> bool:
    try:
        robot.request("rpc.subscribe", {"events": [kind]})
    except RobotError:
        return True
    return False


def test_a_face_that_subscribes_to_all_is_told_no_more_than_it_may(
    house: Served, secrets: dict[Role, str]
) -> None:
    heard: list[str] = []
    with (
        Robot(house.address, token=secrets["face"]) as face,
        Robot(house.address, token=secrets["operator"]) as operator,
    ):
        face.subscribe("*", lambda kind, data: heard.append(kind))
        operator.say("A word to a patient.")
        operator.emotion("happy")
        face.stop()
    assert "face" in heard or "stopped" in heard
    assert {*heard} <= roles.TOLD_TO_FACES


@pytest.mark.parametrize("path", PAGES)
def test_every_page_is_for_whom_it_should_be(
    house: Served, secrets: dict[Role, str], path: str
) -> None:
    fine = 404 if path == "/nothing/here" else 200
    for role in ROLES:
        got, location = status(house, path, secrets[role])
        if role in PAGES[path]:
            assert (got, location) == (fine, ""), role
        elif role == "face":
            assert (got, location) == (303, "/face")
        else:
            assert got == 403, role
    assert status(house, path, None)[0] == 401
    assert status(house, path, "of another day")[0] == 401


@pytest.mark.parametrize("path", OPEN)
def test_what_is_open_is_seen_by_everybody(house: Served, path: str) -> None:
    assert status(house, path, None)[0] == (410 if path.startswith("/join") else 200)


def test_every_page_says_what_a_browser_may_do_with_it_and_works_so(
    look: Look, house: Served, secrets: dict[Role, str]
) -> None:
    port = house.address.rpartition(":")[2]
    page = look("/sign-in", url=house.url)
    kept = {"name": f"robot-{port}", "value": secrets["operator"], "url": house.url}
    page.context.add_cookies([kept])
    refused: list[str] = []
    page.on("console", lambda said: "Content Security" in said.text and refused.append(said.text))
    for path in (*READY, "/face", "/devices", "/sign-in", "/trust", "/nothing"):
        answer = page.goto(house.url + path)
        assert answer is not None
        headers = answer.headers
        assert "frame-ancestors" in headers["content-security-policy"], path
        assert "object-src 'none'" in headers["content-security-policy"], path
        assert headers["x-content-type-options"] == "nosniff", path
        assert headers["referrer-policy"] in ("same-origin", "no-referrer"), path
        assert headers["x-frame-options"] == "SAMEORIGIN", path
        assert headers["permissions-policy"].startswith("camera=(self)"), path
        page.locator(READY.get(path, "body")).first.wait_for()
    assert refused == []
