"""What a click on the map means: a place, or a spot with room that people have words for."""

from types import SimpleNamespace
from typing import Any

import msgspec
import pytest

from nl2robot.console.goals import Aimed, aim
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from sim.world import Zone, load_world

HOSPITAL = load_world("city-hospital")


def aimed(
    x: float, y: float, place: str | None = None, language: str = "en", **world: Any
) -> Aimed:
    knowledge = Knowledge(msgspec.structs.replace(HOSPITAL, **world))
    runner: Any = SimpleNamespace(knowledge=knowledge)
    backstage: Any = SimpleNamespace(simulation=None, runner=runner)
    return aim(backstage, x, y, place, language)


def test_a_place_is_gone_to_by_its_name() -> None:
    door = aimed(0, 0, "main corridor")
    assert (door.program, door.said) == (
        'robot.goto("main corridor")\n',
        "Go to the main corridor.",
    )
    x, y, _ = HOSPITAL.start.x, HOSPITAL.start.y, 0  # type: ignore[union-attr]
    assert aimed(x + 0.2, y).place == "charger", "who clicks beside it means it"
    assert aimed(x, y, "no such place").place == "charger"


@pytest.mark.parametrize(
    ("language", "by_the_door", "in_the_lobby"),
    [
        (
            "en",
            "Go to the spot by the door of the pharmacy.",
            "Go to the spot in the lobby, at 20 m, 3 m.",
        ),
        (
            "de",
            "Fahr an die Stelle an der Tür zur Apotheke.",
            "Fahr an die Stelle in der Eingangshalle, bei 20 m; 3 m.",
        ),
        (
            "fr",
            "Va à l'endroit près de la porte de la pharmacie.",
            "Va à l'endroit dans le hall, à 20 m ; 3 m.",
        ),
    ],
)
def test_a_spot_has_words(language: str, by_the_door: str, in_the_lobby: str) -> None:
    assert aimed(3, 7.7, language=language).said == by_the_door
    assert aimed(20, 3, language=language).said == in_the_lobby


def test_a_spot_without_room_becomes_the_nearest_that_has_some_and_says_so() -> None:
    beside = aimed(5.5, 6.5)  # in a wall
    assert (beside.x, beside.y, beside.moved) == (5.5, 6.9, 0.4)
    assert "0.4 m away" in beside.note
    assert beside.program == "robot.goto(5.5, 6.9)  # by the door of the pharmacy\n"
    assert aimed(5.5, 7.2).note == ""


def test_where_the_robot_cannot_go_a_sentence_says_why() -> None:
    with pytest.raises(UserError, match="Click on the map"):
        aimed(float("nan"), 0)
    with pytest.raises(UserError, match="no room"):
        aimed(900, 900)
    zone = Zone("wet floor", ((27.0, 1.0), (30.0, 1.0), (30.0, 4.0), (27.0, 4.0)))
    with pytest.raises(UserError, match='keep-out zone "wet floor"'):
        aimed(28.5, 2.5, zones=(zone,))
