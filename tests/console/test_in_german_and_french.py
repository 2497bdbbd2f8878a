"""A ward that speaks German, and one that speaks French: what its operator and a visitor see first.
The pages of the docs for them show the pictures."""

from __future__ import annotations

import pytest
from playwright.sync_api import expect

from nl2robot.console.visitor import texts
from tests.console.conftest import Look, Picture, Served
from tests.console.test_desk import approve
from tests.console.test_face import end_of, start


@pytest.mark.parametrize(
    ("language", "answer"),
    [("de", "habe ich hier gesagt: Apotheke"), ("fr", "ici : pharmacie")],
)
def test_what_the_empty_line_proposes_is_understood_and_done(
    look: Look, hurried: Served, picture: Picture, language: str, answer: str
) -> None:
    with hurried.robot() as robot:
        robot.localize("charger")
    words = texts("desk", language)
    page = look(url=hurried.url, language=language)
    page.get_by_label(words["type_here"]).fill(words["placeholder"])
    page.keyboard.press("Enter")
    expect(page.get_by_role("heading", name=words["would_do"])).to_be_visible()
    expect(page.locator(".outlook")).to_be_visible()
    picture(page, f"console-{language}")
    approve(page, words["approve"])
    expect(page.locator(".said.by-robot").last).to_contain_text(answer)


@pytest.mark.parametrize(
    ("language", "question", "drinks", "thanks"),
    [
        ("de", "Was möchten Sie trinken?", ["Tee", "Kaffee"], "Gern"),
        ("fr", "Que voulez-vous boire ?", ["Thé", "Café"], "Bien sûr"),
    ],
)
def test_a_visitor_is_asked_in_the_language_of_the_program(
    look: Look,
    served: Served,
    picture: Picture,
    language: str,
    question: str,
    drinks: list[str],
    thanks: str,
) -> None:
    robot = served.robot()
    robot.set_language(language)
    page = look("/face", width=1024, height=768, reduced_motion="reduce")
    expect(page.locator("body[data-ready]")).to_be_attached()
    program = (
        f'robot.emotion("happy")\nrobot.say("{thanks}, " + robot.ask({question!r}, {drinks!r}))\n'
    )
    run = start(robot, program, utterance="?", language=language)
    expect(page.locator(".choice")).to_have_text(drinks)
    expect(page.locator("h1")).to_have_text(question)
    expect(page.locator(".hint")).to_have_text(texts("face", language)["speak_or_touch"])
    picture(page, f"face-asks-{language}")
    page.get_by_role("button", name=drinks[1]).click()
    expect(page.locator("#caption")).to_have_text(f"{thanks}, {drinks[1]}")
    assert end_of(robot, run) == "done"
    robot.close()
