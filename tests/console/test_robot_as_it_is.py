"""Sliders and faces show how the robot is, not how somebody wanted it to be."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Page, expect

from tests.console.conftest import Served, serving

Look = Callable[..., Page]

STUBBORN = Path(__file__).parent / "stubborn_console.py"


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    home = tmp_path_factory.mktemp("home")
    with serving(home, "--speed", "1", program=(str(STUBBORN),)) as served:
        yield served


def driving(look: Look, **more: Any) -> Page:
    page = look("/drive", **more)
    page.get_by_role("button", name="Take the helm").click()
    expect(page.get_by_text("You drive the robot.")).to_be_visible()
    expect(page.locator("#drive-map canvas").first).to_be_visible()
    return page


def shown(page: Page, label: str) -> Any:
    """What stands beside a slider."""
    slider = page.get_by_label(label, exact=True)
    return page.locator(f"output[for={slider.get_attribute('id')}]")


@pytest.mark.parametrize("size", [{}, {"width": 390, "height": 844}])
def test_what_the_robot_refuses_does_not_stay_on_the_page(
    look: Look, served: Served, size: dict[str, int], picture: Any
) -> None:
    page = driving(look, **size)
    volume = page.get_by_label("Volume")
    volume.fill("35")
    expect(shown(page, "Volume")).to_have_text("35 %")
    volume.press("End")
    expect(page.get_by_role("alert").filter(has_text="too hot")).to_be_visible()
    expect(shown(page, "Volume")).to_have_text("35 %")
    expect(volume).to_have_value("35")

    page.get_by_role("button", name="happy").click()
    expect(page.locator(".face-now")).to_contain_text("happy")
    page.get_by_role("button", name="angry").click()
    expect(page.get_by_role("alert").filter(has_text="never angry")).to_be_visible()
    expect(page.locator(".face-now")).to_contain_text("happy")
    expect(page.get_by_role("button", name="angry")).to_have_attribute("aria-pressed", "false")

    language = page.get_by_label("The robot speaks and hears")
    language.select_option("German")
    with served.robot() as robot:  # the page asks for it when it comes to it
        while robot.request("helm.body", {})["now"]["language"] != "de":
            page.wait_for_timeout(20)
    language.select_option("French")
    expect(page.get_by_role("alert").filter(has_text="cannot be loaded")).to_be_visible()
    expect(language).to_have_value("de")
    page.get_by_role("button", name="happy").scroll_into_view_if_needed()
    picture(page, f"drive-refused-{page.viewport_size['width']}")  # type: ignore[index]
    with served.robot() as robot:
        robot.set_language("en")


def test_a_joint_that_was_stopped_on_its_way_is_not_where_it_should_have_gone(
    look: Look, served: Served
) -> None:
    page = driving(look)
    head = page.get_by_label("Head left and right")
    expect(shown(page, "Head left and right")).to_have_text("0°")
    head.press("End")
    expect(shown(page, "Head left and right")).to_have_text("0° → 90°")
    page.get_by_role("button", name="STOP").click()
    expect(shown(page, "Head left and right")).to_have_text("0°")
    expect(head).to_have_value("0")


def test_the_page_follows_what_others_do_with_the_robot(look: Look, served: Served) -> None:
    page = look("/drive")  # nobody has the helm, and nobody asked for anything here
    with served.robot() as robot:
        robot.set_volume(20)
        expect(shown(page, "Volume")).to_have_text("20 %")
        robot.joint("head_pitch", 12)
        expect(shown(page, "Head up and down")).to_have_text("12°")
        robot.emotion("surprised")
        expect(page.locator(".face-now")).to_contain_text("surprised")
        robot.set_language("de")
        expect(page.get_by_label("The robot speaks and hears")).to_have_value("de")
        robot.set_language("en")


def test_what_the_robot_has_not_said_is_not_made_up(
    look: Look, tmp_path_factory: pytest.TempPathFactory
) -> None:
    home = tmp_path_factory.mktemp("home")
    with serving(home, "--robot", "emulator") as real:  # which is known by its events alone
        page = look("/drive", url=real.url)
        expect(shown(page, "Volume")).to_have_text("?")
        expect(page.get_by_label("Volume")).to_have_attribute("aria-valuetext", "not known yet")
        expect(page.locator(".face-now")).to_contain_text("not known yet")
        with real.robot() as robot:
            robot.set_volume(40)
        expect(shown(page, "Volume")).to_have_text("40 %")
