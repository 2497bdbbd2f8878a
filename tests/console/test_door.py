"""The robot in a hospital's network: who comes in, as what, and how they are let go again."""

from __future__ import annotations

import base64
import stat
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Page, expect

from nl2robot.console.face.codes import read_codes
from nl2robot.station.accounts import Accounts
from robot_api.client import Robot
from robot_api.errors import AccessDenied
from tests.console.conftest import Look, Served, serving
from tests.console.test_desk import approve, say

PASSWORD = "correct horse battery"
Open = Callable[..., Page]


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A robot that the whole house can reach."""
    home = tmp_path_factory.mktemp("house")
    with serving(home, "--host", "0.0.0.0", "--speed", "20") as served:
        yield Served(
            f"127.0.0.1:{served.address.rpartition(':')[2]}",
            served.process,
            served.home,
            served.said,
        )


@pytest.fixture(scope="module")
def accounts(house: Served) -> Iterator[Accounts]:
    """The accounts, as `nl2robot accounts` has them: in another process than the server."""
    accounts = Accounts(house.home / "accounts.sqlite")
    yield accounts
    accounts.close()


@pytest.fixture
def enter(look: Look, house: Served) -> Open:
    """Open a page of it, encrypted, in a browser of its own that knows its certificate."""

    def enter(path: str = "/", **more: object) -> Page:
        url = f"https://{house.address}"
        return look(path, url=url, ignore_https_errors=True, **more)

    return enter


def sign_in(page: Page, name: str, password: str = PASSWORD) -> None:
    page.get_by_label("Name").fill(name)
    page.get_by_label("Password").fill(password)
    page.get_by_role("button", name="Sign in").click()


def said(house: Served, words: str) -> str:
    """The link in the line that the server said with these words."""
    line = next(line for line in house.said if words in line)
    return next(word for word in line.split() if "://" in word)


def test_the_first_administrator_makes_their_account_and_approves_by_name(
    enter: Open, house: Served, accounts: Accounts
) -> None:
    link = said(house, "first administrator")
    page = enter("/join/" + link.rpartition("/")[2])
    page.get_by_label("Name").fill("Nurse Ann")
    page.get_by_label("New password").fill("too short")
    expect(page.get_by_label("New password")).to_have_attribute("minlength", "10")
    page.get_by_label("New password").fill(PASSWORD)
    page.get_by_role("button", name="Make the account").click()
    expect(page.get_by_role("button", name="Send")).to_be_visible()
    assert [(each.name, each.role) for each in accounts.accounts()] == [
        ("Nurse Ann", "administrator")
    ]
    # What a browser says of its user counts for nothing against who has signed in.
    page.context.add_cookies([{"name": "who", "value": "Somebody", "url": page.url}])
    page.reload()
    say(page, "say hello")
    approve(page)
    expect(page.locator("#run-panel .chip[role=status]")).to_have_text("Done")
    with Robot(house.address, token=accounts.link("operator")) as robot:
        runs = robot.request("program.list", {"last": 1})
    assert runs[0]["approved_by"] == "Nurse Ann"
    again = enter("/join/" + link.rpartition("/")[2])
    expect(again.locator("body")).to_contain_text("does not hold any more")


def test_who_signs_in_comes_to_the_page_they_wanted(enter: Open, accounts: Accounts) -> None:
    accounts.add("Ben", "operator", PASSWORD)
    page = enter("/map")
    sign_in(page, "Ben", "not his password")
    expect(page.get_by_role("alert")).to_contain_text("do not belong together")
    sign_in(page, "Ben")
    expect(page.locator("#stop")).to_be_visible()
    assert page.url.endswith("/map")
    failures = accounts.failures()
    assert [(each.name, each.address) for each in failures] == [("Ben", "127.0.0.1")]
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    page.get_by_role("button", name="Settings").click()
    expect(page.locator("#settings")).to_contain_text("Signed in as Ben")
    page.get_by_role("button", name="Sign out").click()
    expect(page.get_by_role("button", name="Sign in")).to_be_visible()
    page.goto(page.url.replace("/sign-in", "/map"))
    expect(page.get_by_role("button", name="Sign in")).to_be_visible()


def test_after_three_wrong_passwords_it_takes_longer(enter: Open, accounts: Accounts) -> None:
    accounts.add("Chloé", "observer", PASSWORD)
    page = enter("/sign-in", language="fr")
    for _ in range(4):
        page.get_by_label("Nom").fill("Chloé")
        page.get_by_label("Mot de passe").fill("mot de passe faux")
        page.get_by_role("button", name="Se connecter").click()
    expect(page.get_by_role("alert")).to_contain_text("Attendez")
    with accounts._changing() as database:  # the other stories come from the same address
        database.execute("DELETE FROM failures")


def test_a_tablet_is_paired_by_a_code_and_withdrawn_at_once(
    enter: Open, house: Served, accounts: Accounts
) -> None:
    accounts.add("Dana", "administrator", PASSWORD)
    desk = enter("/devices")
    sign_in(desk, "Dana")
    desk.get_by_label("What it is called").fill("Tablet at the reception")
    desk.get_by_role("button", name="Show the code").click()
    code = desk.get_by_alt_text("QR code to pair one tablet")
    [read] = read_codes(code.screenshot())
    assert read.text == desk.locator(".code code").inner_text()
    assert base64.b64decode((code.get_attribute("src") or "").partition(",")[2]).startswith(b"<svg")
    # Nobody's account is in the server's address; the picture's link is opened as a camera does.
    tablet = enter("/join/" + read.text.rpartition("/")[2], width=820, height=1180)
    expect(tablet.locator("body")).to_contain_text("the robot's face")
    tablet.get_by_role("button", name="Pair").click()
    expect(tablet.locator("#stop")).to_be_visible()
    assert tablet.url.endswith("/face")
    expect(desk.get_by_text("“Tablet at the reception” is paired.")).to_be_visible()
    expect(code).to_have_count(0)
    expect(desk.locator("li", has_text="The observers' link")).to_contain_text("Last used: not yet")
    tablet.wait_for_function("document.body.dataset.view === 'face'")
    for elsewhere in ("/drive", "/", "/runs", "/devices"):
        tablet.goto(f"https://{house.address}{elsewhere}")
        assert tablet.url.endswith("/face"), elsewhere
    used = enter("/join/" + read.text.rpartition("/")[2])
    expect(used.locator("body")).to_contain_text("does not hold any more")
    row = desk.locator("li", has_text="Tablet at the reception")  # as soon as it is
    expect(row).to_contain_text("paired by Dana")
    row.get_by_role("button", name="Withdraw").click()
    row.get_by_role("button", name="Withdraw").click()
    expect(desk.locator("li", has_text="Tablet at the reception")).to_have_count(0)
    expect(tablet.get_by_role("alert")).to_contain_text("does not hold any more")


def test_an_account_that_is_removed_elsewhere_is_signed_out_here(
    enter: Open, accounts: Accounts
) -> None:
    accounts.add("Emil", "operator", PASSWORD)
    page = enter("/")
    sign_in(page, "Emil")
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")
    accounts.remove("Emil")
    expect(page.get_by_role("button", name="Sign in")).to_be_visible()
    expect(page.get_by_role("alert")).to_contain_text("does not hold any more")


def test_what_people_came_in_by_holds_after_a_restart(look: Look, tmp_path: Path) -> None:
    options = ("--host", "0.0.0.0")
    with serving(tmp_path, *options) as first:
        port = first.address.rpartition(":")[2]
        here = f"https://127.0.0.1:{port}"
        page = look(
            "/?token=" + said(first, "looks on").rpartition("=")[2],
            url=here,
            ignore_https_errors=True,
        )
        expect(page.locator("header")).to_contain_text("You look on")
        links = [said(first, "Operators open"), said(first, "looks on")]
        page.goto("about:blank")  # a page that is open loads itself anew when the server is back
    with serving(tmp_path, *options, "--port", port) as second:
        assert links == [said(second, "Operators open"), said(second, "looks on")]
        page.goto(here)
        expect(page.locator("header")).to_contain_text("You look on")


def test_an_old_link_makes_no_operator_of_an_observer(look: Look, tmp_path: Path) -> None:
    """On a robot's own computer, too, where nobody need sign in."""
    with serving(tmp_path) as served:
        page = look("/?token=of-another-day", url=served.url)
        expect(page.get_by_role("alert")).to_contain_text("does not hold any more")
        port = served.address.rpartition(":")[2]
        kept = {"name": f"robot-{port}", "value": "of-another-day", "url": served.url}
        page.context.add_cookies([kept])
        page.goto(served.url)
        expect(page.get_by_role("alert")).to_contain_text("does not hold any more")
        page.get_by_role("link", name="Go on as whoever sits at this computer").click()
        expect(page.get_by_role("button", name="Send")).to_be_visible()


@pytest.mark.parametrize(
    ("language", "title", "stop"),
    [
        ("en", "There is no such page", "STOP"),
        ("de", "Diese Seite gibt es nicht", "STOPP"),
        ("fr", "Cette page n'existe pas", "STOP"),
    ],
)
def test_an_unknown_address_has_a_page_with_stop_on_it(
    look: Look, served: Served, language: str, title: str, stop: str
) -> None:
    with served.robot() as robot:
        stopped = threading.Event()
        robot.subscribe("stopped", lambda kind, data: stopped.set())
        page = look("/ward/7", language=language, width=390, height=844)
        expect(page.get_by_role("heading", level=1)).to_have_text(title)
        page.get_by_role("button", name=stop, exact=True).click()
        expect(page.get_by_role("alert")).to_be_visible()
        assert stopped.wait(20)
    page.get_by_role("link").first.click()
    expect(page.locator("#connection")).to_have_attribute("data-state", "connected")


def test_nobody_else_on_this_computer_reads_who_may_come_in(house: Served) -> None:
    for name in ("accounts.sqlite", "certificates/authority.key", "certificates/server.key"):
        mode = stat.S_IMODE((house.home / name).stat().st_mode)
        assert mode == 0o600, name
    kept = (house.home / "accounts.sqlite").read_bytes()
    for write_ahead in house.home.glob("accounts.sqlite-wal"):
        kept += write_ahead.read_bytes()
        assert stat.S_IMODE(write_ahead.stat().st_mode) == 0o600
    assert PASSWORD.encode() not in kept


def test_whoever_has_signed_in_is_noted_by_their_own_name(
    house: Served, accounts: Accounts
) -> None:
    accounts.add("Fay", "operator", PASSWORD)
    secret = accounts.sign_in("Fay", PASSWORD, "127.0.0.1", "a program")
    claims = {"name": "wet", "polygon": [[1, 1], [2, 1], [2, 2]], "who": "The director"}
    with let_in(house, secret) as robot:
        robot.request("zones.set", claims)
        robot.request("zones.remove", {"name": "wet", "who": "The director"})
        assert {each["who"] for each in robot.request("zones.history", {})[:2]} == {"Fay"}
        robot.request("helm.take", {"who": "The director"})
        assert robot.request("helm.state", {})["who"] == "Fay"
        robot.request("helm.give", {})


def let_in(house: Served, secret: str) -> Robot:
    """A client, as soon as the server has noticed what another process has changed."""
    ends = time.monotonic() + 30
    while True:
        try:
            return Robot(house.address, token=secret)
        except AccessDenied:
            assert time.monotonic() < ends
