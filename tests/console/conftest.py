"""A console that is really served, and real browsers that look at it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import Browser, BrowserContext, Page, expect, sync_playwright

from robot_api.client import Robot

CHROMIUM = next(
    filter(None, map(shutil.which, ("chromium-headless-shell", "chromium", "chromium-browser"))),
    None,
)
"""Rather the one without windows: a page costs it half as much."""
SOON = 40_000
"""Milliseconds; what is waited for comes within some hundred, on a machine that is not busy."""
expect.set_options(timeout=SOON)
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-fake-ui-for-media-stream",
    # pictures that nobody looks at, each of which is encoded and decoded
    "--use-fake-device-for-media-stream=fps=5",
    "--autoplay-policy=no-user-gesture-required",
)


@dataclass
class Served:
    """A console in a process of its own, as `nl2robot serve` starts it."""

    address: str
    """host:port"""
    process: subprocess.Popen[str]
    home: Path
    """Its `$NL2ROBOT_HOME`."""
    said: list[str]
    """What it printed when it started."""

    @property
    def url(self) -> str:
        return f"http://{self.address}"

    @property
    def observer_url(self) -> str:
        return next(
            word
            for line in self.said
            for word in line.split()
            if "looks on" in line and word.startswith("http")
        )

    def robot(self) -> Robot:
        """A new client of the robot."""
        return Robot(self.address)


@contextmanager
def serving(
    home: Path,
    *options: str,
    models: bool = False,
    program: Sequence[str] = ("-m", "nl2robot.cli.main", "serve"),
) -> Iterator[Served]:
    """Serve with these options of `nl2robot serve`; `models`: with the speech models there are.
    Where nothing else is said, a simulated robot begins at ten in the morning: what is said at
    night is reviewed in another way."""
    environment = {**os.environ, "NL2ROBOT_HOME": str(home)}
    if models:
        from nl2robot.paths import data_folder

        there = data_folder() / "models"
        if there.is_dir() and not (home / "models").exists():
            home.mkdir(parents=True, exist_ok=True)
            (home / "models").symlink_to(there)
    given = options if "--port" in options else ("--port", "0", *options)
    if not {"--clock", "--robot"} & set(options):
        given = (*given, "--clock", "10:00")
    process = subprocess.Popen(
        [sys.executable, *program, *given],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
        env=environment,
    )
    said: list[str] = []
    assert process.stdout is not None
    try:
        for line in process.stdout:
            said.append(line)
            if line.startswith("Ctrl-C"):
                break
        assert said and process.poll() is None, said
        address = said[0].split("://")[1].split()[0]
        yield Served(address, process, home, said)
    finally:
        process.terminate()
        try:
            process.wait(10)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One console for the stories of a file."""
    with serving(tmp_path_factory.mktemp("home"), "--speed", "1") as served:
        yield served


@pytest.fixture(scope="module")
def hurried(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One in which half a minute's way takes the robot three seconds."""
    with serving(tmp_path_factory.mktemp("hurried"), "--speed", "10") as served:
        yield served


@pytest.fixture(scope="session")
def chromium() -> Iterator[Browser]:
    """The browser of this worker."""
    if CHROMIUM is None:
        hint = "There is no Chromium. `make browser` gets it, or `apt-get install chromium`."
        if os.environ.get("CI"):
            pytest.fail(hint)
        pytest.skip(hint)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=list(FLAGS))
        yield browser
        browser.close()


@contextmanager
def at_most(seconds: float) -> Iterator[None]:
    """Raises `TimeoutError` when they are over. What pytest does when a story takes too long waits
    meanwhile: it goes by the same alarm."""

    def over(*_: object) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, over)
    left, _ = signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, left)
        signal.signal(signal.SIGALRM, before)


class Browsers:
    """Browsers that remember of the story before nothing but the files that they fetched, which
    would cost the server and them as much as all the rest of a page."""

    def __init__(self, chromium: Browser) -> None:
        self._chromium = chromium
        self._free: dict[str, list[BrowserContext]] = {}
        """By what is set in them."""
        self._taken: list[tuple[str, BrowserContext]] = []

    def page(self, **settings: Any) -> Page:
        """A page in a browser that no other page of this story is in."""
        kind = repr(sorted(settings.items()))
        free = self._free.setdefault(kind, [])
        context = free.pop() if free else self._chromium.new_context(**settings)
        context.set_default_timeout(SOON)
        self._taken.append((kind, context))
        page = context.new_page()
        everywhere = {"origin": "*", "storageTypes": "local_storage"}
        context.new_cdp_session(page).send("Storage.clearDataForOrigin", everywhere)
        return page

    def forget(self) -> None:
        """The story is over."""
        while self._taken:
            kind, context = self._taken.pop()
            if self._emptied(context):
                self._free[kind].append(context)

    def close(self) -> None:
        for context in (context for free in self._free.values() for context in free):
            with suppress(TimeoutError), at_most(20):
                context.close()

    def _emptied(self, context: BrowserContext) -> bool:
        # On a busy machine Chromium now and then never says that it has closed one; it closes what
        # is left with itself.
        with suppress(TimeoutError), at_most(20):
            for page in context.pages:
                page.close()
            context.clear_cookies()
            return True
        return False


@pytest.fixture(scope="module")
def browsers(chromium: Browser) -> Iterator[Browsers]:
    """Those of the stories of a file, which have one server."""
    browsers = Browsers(chromium)
    yield browsers
    browsers.close()


Look = Callable[..., Page]
Picture = Callable[[Page, str], None]


@pytest.fixture
def look(browsers: Browsers, served: Served) -> Iterator[Look]:
    """Open a page of the console in a browser of its own: look("/map", width=390, dark=True)."""

    def open_page(
        path: str = "/",
        *,
        width: int = 1440,
        height: int = 900,
        dark: bool = False,
        language: str = "en",
        url: str | None = None,
        asks_always: bool = True,
        **more: Any,
    ) -> Page:
        page = browsers.page(
            viewport={"width": width, "height": height},
            color_scheme="dark" if dark else "light",
            locale=language,
            permissions=["camera", "microphone"],
            **more,
        )
        if asks_always:  # so that stories may end with a decision, whatever is said in them
            page.add_init_script("localStorage.setItem('harmless', 'no')")
        page.goto((url or served.url) + path)
        return page

    yield open_page
    browsers.forget()


@pytest.fixture
def page(look: Look) -> Page:
    """The desk at a desktop's size, in English."""
    return look()


@pytest.fixture
def picture() -> Picture:
    """Keep a picture of a page, where `$NL2ROBOT_PICTURES` says: for people, and the docs."""

    def keep(page: Page, name: str) -> None:
        folder = os.environ.get("NL2ROBOT_PICTURES")
        if folder:
            kept = Path(folder) / f"{name}.png"
            page.screenshot(path=str(kept))
            with Image.open(kept) as shown:
                few = shown.convert("RGB").quantize(256, Image.Quantize.FASTOCTREE)
                few.save(kept, optimize=True)  # a third of the size

    return keep
