"""The robot's camera on the page: a ROS robot's pictures, over its own wire, in a real browser."""

from __future__ import annotations

import asyncio
import io
import urllib.request
from base64 import b64encode
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest
from PIL import Image
from playwright.sync_api import Browser, expect

from nl2robot.console.face.camera import LEFT_AFTER, Viewer
from robot_api.capabilities.camera import Look
from tests.console.conftest import Served, serving
from tests.robots.ros.stand_in import StandIn

TOPIC = "/camera/compressed"
ROBOT_FILE = f"ros: {{topics: {{camera: {TOPIC}}}}}\n"


def jpeg(colour: str, width: int = 64) -> bytes:
    file = io.BytesIO()
    Image.new("RGB", (width, 48), colour).save(file, "JPEG")
    return file.getvalue()


@pytest.fixture(scope="module")
def robot() -> Iterator[StandIn]:
    with StandIn() as robot:
        yield robot


@pytest.fixture(scope="module")
def served(robot: StandIn, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    folder = tmp_path_factory.mktemp("camera")
    (folder / "robot.yaml").write_text(ROBOT_FILE, encoding="utf-8")
    address = f"ros2://127.0.0.1:{robot.port}"
    options = ("--world", "ward", "--robot", address, "--robot-file", str(folder / "robot.yaml"))
    with serving(folder / "home", *options) as served:
        yield served


def test_an_operator_looks_through_it_and_is_told_when_the_picture_is_old(
    robot: StandIn, look: Any
) -> None:
    page = look("/drive")
    picture = page.get_by_role("img", name="What the robot's camera sees")
    toggle = page.get_by_role("button", name="Look through it")
    expect(toggle).to_be_visible()
    assert not robot.listens(TOPIC)  # nobody looks
    robot.camera = b64encode(jpeg("green")).decode()
    toggle.click()
    expect(picture).to_be_visible()
    page.wait_for_function(
        "(({naturalWidth: wide, naturalHeight: high}) => wide === 64 && high === 48)"
        "(document.querySelector('.camera-picture'))"
    )
    old = page.get_by_text("This picture is old.")
    expect(old).to_have_count(0)

    robot.camera = None
    expect(old).to_be_visible()
    robot.camera = b64encode(jpeg("red", 80)).decode()
    expect(old).to_have_count(0)
    page.wait_for_function("document.querySelector('.camera-picture').naturalWidth === 80")

    page.get_by_role("button", name="Look no more").click()
    expect(picture).to_be_hidden()
    robot.until(lambda: not robot.listens(TOPIC))


def test_observers_do_not_look_through_it(served: Served, chromium: Browser) -> None:
    page = chromium.new_page()
    page.goto(served.observer_url)
    page.goto(served.url + "/drive")
    expect(page.get_by_role("heading", name="Map")).to_be_visible()
    expect(page.get_by_role("heading", name="The robot's camera")).to_have_count(0)
    assert page.request.get(served.url + "/camera").status == 403
    page.close()


def test_what_is_no_picture_is_not_shown(robot: StandIn, served: Served) -> None:
    robot.camera = b64encode(b"<svg onload='alert(1)'>").decode()
    with urllib.request.urlopen(served.url + "/camera?after=999999") as answer:
        assert (answer.status, answer.read()) == (204, b"")
    robot.camera = b64encode(jpeg("blue")).decode()
    with urllib.request.urlopen(served.url + "/camera?after=nonsense") as answer:
        assert answer.headers["Content-Type"] == "image/jpeg"
        assert answer.headers["Cache-Control"] == "no-store"


class Roll:
    """A camera that is turned by hand."""

    def __init__(self) -> None:
        self.looks: list[Look] = []

    def watch(self, look: Look) -> Callable[[], None]:
        self.looks.append(look)
        return lambda: self.looks.remove(look)

    def take(self, picture: bytes) -> None:
        for look in tuple(self.looks):
            look(picture)


def test_two_pages_share_the_pictures_and_it_is_let_go_of_when_nobody_asks() -> None:
    roll, clock = Roll(), [0.0]
    viewer = Viewer(roll, lambda: clock[0])

    async def story() -> None:
        asked = [asyncio.create_task(viewer.newer(0, 10)) for _ in range(2)]
        while not roll.looks:
            await asyncio.sleep(0)
        await asyncio.to_thread(roll.take, jpeg("green"))
        assert [found and found[0] for found in await asyncio.gather(*asked)] == [1, 1]
        assert len(roll.looks) == 1
        assert await viewer.newer(1, 0.01) is None  # an old picture is not sent again
        clock[0] += LEFT_AFTER + 0.1
        await asyncio.to_thread(roll.take, jpeg("red"))
        while roll.looks:
            await asyncio.sleep(0)
        assert await viewer.newer(0, 0.01) is None  # of what was seen before, nothing is kept
        assert len(roll.looks) == 1

    # Playwright has a loop of its own in this thread.
    with ThreadPoolExecutor(1) as pool:
        pool.submit(asyncio.run, asyncio.wait_for(story(), 20)).result()
