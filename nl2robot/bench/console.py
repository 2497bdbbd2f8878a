"""How fast the console is: a server in a process of its own, and real browsers that look at it.

`nl2robot bench console`. It needs Playwright (in the extra `dev`) and Chromium.
"""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from itertools import cycle, islice
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from nl2robot.errors import UserError
from robot_api.client import Robot
from robot_api.errors import RobotError, Stopped

if TYPE_CHECKING:
    from playwright.sync_api import Browser, Page

FLAGS: Final = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
"""For a browser that shall ask nobody but the robot."""
PAGES: Final = ("/", "/map", "/drive", "/runs", "/face")
PAINTS: Final = 7
WATCHERS: Final = 5
WATCHED_SECONDS: Final = 10.0
STOPS: Final = 20
TRIES: Final = 60
STARTS: Final = ("lobby", "main corridor", "north corridor")
"""Where a robot has room to drive, unless somebody is in its way just then."""
SOON: Final = 20.0
ROUND: Final = "for _ in range(9):\n    robot.goto('ward a')\n    robot.goto('kitchen')\n"


def measure() -> Iterator[tuple[str, float, str, str]]:
    """What is measured, the figure, its unit, and what was aimed at. Raises `UserError`."""
    with ExitStack() as opened:
        process, address = opened.enter_context(_served())
        yield "memory before the first page", _megabytes(process), "MB", ""
        browser = opened.enter_context(_browser())
        for path in PAGES:
            paints = [_first_paint(browser, address, path) for _ in range(PAINTS)]
            yield f"first paint of {path}, the first time", paints[0], "ms", ""
            yield f"first paint of {path}, median", statistics.median(paints[1:]), "ms", ""
        pages = [_open(browser, address, "/") for _ in range(WATCHERS)]
        yield f"memory with {WATCHERS} pages open", _megabytes(process), "MB", ""
        with Robot(address) as robot:
            yield from _watched(process, robot)
            delays = _stops(pages[0], robot)
        yield "from pressing STOP to zero speed, median", statistics.median(delays), "ms", "50"
        yield "from pressing STOP to zero speed, worst", max(delays), "ms", "50"


@contextmanager
def _served() -> Iterator[tuple[int, str]]:
    """The number of the server's process, and its address."""
    with tempfile.TemporaryDirectory() as home:
        process = subprocess.Popen(
            [sys.executable, "-m", "nl2robot.cli.main", "serve", "--port", "0"],
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "NL2ROBOT_HOME": home},
        )
        assert process.stdout is not None
        try:
            said = process.stdout.readline()
            yield process.pid, said.split("ws://")[1].split()[0]
        finally:
            process.terminate()
            process.wait(10)


@contextmanager
def _browser() -> Iterator[Browser]:
    names = ("chromium", "chromium-browser", "chromium-headless-shell")
    chromium = next(filter(None, map(shutil.which, names)), None)
    try:
        from playwright.sync_api import sync_playwright
    except ImportError as error:
        raise UserError(
            "The console is measured with Playwright, which is not installed."
            " Get it with: pip install 'nl2robot[dev]'"
        ) from error
    if chromium is None:
        raise UserError("There is no Chromium to measure with. apt-get install chromium")
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium, args=list(FLAGS))
        yield browser
        browser.close()


def _open(browser: Browser, address: str, path: str) -> Page:
    page = browser.new_context(viewport={"width": 1280, "height": 800}).new_page()
    page.goto(f"http://{address}{path}")
    page.locator("[data-state=connected], #stop").first.wait_for()
    return page


def _first_paint(browser: Browser, address: str, path: str) -> float:
    """Milliseconds, in a browser that has never been here."""
    page = _open(browser, address, path)
    paint: float = page.evaluate(
        "new Promise((resolve) => new PerformanceObserver((list, observer) => {"
        "  const found = list.getEntriesByName('first-contentful-paint')[0];"
        "  if (found) { observer.disconnect(); resolve(found.startTime); }"
        "}).observe({type: 'paint', buffered: true}))"
    )
    page.context.close()
    return paint


def _watched(process: int, robot: Robot) -> Iterator[tuple[str, float, str, str]]:
    """How busy the server is while a program drives and all pages watch it."""
    review = robot.request("program.check", {"program": ROUND})
    given = {"program": ROUND, "sha256": review["sha256"], "by": "benchmark"}
    approval = robot.request("program.approve", given)
    frames: list[Any] = []
    robot.subscribe(["scene"], lambda kind, data: frames.append(data))
    robot.request("program.run", {"approval": approval["id"]})
    time.sleep(1)
    frames.clear()
    began, used = time.monotonic(), _cpu_seconds(process)
    time.sleep(WATCHED_SECONDS)
    seconds = time.monotonic() - began
    busy = 100 * (_cpu_seconds(process) - used) / seconds
    rate = len(frames) / seconds
    robot.stop()
    yield f"frames a second of the map while {WATCHERS} pages watch a drive", rate, "/s", "10"
    yield f"CPU of the server while {WATCHERS} pages watch a drive", busy, "% of a core", ""


def _stops(page: Page, robot: Robot) -> list[float]:
    """The delays of `STOPS` stops."""
    tries = (_stop(page, robot, start) for start in islice(cycle(STARTS), TRIES))
    delays = list(islice((delay for delay in tries if delay is not None), STOPS))
    if len(delays) < STOPS:
        raise UserError("The robot did not get going, so no stop could be measured. Try again.")
    return delays


def _stop(page: Page, robot: Robot, start: str) -> float | None:
    """Milliseconds from the press of STOP, by the browser's clock, to the first pose without
    speed, by ours; they are one machine's. None if the robot did not get going."""
    settled, stands = threading.Event(), threading.Event()
    fast = False
    stood = 0.0

    def on_pose(kind: str, data: Any) -> None:
        nonlocal fast, stood
        if data["speed"] > 0.3:
            fast = True
            settled.set()
        elif fast and data["speed"] == 0 and not stands.is_set():
            stood = time.time()
            stands.set()

    def drive() -> None:
        with suppress(RobotError, Stopped):
            robot.drive(0.5, 40, 30)
        settled.set()

    robot.localize(start)
    unsubscribe = robot.subscribe(["pose"], on_pose)
    driving = threading.Thread(target=drive)
    driving.start()
    settled.wait(SOON)
    pressed: float = page.evaluate(
        "() => { const at = performance.timeOrigin + performance.now();"
        " document.getElementById('stop').click(); return at; }"
    )
    driving.join()
    if fast:
        stands.wait(SOON)
    unsubscribe()
    return 1000 * stood - pressed if 1000 * stood > pressed else None


def _megabytes(process: int) -> float:
    """What the process holds in memory."""
    status = Path(f"/proc/{process}/status").read_text()
    kilobytes = next(line.split()[1] for line in status.splitlines() if line.startswith("VmRSS"))
    return int(kilobytes) / 1024


def _cpu_seconds(process: int) -> float:
    """What the process has used of the processor."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")
