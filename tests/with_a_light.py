"""A robot with a light, which the page of the docs has added; `test_new_method.py` runs these."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from grammar.schema import plan_schema
from nl2robot.cli.main import main
from nl2robot.console.runs.page import _for_scripts
from nl2robot.knowledge import Knowledge
from nl2robot.review.policy import violations
from nl2robot.run.kept_record import TOLD
from nl2robot.run.pausing import DRIVING
from nl2robot.sentences import in_language
from nl2robot.translate.translation import translate
from robot_api import Robot, Server
from robot_api.checker import check_driver
from robot_api.driver import EVENTS, StopFlag
from robot_api.drivers import emulated
from robot_api.errors import NotSupported
from robot_api.openrpc import openrpc
from robot_api.reference import reference
from robot_api.stub import stub
from sandbox.check import check
from sim.world.loading import load_world

WARD = load_world("city-hospital")
HAS, LACKS = emulated().capabilities(), emulated(without=["light"]).capabilities()
SOON = 20  # seconds; what is waited for comes within milliseconds


@pytest.mark.parametrize(
    ("language", "words", "color", "told"),
    [
        ("en", "make your light red", "red", "I will turn my light red."),
        ("en", "please turn off the light", "off", "I will turn my light off."),
        ("de", "mach dein Licht grün", "green", "Ich werde mein Licht auf Grün stellen."),
        ("de", "leuchte bitte blau", "blue", "Ich werde mein Licht auf Blau stellen."),
        ("fr", "mets ta lumière en vert", "green", "Je vais mettre ma lumière sur « vert »."),
        ("fr", "éteins la lumière", "off", "Je vais mettre ma lumière sur « éteint »."),
    ],
)
def test_it_is_understood_and_told_in_each_language(
    language: str, words: str, color: str, told: str
) -> None:
    said = translate(words, Knowledge(WARD, HAS), language)
    assert said.program == f'robot.light("{color}")\n'
    assert said.explanation == told
    assert not said.unused  # every word was for something


def test_it_stands_among_other_orders() -> None:
    said = translate(
        "if you see Alice, make your light green and say hello", Knowledge(WARD, HAS), "en"
    )
    assert said.explanation == "If I see Alice, I will turn my light green and say “Hello!”"


def test_a_strange_colour_is_refused_at_review_in_the_reader_s_language() -> None:
    [finding] = violations('robot.light("purple")\n', Knowledge(WARD, HAS))
    assert finding.code == "bad-value"
    assert finding.message == "color of light must be red, green, blue or off; got 'purple'."
    assert in_language(finding.message, "de") is not None
    [finding] = check("robot.light(3)\n", stub())
    assert finding.code == "invalid-argument-type"


def test_a_robot_that_lacks_it_is_refused_at_review_and_at_the_call() -> None:
    program = 'robot.light("red")\n'
    [finding] = violations(program, Knowledge(WARD, LACKS))
    assert (finding.line, finding.code) == (1, "not-supported")
    assert any("light" in finding.message for finding in check(program, stub(LACKS)))
    with pytest.raises(NotSupported, match="cannot do 'light': it has no light") as refused:
        emulated(without=["light"]).call("light", {"color": "red"}, StopFlag())
    german = in_language(str(refused.value), "de")
    assert german is not None and "kann „light“ nicht" in german


def test_it_is_reviewed_tried_run_and_seen_in_the_simulator(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    picture = tmp_path / "run.svg"
    words = "go to the pharmacy, then make your light red"
    assert main(["run", words, "--yes", "--picture", str(picture)]) == 0
    shown = capsys.readouterr().out
    assert "turn my light red" in shown
    assert "light(color='red')" in shown
    assert "light: red" in picture.read_text(encoding="utf-8")


def test_it_can_be_looked_into_and_is_offered(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain", "shine blue"]) == 0
    assert "light color: blue" in capsys.readouterr().out
    assert main(["phrases", "Licht", "--lang", "de"]) == 0
    assert "mach dein Licht rot" in capsys.readouterr().out


def test_it_is_there_over_the_wire_and_its_event_is_heard() -> None:
    heard, colors = threading.Event(), []

    def listen(kind: str, data: object) -> None:
        colors.append((kind, data))
        heard.set()

    with Server(emulated(), port=0) as server, Robot(server.address) as robot:
        robot.subscribe("light", listen)
        robot.light("green")
        assert heard.wait(SOON)
    assert colors == [("light", {"color": "green"})]


def test_what_is_made_from_the_table_has_it() -> None:
    assert "def light(self, color: str) -> None:" in stub()
    assert "robot.light(color: str) -> None" in reference()
    assert "| `event.light` | color |" in reference()
    document = openrpc()
    [method] = [each for each in document["methods"] if each["name"] == "robot.light"]
    assert method["params"][0]["schema"]["enum"] == ["red", "green", "blue", "off"]
    assert document["x-events"]["event.light"] == EVENTS["light"] == "color"
    assert "'light'" in str(plan_schema())


def test_the_check_of_a_driver_tries_it_and_misses_what_it_does_not_tell(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert check_driver(emulated()) == []
    robot = emulated()
    monkeypatch.setattr(robot.emulation, "publish", lambda kind, **data: None)
    faults = [str(problem) for problem in check_driver(robot)]
    assert any("light" in fault and "sends no event" in fault for fault in faults)


def test_a_replay_tells_of_it_in_each_language() -> None:
    assert TOLD["light"] == "color"
    assert _for_scripts("de")["light"] == "mein Licht auf {text} stellen"
    assert _for_scripts("de")["light_red"] == "Rot"
    assert _for_scripts("en")["light"] == "turn my light {text}"


def test_it_moves_nothing_so_a_pause_does_not_break_it_off() -> None:
    assert "light" not in DRIVING
