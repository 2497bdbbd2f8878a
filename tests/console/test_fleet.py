"""The page of the fleet: what one robot's console knows of the others, and what it does not."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from nl2robot.fleet.key import make_key
from tests.console.conftest import Look, Picture, Served, serving
from tests.console.test_desk import say
from tests.console.test_looks import CONTRAST, STICKS_OUT, nameless


def endpoint() -> str:
    with socket.create_server(("127.0.0.1", 0)) as found:
        return f"tcp/127.0.0.1:{found.getsockname()[1]}"


def home_of(folder: Path, name: str, key: Path | None = None) -> Path:
    home = folder / name
    home.mkdir()
    if key is None:
        make_key(home / "fleet.key")
    else:
        (home / "fleet.key").write_bytes(key.read_bytes())
        (home / "fleet.key").chmod(0o600)
    return home


@pytest.fixture(scope="module")
def meets() -> str:
    return endpoint()


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory, meets: str) -> Iterator[Served]:
    """Ada, at whose console somebody is."""
    home = home_of(tmp_path_factory.mktemp("fleet"), "Ada")
    joined = ("--fleet", "Ada", "--fleet-listen", meets)
    with serving(home, "--speed", "10", *joined) as served:
        yield served


@pytest.fixture(scope="module")
def ben(served: Served, meets: str) -> Iterator[Served]:
    home = home_of(served.home.parent, "Ben", served.home / "fleet.key")
    with serving(home, "--speed", "10", "--fleet", f"Ben@{meets}") as ben:
        with ben.robot() as robot:
            robot.goto("pharmacy")
        yield ben


def fleet(look: Look, **more: object) -> Page:
    page = look("/fleet", **more)
    expect(page.locator("#fleet")).to_have_attribute("data-ready", "yes")
    return page


def test_both_are_on_one_map_and_the_nearest_does_what_was_approved(
    look: Look, served: Served, ben: Served, picture: Picture
) -> None:
    page = fleet(look)
    card = page.locator(".robot.card", has_text="Ben")
    expect(card).to_contain_text("pharmacy")
    expect(page.locator(".floor .robot")).to_have_count(2)
    expect(page.locator("svg.floor")).to_have_attribute(
        "aria-label", "Robots on this map: Ada, Ben"
    )
    page.locator("#fleet-sentence").fill("go to the pharmacy and say good morning")
    page.get_by_role("button", name="Look at it").click()
    expect(page.locator(".fleet-review pre")).to_contain_text('robot.goto("pharmacy")')
    expect(page.locator("#fleet-rehearsed")).to_contain_text("Tried on Ada, where it stands.")
    picture(page, "fleet")
    page.get_by_role("button", name="Approve, for the best robot").click()
    expect(page.locator(".errand").first).to_contain_text("Done by Ben")
    with ben.robot() as robot:
        [run] = robot.request("program.list", {"last": 1})
    assert run["approved_by"].endswith("(fleet, from Ada)")
    page.get_by_role("button", name="STOP ALL").click()
    expect(page.locator(".fleet-told")).to_contain_text("Ada stands.")
    expect(page.locator(".fleet-told")).to_contain_text("Ben stands.")
    expect(card).to_contain_text("Stopped")


def test_an_appointment_for_the_best_of_the_fleet_is_seen_at_both_consoles(
    look: Look, served: Served, ben: Served, picture: Picture
) -> None:
    page = look("/")
    say(page, "go to the pharmacy and say good morning")
    page.get_by_role("button", name="Later …").click()
    form = page.locator("dialog.times-form")
    form.locator("select[name=robot]").select_option("any")
    form.locator("input[type=time]:enabled").fill("11:00")
    form.get_by_role("button", name="Approve for these times").click()
    expect(form).to_have_count(0)
    page.goto(served.url + "/schedule")
    expect(page.locator(".appointment.card")).to_contain_text("any of the fleet; this one keeps it")
    page = fleet(look)
    expect(page.locator(".plan")).to_contain_text("go to the pharmacy")
    page = fleet(look, url=ben.url, width=390, height=844, language="de", dark=True)
    plan = page.locator(".plan")
    expect(plan).to_contain_text("Geführt von Ada")
    expect(plan).to_contain_text("jeden Tag um")
    plan.scroll_into_view_if_needed()
    picture(page, "fleet-plans")
    page.goto(ben.url + "/schedule")
    expect(page.locator(".of-fleet .plan")).to_contain_text("Geführt von Ada")
    with served.robot() as robot:
        robot.request("schedule.remove", {"id": 1})
    expect(page.locator(".of-fleet .plan")).to_have_count(0)


@pytest.mark.parametrize(("language", "width", "dark"), [("de", 320, True), ("fr", 1024, False)])
def test_the_page_fits_and_is_told(
    look: Look, ben: Served, language: str, width: int, dark: bool
) -> None:
    page = fleet(look, language=language, width=width, dark=dark)
    expect(page.locator(".robot.card", has_text="Ben")).to_be_visible()
    assert page.evaluate(STICKS_OUT) == []
    assert page.evaluate(CONTRAST) == []
    assert nameless(page) == []
    expect(page.get_by_role("heading", level=1)).to_have_count(1)
    expect(page.locator("#stop")).to_be_in_viewport(ratio=1)


def test_who_only_looks_on_may_stop_them_and_send_none(
    look: Look, served: Served, ben: Served
) -> None:
    secret = served.observer_url.partition("?")[2]
    page = look(f"/fleet?{secret}")
    expect(page.locator("#fleet")).to_have_attribute("data-ready", "yes")
    expect(page.get_by_role("button", name="STOP ALL")).to_be_visible()
    expect(page.locator(".sending")).to_have_count(0)


def test_a_robot_that_is_gone_is_said_to_be_unknown(
    look: Look, served: Served, meets: str, picture: Picture
) -> None:
    home = home_of(served.home.parent, "Cleo", served.home / "fleet.key")
    with serving(home, "--fleet", f"Cleo@{meets}") as cleo:
        page = fleet(look)
        card = page.locator(".robot.card", has_text="Cleo")
        expect(card).to_contain_text("Charging")
        cleo.process.kill()
        expect(card).to_contain_text("Not known")
        expect(card).to_contain_text("Not heard of for")
        expect(page.locator(".floor .robot.unknown")).to_contain_text("Cleo ?")
        picture(page, "fleet-unknown")
        began = time.monotonic()
        page.get_by_role("button", name="Stop Cleo").click()
        expect(page.locator(".fleet-told")).to_contain_text("Nothing was heard of Cleo")
        assert time.monotonic() - began < 20


def test_without_a_fleet_there_is_no_such_page(
    look: Look, tmp_path_factory: pytest.TempPathFactory
) -> None:
    with serving(tmp_path_factory.mktemp("alone")) as alone:
        page = look("/runs", url=alone.url)
        expect(page.locator("header nav")).to_be_visible()
        expect(page.locator("header nav a[href='/fleet']")).to_have_count(0)
        answer = page.goto(alone.url + "/fleet")
        assert answer is not None and answer.status == 404
        loaded = Path(f"/proc/{alone.process.pid}/maps").read_text("utf-8", "replace")
        assert "zenoh" not in loaded
