"""What a click on the map means: a place, or a spot with room that people have words for."""

from types import SimpleNamespace
from typing import Any

import msgspec
import pytest
from shapely import LineString, Point

from nl2robot.console.floor.goals import Aimed, aim
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from sim.spots import room_near
from sim.world.loading import load_world
from sim.world.model import Door, World, Zone

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


@pytest.mark.parametrize(
    ("x", "y"),
    [
        (3.7, 6.5),  # in the doorway of the pharmacy
        (3.7, 6.9),  # right before it
        (3.7, 6.1),  # right behind it
        (34.0, 5.0),  # in the inner doorway of the kitchen
    ],
)
def test_by_the_door_is_where_nobody_is_kept_from_going_through(x: float, y: float) -> None:
    spot = aimed(x, y)
    for door in HOSPITAL.doors:
        line = LineString([door.ends[:2], door.ends[2:]])
        assert line.distance(Point(spot.x, spot.y)) > 0.74, "a robot's width, and the robot"
    assert spot.moved < 1 and "by the door of" in spot.program
    assert "in people's way through a door" in spot.note


def test_who_clicks_before_a_door_finds_the_robot_on_that_side_of_it() -> None:
    assert aimed(3.7, 6.8).y > 6.5
    assert aimed(3.7, 6.2).y < 6.5
    assert aimed(4.6, 6.9).y > 6.5, "beside the door, and not in the room behind the wall"


def test_where_there_is_nothing_but_a_doorway_the_robot_stands_in_it() -> None:
    """A cupboard of a lobby: better there than nowhere."""
    walls = ((0.0, 0.0, 1.2, 0.0), (1.2, 0.0, 1.2, 0.9), (1.2, 0.9, 0.0, 0.9), (0.0, 0.9, 0.0, 0.0))
    door = Door(ends=(0.4, 0.0, 0.8, 0.0), at="cupboard")
    world = World(name="tiny", drawn_walls=walls, doors=(door,))
    assert room_near(world, 0.6, 0.45) == (0.6, 0.45)


def test_where_the_robot_cannot_go_a_sentence_says_why() -> None:
    with pytest.raises(UserError, match="Click on the map"):
        aimed(float("nan"), 0)
    with pytest.raises(UserError, match="no room"):
        aimed(900, 900)
    zone = Zone("wet floor", ((27.0, 1.0), (30.0, 1.0), (30.0, 4.0), (27.0, 4.0)))
    with pytest.raises(UserError, match='keep-out zone "wet floor"'):
        aimed(28.5, 2.5, zones=(zone,))
