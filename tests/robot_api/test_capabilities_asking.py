"""A robot asks people on a ward, who answer as people do."""

from __future__ import annotations

from typing import Any

import pytest

from robot_api.capabilities.sound import Asked, Sound, Unsure
from robot_api.driver import Event, StopFlag
from robot_api.drivers import EmulatedDriver, emulated
from robot_api.errors import TimedOut

PLACES = ["radiology", "pharmacy"]


class Bystander:
    """Hears what the robot says and sees what it shows."""

    def __init__(self, driver: EmulatedDriver) -> None:
        self.spoken: list[str] = []
        self.shown: list[Event] = []
        driver.subscribe(self.notice)

    def notice(self, kind: str, data: Event) -> None:
        if kind == "speech":
            self.spoken.append(data["text"])
        elif kind == "screen":
            self.shown.append(data)


def do(driver: EmulatedDriver, method: str, **arguments: Any) -> Any:
    return driver.call(method, arguments, StopFlag())


def where_to(driver: EmulatedDriver) -> Any:
    return do(driver, "ask", question="Where to?", options=PLACES)


def test_the_first_answer_is_understood() -> None:
    robot = emulated(["to the pharmacy, please"])
    bystander = Bystander(robot)
    assert where_to(robot) == "pharmacy"
    assert bystander.spoken == ["Where to?"]
    assert bystander.shown == []


def test_an_answer_that_is_not_understood_is_asked_for_again() -> None:
    robot = emulated(["er, hm", "the second one"])
    bystander = Bystander(robot)
    assert where_to(robot) == "pharmacy"
    assert bystander.spoken == ["Where to?", "I am sorry, I did not understand you. Where to?"]


class BadEars:
    """A robot in a noisy corridor."""

    def __init__(self, *heard: str | Unsure | None) -> None:
        self.heard = list(heard)
        self.asked: list[Asked] = []

    def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | Unsure | None:
        self.asked.append(asked)
        return self.heard.pop(0)


def test_what_was_heard_badly_is_asked_about() -> None:
    ears = BadEars(Unsure("fare missy", "pharmacy"), "yes, exactly")
    robot = emulated(sound=Sound(ears=ears))
    bystander = Bystander(robot)
    assert where_to(robot) == "pharmacy"
    assert bystander.spoken == ["Where to?", "Was that “pharmacy”?"]
    assert ears.asked[1].options == ["yes", "no"]


@pytest.mark.parametrize("answer", ["no", None, "what?", Unsure("yeti", "yes")])
def test_what_is_not_confirmed_is_not_taken(answer: str | Unsure | None) -> None:
    ears = BadEars(Unsure("fare missy", "pharmacy"), answer, "radiology")
    robot = emulated(sound=Sound(ears=ears))
    bystander = Bystander(robot)
    assert where_to(robot) == "radiology"
    assert bystander.spoken[2] == "I am sorry, I did not understand you. Where to?"


def test_after_two_misunderstandings_the_touchscreen_helps() -> None:
    robot = emulated(["mumble", "mumble", "pharmacy"])
    bystander = Bystander(robot)
    assert where_to(robot) == "pharmacy"
    assert bystander.shown[0]["options"] == PLACES
    assert "options" not in bystander.shown[-1]  # the buttons are gone again


def test_who_keeps_silent_is_asked_again_without_a_reproach() -> None:
    robot = emulated([None, "radiology"])
    bystander = Bystander(robot)
    assert where_to(robot) == "radiology"
    assert bystander.spoken == ["Where to?", "Where to?"]


def test_nobody_is_there() -> None:
    robot = emulated([None, None, None])
    with pytest.raises(TimedOut, match="touched the screen"):
        where_to(robot)


def test_nobody_is_there_and_the_robot_has_no_screen() -> None:
    robot = emulated([None, None], without=["screen"])
    with pytest.raises(TimedOut, match="Ask again when somebody is there"):
        where_to(robot)


def test_without_options_the_words_count() -> None:
    robot = emulated([None, "My knee hurts."])
    assert do(robot, "ask", question="What is the matter?") == "My knee hurts."
    robot = emulated([None, None])
    with pytest.raises(TimedOut, match="Nobody answered my question"):
        do(robot, "ask", question="What is the matter?")


def test_the_robot_asks_in_its_language() -> None:
    robot = emulated(["brumm", "ja, gerne"])
    bystander = Bystander(robot)
    do(robot, "set_language", code="de")
    assert do(robot, "ask", question="Möchten Sie Tee?", options=["yes", "no"]) == "yes"
    assert bystander.spoken[1].startswith("Entschuldigung")


def test_a_robot_without_a_voice_shows_what_it_asks() -> None:
    robot = emulated(["radiology"], without=["speech"])
    bystander = Bystander(robot)
    assert where_to(robot) == "radiology"
    assert bystander.shown == [{"text": "Where to?"}]


def test_listening_with_a_prompt() -> None:
    robot = emulated(["good morning", None])
    bystander = Bystander(robot)
    assert do(robot, "listen", prompt="Hello!") == "good morning"
    assert bystander.spoken == ["Hello!"]
    with pytest.raises(TimedOut, match="listened for 3 seconds"):
        do(robot, "listen", timeout=3)


LUNCH = {"When is lunch?": "Lunch is at noon."}


def test_a_prepared_question_is_answered() -> None:
    robot = emulated(["could you tell me when lunch is"], questions=LUNCH)
    bystander = Bystander(robot)
    assert do(robot, "answer") == "Lunch is at noon."
    assert bystander.spoken == ["Lunch is at noon."]


def test_a_question_given_is_not_listened_for() -> None:
    robot = emulated([None], questions=LUNCH)
    assert do(robot, "answer", question="When is lunch?") == "Lunch is at noon."


def test_a_question_that_nobody_prepared_gets_an_honest_answer() -> None:
    robot = emulated(["what is the meaning of life"], questions=LUNCH)
    assert do(robot, "answer").startswith("I am sorry, I do not know that.")


def test_nobody_asks_anything() -> None:
    with pytest.raises(TimedOut):
        do(emulated([None]), "answer")
