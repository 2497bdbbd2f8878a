"""What was run is found again, told in full and watched again, and run again only if approved."""

from __future__ import annotations

import asyncio
import csv
import io
import json
import re
import sqlite3
from concurrent.futures import ThreadPoolExecutor
from dataclasses import fields
from datetime import UTC, datetime
from html import unescape
from types import SimpleNamespace
from typing import Any
from urllib.parse import quote

import httpx
import pytest
from playwright.sync_api import Page, expect
from starlette.applications import Starlette

from nl2robot.cli.operator import Operator
from nl2robot.console.desk.highlight import highlighted
from nl2robot.console.runs import page as runs
from nl2robot.console.runs import view as runs_view
from nl2robot.console.runs.asked import BadDay, asked
from nl2robot.console.visitor import LANGUAGES, texts
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.run.archive import Archive
from nl2robot.run.kept_record import Happening, Movement, Pose, packed
from nl2robot.run.runlog import RunLog
from nl2robot.station.part import Backstage, Part
from robot_api.errors import NotPossible
from sim.world.loading import load_world
from tests.console.conftest import SOON, Look, Served

NOT_NEEDED: Any = {item.name for item in fields(Backstage) if item.init} - {"runner", "_listeners"}
PROGRAM = 'robot.goto("pharmacy")\nrobot.say("Hello <b>there</b>.")\n'


@pytest.fixture(scope="module")
def knowledge() -> Knowledge:
    return Knowledge(load_world(DEFAULT_WORLD))


@pytest.fixture
def log(tmp_path):
    log = RunLog(tmp_path / "runs.sqlite")
    yield log
    log.close()


@pytest.fixture
def backstage(log, knowledge) -> Backstage:
    runner: Any = SimpleNamespace(log=log, knowledge=knowledge)
    return Backstage(runner=runner, **dict.fromkeys(NOT_NEEDED))


class Client:
    """Gets the files of the part."""

    def __init__(self, part: Part) -> None:
        self.transport = httpx.ASGITransport(Starlette(routes=part.routes))

    def get(self, address: str, **headers: str) -> httpx.Response:
        async def get() -> httpx.Response:
            async with httpx.AsyncClient(
                transport=self.transport, base_url="http://ward"
            ) as client:
                return await client.get(address, headers=headers)

        # In a thread of its own: that of the tests may have the loop of a browser.
        with ThreadPoolExecutor(1) as thread:
            return thread.submit(lambda: asyncio.run(get())).result()


@pytest.fixture
def client(backstage) -> Client:
    return Client(runs.part(backstage))


def ran(log, utterance: str = "go and greet", program: str = PROGRAM, **more: Any) -> int:
    about = {"sha256": "0" * 64, "approved_by": "Nurse Kim", "approved_at": 1000.0, **more}
    run = log.begin(program=program, utterance=utterance, **about)
    log.call_begins(run, 1, 1, "goto", '{"place":"pharmacy","x":null}')
    log.call_ends(run, 1, 2.5, result="null")
    log.call_begins(run, 2, 2, "say", '{"text":"Hello <b>there</b>."}')
    log.call_ends(run, 2, 0.1, error="Blocked: The way is blocked.")
    log.printed(run, "1 < 2\n")
    log.end(run, "failed", "The way is blocked.")
    return run


def page_of(log, knowledge, run: int, language: str = "en", role: str = "operator") -> str:
    reader = runs_view.Reader(language, texts("runs", language), knowledge)
    return runs_view.run_page(log.run(run), log, reader, role, Archive(log.path).neighbours(run))


def plain(html: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]*>", "", html))


# --- what a page says ----------------------------------------------------------------------------


@pytest.mark.parametrize("language", LANGUAGES)
def test_a_run_is_told_in_every_language(log, knowledge, language) -> None:
    run = ran(log, heard="go and treat")
    page = page_of(log, knowledge, run, language)
    said = plain(page)
    assert "go and greet" in said and "go and treat" in said and "Nurse Kim" in said
    assert texts("runs", language)["state_failed"] in said
    assert "2.5" in said and "The way is blocked." in said
    assert "1 &lt; 2" in said


@pytest.mark.parametrize(
    ("language", "answers"),
    [
        ("en", ["Reception: yes", "Radiology: no"]),
        ("de", ["Empfang: yes", "Radiologie: no"]),
        ("fr", ["Réception: yes", "Radiologie: no"]),
    ],
)
def test_the_answers_stand_first_under_what_was_said(log, knowledge, language, answers) -> None:
    """A nurse asked whether anybody needs water; tomorrow she looks for who said yes."""
    about = {"sha256": "0" * 64, "approved_by": "Nurse Kim", "approved_at": 1000.0}
    run = log.begin(program=PROGRAM, utterance="who needs water?", **about)
    for number, (place, said) in enumerate([("reception", "yes"), ("radiology", "no")]):
        log.call_begins(run, 2 * number + 1, 1, "goto", json.dumps({"place": place}))
        log.call_ends(run, 2 * number + 1, 2.5, result="null")
        log.call_begins(run, 2 * number + 2, 2, "ask", '{"question":"Water?"}')
        log.call_ends(run, 2 * number + 2, 2.5, result=json.dumps(said))
    log.end(run, "done", None)
    page = page_of(log, knowledge, run, language)
    order = [
        unescape(page).replace("\u202f", "").replace("\u00a0", "").replace(" :", ":").find(text)
        for text in ("who needs water?</h1>", *answers, "Nurse Kim", "run-program")
    ]
    assert -1 not in order and order == sorted(order)


def test_a_program_is_shown_with_its_lines_in_plain_words(log, knowledge) -> None:
    page = page_of(log, knowledge, ran(log))
    assert re.search(r'<code class="code"><span class="n">robot</span>', page)
    assert "go to the pharmacy" in plain(page)
    assert f'href="/?program={quote(PROGRAM, safe="")}"' in page


def test_who_only_looks_on_cannot_run_it_again(log, knowledge) -> None:
    assert "/?program=" not in page_of(log, knowledge, ran(log), role="observer")


def test_what_others_wrote_is_shown_and_not_obeyed(log, knowledge, client) -> None:
    nasty = "</span><script>alert(1)</script>\x1b[2J\u202e"
    run = ran(log, nasty, f"x = {nasty!r}  # {nasty}\n", heard=nasty + "?", approved_by=nasty)
    log.printed(run, nasty)
    for page in (page_of(log, knowledge, run), client.get("/runs/found").text):
        assert "<script>" not in page and "\x1b" not in page and "\u202e" not in page
        assert "&lt;script&gt;" in page


def test_what_was_written_by_hand_has_a_title_too(log, knowledge) -> None:
    assert "A program written by hand" in page_of(log, knowledge, ran(log, utterance=None))


def test_a_program_of_another_version_is_still_shown(log, knowledge) -> None:
    page = page_of(log, knowledge, ran(log, program="robot dance!\n\tthis 'is none"))
    assert "robot dance!" in plain(page)


@pytest.mark.parametrize(
    "program",
    [
        "",
        "\n\n",
        'x = f"{{a}} {1 + 1} {\'é\'}"\ny = """one\ntwo"""\n',
        "\tx\r\ny\r",
        "'",
        "(" * 300,
    ],
)
def test_no_sign_of_a_program_is_lost(program) -> None:
    lines = [unescape(re.sub("<[^>]*>", "", line)) for line in highlighted(program)]
    expected = program.replace("\r\n", "\n").replace("\r", "\n").rstrip("\n").split("\n")
    assert lines == expected


def test_a_long_run_shows_its_newest_calls(log, knowledge) -> None:
    run = ran(log)
    for number in range(3, 1203):
        log.call_begins(run, number, 1, "wait", '{"seconds":1}')
    page = page_of(log, knowledge, run)
    assert "702 earlier calls are not shown" in plain(page)
    assert page.count("<tr") == runs_view.CALLS_SHOWN + 1


# --- what can be asked ---------------------------------------------------------------------------


def test_there_is_no_run_of_a_number_beyond_all(log, backstage) -> None:
    """It was a fault of the page."""
    assert log.run(10**30) is None
    show = runs.part(backstage).services["runs.show"].handler
    with pytest.raises(NotPossible, match="There is no run"):
        show({"run": 10**30}, None)


def test_what_makes_no_sense_in_an_address_is_left_out_but_a_day() -> None:
    assert asked({"state": "dancing", "before": "x", "words": " a "}).query() == "?words=a"
    assert asked({"before": "9" * 30}).before is None
    assert asked({"words": "ä&b", "before": "7"}).query(before=3) == "?words=%C3%A4%26b&before=3"
    with pytest.raises(BadDay):
        asked({"since": "yesterday"})


def test_the_list_is_paged_and_keeps_what_was_asked(log, client, monkeypatch) -> None:
    for number in range(60):
        ran(log, f"say {number}")
    first = client.get("/runs/found?words=say").text
    assert "60 runs" in first and first.count("<li>") == 50
    [older] = re.findall(r'href="/runs(\?[^"]*)" rel="next"', first)
    second = client.get(f"/runs/found{older.replace('&amp;', '&')}").text
    assert second.count("<li>") == 10
    assert 'rel="next"' not in second and 'rel="first"' in second
    assert "No run is like that" in client.get("/runs/found?words=dance").text
    bad = client.get("/runs/found?since=yesterday", **{"accept-language": "de"})
    assert (bad.status_code, "ist kein Tag" in bad.text) == (400, True)


def test_runs_are_exported_as_they_are_listed(log, client) -> None:
    ran(log, "=1+1", approved_by="Kim, the nurse")
    ran(log, "dance")
    table = client.get("/runs/export.csv?words=dance")
    assert table.headers["content-disposition"].startswith('attachment; filename="runs-')
    assert table.text.startswith("\ufeff")
    rows = list(csv.DictReader(io.StringIO(client.get("/runs/export.csv").text.lstrip("\ufeff"))))
    assert [row["utterance"] for row in rows] == ["dance", "'=1+1"], "no spreadsheet computes it"
    assert (rows[1]["approved_by"], rows[1]["program"]) == ("Kim, the nurse", PROGRAM)
    data = client.get("/runs/export.json").json()
    assert [(run["id"], run["state"], run["calls"]) for run in data] == [
        (2, "failed", 2),
        (1, "failed", 2),
    ]
    assert client.get("/runs/export.json?words=nothing").json() == []
    assert client.get("/runs/export.exe").status_code == 404


def test_a_run_is_saved_whole_or_its_program(log, client, tmp_path) -> None:
    run = ran(log)
    whole = client.get(f"/runs/{run}/run.json").json()
    assert [call["method"] for call in whole["calls"]] == ["goto", "say"]
    program = client.get(f"/runs/{run}/program.py")
    assert (program.text, 'run-1.py"' in program.headers["content-disposition"]) == (PROGRAM, True)
    for name in ("movement.json", "picture.svg", "floor.svg"):
        assert client.get(f"/runs/{run}/{name}").status_code == 404
    for number in (99, 2**70):
        assert client.get(f"/runs/{number}/run.json").status_code == 404
    log.picture(run, str(tmp_path / "secret.txt"))
    (tmp_path / "secret.txt").write_text("secret")
    assert client.get(f"/runs/{run}/picture.svg").status_code == 404, "only pictures"
    log.picture(run, str(tmp_path / "run.svg"))
    (tmp_path / "run.svg").write_text("<svg/>")
    picture = client.get(f"/runs/{run}/picture.svg")
    assert "sandbox" in picture.headers["content-security-policy"]


def test_a_movement_comes_with_the_lines_of_the_program(log, client) -> None:
    run = ran(log, world="ward")
    movement = Movement(
        seconds=3.0, poses=(Pose(0, 1, 2, 90),), happenings=(Happening(1, "speech", "Hello"),)
    )
    log.keep_movement(run, packed(movement), 10)
    data = client.get(f"/runs/{run}/movement.json").json()
    assert (data["poses"], data["happenings"]) == ([[0, 1, 2, 90]], [[1, "speech", "Hello"]])
    assert [line for _, line in data["lines"]] == [1, 2]
    assert 'id="live"' in client.get(f"/runs/{run}/floor.svg").text
    log.starts_at(run, 5.0, 6.0, 0.0, datetime(2026, 3, 2, 8, 0, tzinfo=UTC))
    assert client.get(f"/runs/{run}/movement.json").json()["poses"][0] == [0, 5, 6, 0]
    log.keep_movement(run, b"junk", 10)
    assert client.get(f"/runs/{run}/movement.json").status_code == 404


@pytest.mark.parametrize(
    ("language", "names"),
    [
        ("en", ["pharmacy", "ward a"]),
        ("de", ["Apotheke", "Station A"]),
        ("fr", ["pharmacie", "radiologie"]),
    ],
)
def test_the_floor_of_a_replay_has_the_names_of_the_reader(log, client, language, names) -> None:
    run = ran(log, world=DEFAULT_WORLD)
    floor = client.get(f"/runs/{run}/floor.svg", cookie=f"language={language}").text
    others = {"pharmacy", "ward a", "Apotheke", "pharmacie"} - set(names)
    drawn = set(re.findall(r">([^<>]+)</(?:text|title)>", floor))
    assert set(names) <= drawn
    assert not others & drawn


def test_a_damaged_log_is_told_in_a_sentence(log, client, backstage) -> None:
    ran(log)
    log.close()
    for aside in ("-wal", "-shm"):
        log.path.with_name(log.path.name + aside).unlink(missing_ok=True)
    log.path.write_bytes(b"no log at all" * 1000)
    for address in ("/runs/found", "/runs/export.csv", "/runs/1/run.json"):
        answer = client.get(address)
        assert answer.status_code == 503
        assert re.search("damaged|cannot be used", answer.text)
    request: Any = SimpleNamespace(
        query_params={}, cookies={}, headers={}, state=SimpleNamespace(role="operator")
    )
    assert "damaged" in runs._list_page(backstage, Archive(log.path), request)
    assert "cannot be used" in runs._run_page(backstage, Archive(log.path), request, 1)


def test_programs_that_ask_over_the_wire_get_the_same(log, backstage) -> None:
    services = runs.part(backstage).services
    context: Any = None
    assert all(service.observes for service in services.values())
    ran(log, "dance")
    run = ran(log, "go to the ward")
    listed = services["runs.list"].handler({"words": "ward"}, context)
    assert ([each["id"] for each in listed["runs"]], listed["found"]) == ([run], 1)
    assert services["runs.show"].handler({"run": run}, context)["calls"][0]["line"] == 1
    with pytest.raises(NotPossible, match="no run 99"):
        services["runs.show"].handler({"run": 99}, context)
    json.dumps(listed)


# --- in a browser --------------------------------------------------------------------------------


def run_by(served: Served, sentence: str, wait: bool = True) -> int:
    """Somebody else has a sentence carried out; the run's number."""
    with served.robot() as robot:
        operator = Operator(robot, "Nurse Kim")
        translation = operator.translate(sentence, "en", "auto", "a talk")
        assert translation.program is not None, translation.message
        run = operator.run(operator.approve(operator.check(translation.program), translation))
        if wait:
            operator.wait(run)
        return run


def test_a_run_is_found_watched_and_run_again(look: Look, served: Served, picture) -> None:
    greeting = run_by(served, "say hello")
    page = look("/runs", language="en")
    errors: list[str] = []
    page.on("pageerror", lambda error: errors.append(str(error)))
    expect(page.locator(".runs-list li")).to_have_count(1)

    # The list follows what goes on, and is searched while one types.
    driving = run_by(served, "go to reception, then say I am here", wait=False)
    row = page.locator(".runs-list li").first
    expect(row).to_contain_text("go to reception")
    expect(row.locator(".chip")).to_have_text("runs now")
    page.get_by_label("Search").fill("hello")
    expect(page.locator(".runs-list li")).to_have_count(1)
    expect(page).to_have_url(re.compile(r"words=hello"))
    page.get_by_label("Search").fill("no such words")
    expect(page.locator(".runs-none")).to_contain_text("No run is like that")
    page.get_by_role("link", name="Show all runs").click()

    # A run that goes on comes to its end before one's eyes.
    page.locator(".runs-list a").first.click()
    expect(page.get_by_role("heading", name="go to reception")).to_be_visible()
    expect(page.locator(".run-calls tbody tr")).to_have_count(1)
    expect(page.locator(".run-program li.lit")).to_have_attribute("data-line", "1")
    picture(page, "runs-goes-on")
    expect(page.locator(".run header .chip")).to_have_text("done", timeout=SOON)
    expect(page.locator(".run-calls tbody tr")).to_have_count(2)

    # It is watched again: time is drawn, the robot moves, what it says is told.
    expect(page.locator(".run-replay[data-ready]")).to_be_visible(timeout=SOON)
    robot = page.locator(".run-floor .robot")
    began = robot.get_attribute("transform")
    slider = page.get_by_label("Time in the run")
    slider.focus()
    page.keyboard.press("End")
    expect(page.locator("[data-caption]")).to_contain_text("I am here", ignore_case=True)
    assert robot.get_attribute("transform") != began
    expect(page.locator(".run-program li.lit")).to_have_attribute("data-line", "2")
    # Pressed and looked at in one breath: drawn four times as fast, the run is soon over again.
    pressed = "button => { button.click(); return button.getAttribute('aria-label'); }"
    assert page.get_by_role("button", name="Play").evaluate(pressed) == "Pause"
    expect(page.get_by_role("button", name="Play")).to_be_visible()
    page.get_by_text("Picture of the path").click()
    expect(page.get_by_role("img", name=f"The path of run {driving}")).to_be_visible()
    picture(page, "runs-watched")

    # Running it again is another program to be approved.
    again = page.get_by_role("link", name="Run again")
    assert quote("robot.goto(", safe="") in (again.get_attribute("href") or "")
    page.goto(f"{served.url}/runs/{greeting + 90}")
    expect(page.get_by_role("alert").filter(has_text="There is no run")).to_be_visible()
    assert not errors


@pytest.mark.parametrize(("width", "dark", "language"), [(390, False, "fr"), (1024, True, "de")])
def test_the_pages_fit_phone_and_tablet(
    look: Look, served: Served, width, dark, language, picture
) -> None:
    run = run_by(served, "say hello")
    page = look("/runs", width=width, dark=dark, language=language)
    expect(page.locator("[data-part=found]")).to_be_visible()
    assert fits(page)
    page.goto(f"{served.url}/runs/{run}")
    expect(page.locator("[data-part=calls]")).to_be_visible()
    assert fits(page)
    picture(page, f"runs-{width}")


def test_a_replay_tells_looks_and_places_in_the_language_of_the_page(
    look: Look, served: Served
) -> None:
    run = run_by(served, "look happy")
    page = look(f"/runs/{run}", language="de")
    expect(page.locator(".run-floor")).to_contain_text("Apotheke")
    expect(page.locator(".run-replay[data-ready]")).to_be_visible(timeout=SOON)
    page.get_by_label("Zeit im Lauf").focus()
    page.keyboard.press("End")
    expect(page.locator("[data-caption]")).to_have_text("schaut fröhlich")


def fits(page: Page) -> bool:
    return bool(page.locator("#main").evaluate("main => main.scrollWidth <= main.clientWidth"))


def test_a_log_that_is_locked_is_told_on_the_page(look: Look, served: Served) -> None:
    page = look("/healthz")
    file = next(served.home.rglob("runs.sqlite"))
    # What locks a log in write-ahead mode for readers is its being moved away.
    moved = file.rename(file.with_suffix(".away"))
    try:
        page.goto(f"{served.url}/runs")
        expect(page.get_by_role("alert").filter(has_text="is gone")).to_be_visible()
    finally:
        moved.rename(file)
    with sqlite3.connect(file) as db:
        assert db.execute("SELECT count(*) FROM runs").fetchone()[0] >= 0
