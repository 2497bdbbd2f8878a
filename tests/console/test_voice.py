"""The robot's voice in a browser: played as it comes, silent at a stop, after the first touch."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import pytest
from playwright.sync_api import Browser, Page, expect

from robot_api.client import Robot
from robot_api.errors import Stopped
from tests.console.conftest import CHROMIUM, FLAGS, SOON, Served, serving

LONG = "I will tell you about the rooms of this floor, one after the other, from left to right."
PLAY = """
addEventListener('DOMContentLoaded', async () => {
  const {playSpeech} = await import('/static/voice.js');
  const {wire} = await import('/static/wire.js');
  window.levels = [];
  window.blocked = [];
  window.robot = wire;
  window.voice = playSpeech(wire, {
    onLevel: (level) => levels.push(level),
    onBlocked: (blocked) => window.blocked.push(blocked),
  });
  await wire.request('robot.capabilities');
  console.log('listening');
});
"""


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    home = tmp_path_factory.mktemp("home")
    speaks = ("--world", "ward", "--speed", "20", "--speak", "browser", "--robot-voice", "espeak")
    with serving(home, *speaks) as served:
        yield served


def listen(page: Page, served: Served) -> None:
    """Play the robot's voice there; nothing is evaluated before, for that counts as a touch."""
    page.add_init_script(PLAY)
    with page.expect_console_message(lambda message: message.text == "listening"):
        page.goto(served.url)


def said(robot: Robot, words: str) -> tuple[threading.Thread, list[Stopped]]:
    """The thread in which the robot says it, and by what it was stopped."""
    ended: list[Stopped] = []

    def say() -> None:
        try:
            robot.say(words)
        except Stopped as stopped:
            ended.append(stopped)

    saying = threading.Thread(target=say)
    saying.start()
    return saying, ended


def test_what_the_robot_says_is_heard_and_a_stop_cuts_it(page: Page, served: Served) -> None:
    listen(page, served)
    with served.robot() as robot:
        robot.say("Good morning.")
        assert page.evaluate("blocked") == []
        page.wait_for_function("!voice.speaking")
        levels = page.evaluate("levels")
        assert max(levels) > 0.2
        assert all(0 <= level <= 1 for level in levels)
        page.wait_for_function("levels.at(-1) === 0")
        saying, ended = said(robot, LONG)
        page.wait_for_function("voice.speaking")
        took = page.evaluate(
            """async () => {
              const asked = performance.now();
              robot.request('robot.stop');
              while (voice.speaking) await new Promise((next) => setTimeout(next, 5));
              return performance.now() - asked;
            }"""
        )
        saying.join(SOON / 1000)
        assert ended
        print(f"silent after {took:.0f} ms")
        assert took < 500  # 100 ms on a machine that is not busy


def test_who_speaks_to_it_on_the_page_is_not_talked_over(page: Page, served: Served) -> None:
    listen(page, served)
    with served.robot() as robot:
        saying, ended = said(robot, LONG)
        page.wait_for_function("voice.speaking")
        assert not page.evaluate("voice.hush(), voice.speaking")
        assert not ended
        robot.stop()
        saying.join(SOON / 1000)


def test_a_browser_that_plays_nothing_before_a_touch_says_so(
    chromium: Browser, served: Served
) -> None:
    flags = [flag for flag in FLAGS if not flag.startswith("--autoplay-policy")]
    strict = chromium.browser_type.launch(
        executable_path=CHROMIUM,
        args=[*flags, "--autoplay-policy=document-user-activation-required"],
    )
    try:
        page = strict.new_page()
        listen(page, served)
        assert page.evaluate("blocked") == []
        with served.robot() as robot:
            robot.say("Nobody hears this.")
            page.wait_for_function("blocked.at(-1) === true")
            page.keyboard.press("Tab")
            page.wait_for_function("blocked.at(-1) === false")
            assert page.evaluate("levels") == []
            robot.say("This is heard.")
            page.wait_for_function("Math.max(...levels) > 0.2")
            assert page.evaluate("blocked") == [True, False]
            page.close()
            face = strict.new_page()
            face.goto(f"{served.url}/face")
            expect(face.locator("body")).to_have_attribute("data-view", "face")
            robot.say("The face says so, too.")
            expect(face.locator("#notice")).to_have_text("Touch the screen once to hear me.")
            face.keyboard.press("Tab")
            expect(face.locator("#notice")).to_be_hidden()
            saying, _ = said(robot, LONG)
            expect(face.locator("#figure")).to_have_attribute("data-speaking", "yes")
            robot.stop()
            saying.join(SOON / 1000)
    finally:
        strict.close()
