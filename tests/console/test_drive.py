"""Direct control in real browsers: the joystick and its dead man's switch, two operators, the
panels."""

import re
import threading
from collections.abc import Callable, Iterator
from hashlib import sha256
from typing import Any

import pytest
import zxingcpp
from PIL import Image
from playwright.sync_api import Locator, Page, expect

from robot_api.client import Robot

SOON = 20  # seconds; what is waited for comes within some hundred milliseconds

Look = Callable[..., Page]


class Watch:
    """How the robot is, by its events, as another client of the wire hears them."""

    def __init__(self, robot: Robot) -> None:
        self.robot = robot
        self.speed = 0.0
        self.heard: dict[str, list[Any]] = {}
        self._news = threading.Condition()
        robot.subscribe(["pose", "speech", "emotion", "log", "screen"], self._hear)

    def _hear(self, kind: str, data: Any) -> None:
        with self._news:
            self.heard.setdefault(kind, []).append(data)
            if kind == "pose":
                self.speed = data["speed"]
            self._news.notify_all()

    def until(self, holds: Callable[[], bool]) -> None:
        with self._news:
            assert self._news.wait_for(holds, SOON)

    def logged(self, words: str) -> None:
        """Until the robot's log says so."""
        self.until(lambda: any(words in line["message"] for line in self.heard.get("log", [])))


@pytest.fixture
def watch(served: Any) -> Iterator[Watch]:
    with served.robot() as robot:
        robot.localize("charger")  # where there is room ahead, whatever was driven before
        yield Watch(robot)


def driving(look: Look, who: str = "Ruth", **more: Any) -> Page:
    """The page of somebody who has the helm."""
    page = opened(look, who, **more)
    page.get_by_role("button", name="Take the helm").click()
    expect(page.get_by_text("You drive the robot.")).to_be_visible()
    return page


def opened(look: Look, who: str, **more: Any) -> Page:
    """The page of somebody who goes by that name."""
    page = look("/drive", **more)
    page.context.add_cookies([{"name": "who", "value": who, "url": page.url}])
    page.reload()
    expect(page.locator(".helm .who")).not_to_be_empty()
    return page


def push(page: Page, ahead: float) -> None:
    """Take hold of the stick and push it so far, of 1; the mouse stays down."""
    box = page.locator(".stick").bounding_box()
    assert box
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - ahead * box["height"] * 0.32, steps=3)


def panel(page: Page, name: str) -> Locator:
    return page.get_by_role("region", name=name, exact=True)


def test_the_robot_drives_while_the_stick_is_held(look: Look, watch: Watch) -> None:
    page = driving(look)
    push(page, 1)
    watch.until(lambda: watch.speed > 0.2)
    expect(page.locator("[data-vital=speed]")).not_to_have_text("0.00 m/s")
    page.mouse.up()
    watch.until(lambda: watch.speed == 0)
    expect(page.locator("[data-vital=speed]")).to_have_text("0.00 m/s")

    page.keyboard.down("w")
    watch.until(lambda: watch.speed > 0.1)
    page.keyboard.up("w")
    watch.until(lambda: watch.speed == 0)
    page.keyboard.down("ArrowUp")
    watch.until(lambda: watch.speed > 0.1)
    page.evaluate("window.dispatchEvent(new Event('blur'))")  # the window of another program
    watch.until(lambda: watch.speed == 0)
    page.keyboard.up("ArrowUp")

    push(page, 1)
    watch.until(lambda: watch.speed > 0.1)
    page.get_by_role("button", name="STOP").dispatch_event("click")  # with another finger
    watch.until(lambda: watch.speed == 0)
    expect(page.locator(".stick.held")).to_have_count(0)
    page.mouse.up()

    field = page.get_by_label("What the robot says")
    field.press("w")
    expect(field).to_have_value("w")
    assert watch.speed == 0, "who types does not drive"


def test_a_lost_connection_stops_the_robot(look: Look, watch: Watch) -> None:
    page = driving(look)
    push(page, 1)
    watch.until(lambda: watch.speed > 0.2)
    page.close()
    watch.until(lambda: watch.speed == 0)

    page = driving(look)
    choice = panel(page, "Go to a place")
    choice.get_by_label("Find a place").fill("pharm")
    choice.get_by_text("pharmacy").click()
    go, going = choice.get_by_role("button", name="Go there"), choice.get_by_text("is on its way")
    go.click()
    watch.until(lambda: watch.speed > 0.2)
    page.keyboard.down("s")  # who takes hold of the stick drives instead
    expect(going).to_be_hidden()
    watch.until(lambda: watch.speed < 0)
    page.keyboard.up("s")
    watch.until(lambda: watch.speed == 0)
    go.click()
    expect(going).to_be_visible()
    watch.until(lambda: watch.speed > 0.2)
    page.reload()
    watch.until(lambda: watch.speed == 0)
    expect(page.get_by_text("You drive the robot.")).to_be_visible()  # taken again by itself


def test_two_operators_hand_over_and_an_observer_looks_on(look: Look, served: Any) -> None:
    ruth, karim = driving(look), opened(look, "Karim")
    expect(karim.locator(".helm .who")).to_contain_text("Ruth drives the robot since")
    expect(karim.get_by_role("button", name="Say it")).to_be_disabled()
    karim.get_by_role("button", name="Ask for the helm").click()
    expect(ruth.get_by_role("alert")).to_contain_text(["Karim would like to drive."])
    ruth.get_by_role("button", name="Hand over").click()
    expect(karim.get_by_text("You drive the robot.")).to_be_visible()
    expect(ruth.locator(".helm .who")).to_contain_text("Karim drives")
    expect(ruth.get_by_role("button", name="Say it")).to_be_disabled()
    badge = ruth.locator("#robot-badge")
    expect(badge).to_have_text("By hand")
    expect(badge).to_have_attribute("title", "Karim drives the robot.")
    karim.close()
    expect(ruth.get_by_text("Nobody drives the robot by hand.")).to_be_visible()
    expect(badge).to_have_text(re.compile("Idle|Charging"))

    token = served.observer_url.partition("?")[2]
    observer = look(f"/drive?{token}")
    expect(observer.get_by_text("Nobody drives the robot by hand.")).to_be_visible()
    for name in ("Take the helm", "Say it", "Go there", "Show"):
        expect(observer.get_by_role("button", name=name, exact=True)).to_have_count(0)


def test_a_program_goes_on_when_the_driver_leaves(look: Look, watch: Watch) -> None:
    page = driving(look)
    ask = watch.robot.request
    program = "robot.wait(600)"
    approval = {"program": program, "sha256": sha256(program.encode()).hexdigest(), "by": "Ruth"}
    run = ask("program.run", {"approval": ask("program.approve", approval)["id"]})
    expect(page.get_by_text("A program is running, and drives the robot.")).to_be_visible()
    expect(page.get_by_role("button", name="Say it")).to_be_disabled()
    page.reload()  # the connection is lost, and the program is found again
    expect(page.get_by_role("link", name="A program runs")).to_be_visible()
    state = ask("program.state", {})
    assert (state["run"], state["state"]) == (run, "running")
    page.get_by_role("button", name="STOP").click()
    expect(page.get_by_role("button", name="Say it")).to_be_enabled()


def test_what_the_panels_do(look: Look, watch: Watch, tmp_path: Any, picture: Any) -> None:
    page = driving(look, height=1700)
    volume = page.get_by_label("Volume")
    volume.focus()
    volume.press("Home")
    watch.logged("set_volume(percent=0)")
    page.get_by_label("What the robot says").fill("Good morning")
    page.keyboard.press("Enter")
    watch.until(lambda: bool(watch.heard.get("speech")))
    expect(page.get_by_role("list", name="Said so far")).to_contain_text("Good morning")

    page.get_by_role("button", name="happy").click()
    watch.until(lambda: [e["name"] for e in watch.heard.get("emotion", [])] == ["happy"])
    expect(page.locator(".face-now")).to_contain_text("happy")
    page.get_by_label("Head left and right").press("End")
    watch.logged("joint(name='head_yaw', degrees=90)")
    page.get_by_role("button", name="Nod").click()
    watch.logged("gesture(name='nod')")

    screen = panel(page, "Screen")
    screen.get_by_role("textbox").fill("Please wait")
    screen.get_by_role("button", name="Show", exact=True).click()
    watch.until(lambda: {"text": "Please wait"} in watch.heard.get("screen", []))
    expect(screen.locator(".screen-now")).to_contain_text("Please wait")

    code = zxingcpp.create_barcode("bed 12", zxingcpp.BarcodeFormat.QRCode).to_image(scale=5)
    file = tmp_path / "code.png"
    Image.fromarray(code).save(file)
    codes = panel(page, "Bar and QR codes")
    codes.locator("input[type=file]").set_input_files(file)
    expect(codes.get_by_role("listitem")).to_contain_text("bed 12")
    with page.expect_response("**/codes") as looked:
        codes.get_by_role("button", name="With this camera").click()
    assert looked.value.json() == {"codes": []}
    codes.get_by_role("button", name="Switch the camera off").click()
    expect(codes.locator("video")).to_be_hidden()

    page.get_by_role("button", name="Video call with the robot").click()
    expect(page.locator("#calls")).to_contain_text("face is not open")

    log = panel(page, "Log")
    log.get_by_label("Search").fill("head_yaw")
    expect(log.locator("li:visible")).to_have_count(1)
    expect(log.locator("li:visible")).to_have_text(re.compile("joint.*head_yaw"))
    log.get_by_label("Search").fill("")
    picture(page, "drive")
