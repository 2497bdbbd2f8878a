"""Pictures of floors and runs: everything that was said is there to read, and nothing covers it."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from PIL import Image, ImageDraw

from robot_api.driver import EVENTS
from sim.pictures.drawing import animate, floor_svg, png, svg
from sim.pictures.floor import WALL, draw_floor
from sim.pictures.png import to_image
from sim.pictures.run import _cuts, draw_run
from sim.pictures.scene import Area, Box, Line, Scene, Text, box_about
from sim.pictures.story import stops_of, told
from sim.pictures.text import draw_text, text_width, wrapped
from sim.record import Happening, Record, Sample, from_json, to_json
from sim.world.builtin import builtin_worlds
from sim.world.geometry import Pose
from sim.world.loading import load_world
from sim.world.model import Place, World

SVG = "{http://www.w3.org/2000/svg}"


def run(
    *legs: tuple[float, float, Sequence[tuple[str, dict[str, object]]]], speed: float = 0.7
) -> Record:
    """A record of a robot that drives straight to each spot, where something happens."""
    record = Record("demo", ("Alice",))
    time, (x, y) = 0.0, legs[0][:2]
    for to_x, to_y, happenings in legs:
        steps = max(int(max(abs(to_x - x), abs(to_y - y)) / speed * 5), 1)
        for step in range(1, steps + 1):
            at = (x + (to_x - x) * step / steps, y + (to_y - y) * step / steps)
            record.samples.append(Sample(time, *at, 0.0, ((3.0, 6.0),)))
            time += 0.2
        x, y = to_x, to_y
        for kind, data in happenings:
            record.happenings.append(Happening(time, kind, dict(data), x, y))
            time += 2.0
    record.samples.append(Sample(time, x, y, 90.0, ((3.0, 6.0),)))
    return record


def says(text: str) -> tuple[str, dict[str, object]]:
    return ("speech", {"text": text, "language": "en"})


TOUR = run(
    (24.9, 5.3, [says("I'm on my way.")]),
    (20, 7.7, []),
    (8, 7.7, []),
    (4, 5, [says("Here we are at the pharmacy."), ("heard", {"text": "thanks", "person": "Paul"})]),
    (13, 7.7, []),
    (14.2, 17, [("grab", {"thing": "book"}), says("I have found the book. " * 6)]),
    (36, 17, []),
    (36, 20.5, [("give", {"thing": "book", "person": "Noah"}), says("This is for you!")]),
    (27, 17, []),
    (27, 7.7, []),
    (24.9, 5.3, [says("Done.")]),
)


@pytest.fixture(scope="module")
def hospital() -> World:
    return load_world("city-hospital")


def words_of(picture: str) -> str:
    """All text that is shown, in the order of the picture."""
    root = ElementTree.fromstring(picture)
    return " ".join(element.text or "" for element in root.iter(f"{SVG}text"))


def box_of(text: Text) -> Box:
    width = text_width(text.text, text.size)
    left = text.x - {"start": 0.0, "middle": 0.5, "end": 1.0}[text.anchor] * width
    return Box(left, text.y - text.size * 0.72, left + width, text.y + text.size * 0.2)


def bubbles(scene: Scene) -> list[Box]:
    areas = scene.layers.get("bubbles", [])
    return [box_about(shape.points) for shape in areas if isinstance(shape, Area)]


# --- floors --------------------------------------------------------------------------------------


@pytest.mark.parametrize("name", builtin_worlds())
def test_every_place_is_named_and_no_name_is_cut_or_covered(name: str) -> None:
    world = load_world(name)
    scene = draw_floor(world).scene
    labels = [shape for shape in scene.layers["names"] if isinstance(shape, Text)]
    shown = " ".join(label.text for label in labels)
    assert all(place.name in shown for place in world.places)
    assert all(person.name in shown for person in world.people if person.at)
    whole = Box(0, 0, scene.width, scene.height)
    boxes = [box_of(label) for label in labels]
    assert all(box.within(whole) for box in boxes)
    for one, two in itertools.combinations(labels, 2):
        assert not box_of(one).covers(box_of(two)), f"{one.text} covers {two.text}"


def test_the_floor_can_be_drawn_upon_live(hospital: World) -> None:
    root = ElementTree.fromstring(floor_svg(hospital, people=False))
    live = next(group for group in root.iter(f"{SVG}g") if group.get("id") == "live")
    numbers = [float(part) for part in str(live.get("transform"))[7:-1].split()]
    scale, left, top = (float(root.attrib[f"data-{name}"]) for name in ("scale", "left", "top"))
    assert numbers == [scale, 0, 0, -scale, left, top]
    width, height = (float(root.attrib[side]) for side in ("width", "height"))
    x, y = left + 40 * scale, top - 25 * scale
    assert 0 < left < x < width
    assert 0 < y < top < height
    assert "Alice" not in words_of(floor_svg(hospital, people=False))


def test_pixels_and_svg_show_the_same_scene(hospital: World) -> None:
    floor = draw_floor(hospital)
    image = to_image(floor.scene)
    assert image.size == (round(floor.scene.width + 0.5), round(floor.scene.height + 0.5))
    u, v = floor.frame.spot(7, 3)
    colour = tuple(int(WALL[i : i + 2], 16) for i in (1, 3, 5))
    assert image.getpixel((round(u), round(v))) == colour
    assert len(image.getcolors(1 << 24) or []) > 100


def test_a_world_of_names_alone_has_a_picture_too() -> None:
    world = World(name="words", places=(Place(name="lobby", kind="lobby"),))
    assert ElementTree.fromstring(floor_svg(world)).tag == f"{SVG}svg"


# --- runs ----------------------------------------------------------------------------------------


def test_what_was_said_stands_where_it_was_said(hospital: World) -> None:
    text = words_of(svg(hospital, TOUR))
    for part in (
        "city-hospital",
        "“I'm on my way.”",
        "“Here we are at the pharmacy.”",
        "Paul: “thanks”",
        "picks up book",
        "gives book to Noah",
    ):
        assert part in text
    assert f"{TOUR.distance:.1f} m driven" in text
    assert [stop.numbers for stop in stops_of(TOUR)] == ["1, 5", "2", "3", "4"]


def test_bubbles_cover_nothing_and_no_leader_runs_through_one(hospital: World) -> None:
    scene, _ = draw_run(hospital, TOUR)
    boxes = bubbles(scene)
    assert len(boxes) == 4
    for one, two in itertools.combinations(boxes, 2):
        assert not one.covers(two)
    names = [shape for shape in scene.layers["names"] if isinstance(shape, Text)]
    for box in boxes:
        assert box.within(Box(0, 0, scene.width, scene.height))
        assert not [name.text for name in names if box.covers(box_of(name))]
    leaders = [shape for shape in scene.layers["leaders"] if isinstance(shape, Line)]
    for leader in leaders:
        inside = [box for box in boxes if _cuts(box.grown(-2), leader.points[0], leader.points[1])]
        assert not inside
    for text in scene.layers["bubbles"]:
        if isinstance(text, Text):
            assert any(box_of(text).within(box) for box in boxes), text.text


def test_a_talkative_robot_is_quoted_in_full(hospital: World) -> None:
    sayings = [f"Sentence number {number} of a long speech." for number in range(40)]
    long = run((10, 7.75, [says(text) for text in sayings]), (30, 7.75, [says("word " * 300)]))
    text = words_of(svg(hospital, long))
    for number in range(40):
        assert f"Sentence number {number} of" in text
    assert text.count("word") >= 300


def test_forty_stops_still_make_a_picture(hospital: World) -> None:
    spots = [(1.5 + number * 0.9, 7.2 + number % 2, number) for number in range(40)]
    many = run(*((x, y, [says(f"This is stop {number}.")]) for x, y, number in spots))
    scene, _ = draw_run(hospital, many)
    for one, two in itertools.combinations(bubbles(scene), 2):
        assert not one.covers(two)
    text = " ".join(shape.text for shape in scene.shapes() if isinstance(shape, Text))
    assert all(f"This is stop {number}." in text for number in range(40)), "in the list below"


def test_what_is_said_cannot_break_the_picture(hospital: World) -> None:
    hostile = "<script>alert('x')</script> & \"quotes\" \x00\x1b ]]> 你好 Öl"
    picture = svg(hospital, run((10, 7.75, [says(hostile)])))
    assert "<script>" not in picture
    assert "alert('x')" in words_of(picture)


def test_an_empty_record_is_the_floor(hospital: World, tmp_path: Path) -> None:
    assert "ward a" in words_of(svg(hospital, Record("city-hospital")))
    only_said = Record("city-hospital", happenings=[Happening(1, "speech", {"text": "Hi"}, 5, 7)])
    assert "“Hi”" in words_of(svg(hospital, only_said))
    png(hospital, None, tmp_path / "floor.png")
    assert Image.open(tmp_path / "floor.png").width > 1000


def test_the_picture_of_a_run_of_the_simulator(tmp_path: Path) -> None:
    import threading

    from sim.simulation import Simulation

    world = load_world("ward")
    with Simulation(world) as simulation:
        never = threading.Event()
        simulation.run(simulation.drive_to(*simulation.locate("ward b")), never)
        simulation.run(simulation.speak("Lunch is ready, Henry."), never)
        record = from_json(to_json(simulation.record))
    png(world, record, tmp_path / "run.png")
    with Image.open(tmp_path / "run.png") as image:
        assert image.format == "PNG"
        assert image.width > 800
    assert "Lunch is ready, Henry." in words_of(svg(world, record))
    assert record.distance > 5


@pytest.mark.parametrize("kind", EVENTS)
def test_of_what_a_robot_tells_a_few_things_make_the_story(kind: str) -> None:
    pictured = {"speech", "heard", "screen", "emotion", "gesture", "call", "stopped"}
    assert (told(happened(kind, text="Hello")) is not None) == (kind in pictured)


def test_what_only_its_own_capability_knows_is_in_the_story_as_it_is() -> None:
    assert told(happened("light", color="red")) == "light: red"


def happened(kind: str, **data: Any) -> Happening:
    return Happening(0.0, kind, data, 0.0, 0.0)


def test_a_standing_robot_makes_a_stop_without_words() -> None:
    waiting = Record("ward")
    for time, x in [(0, 1), (1, 2), (2, 4), (12, 4), (13, 6), (14, 8), (40, 8)]:
        waiting.samples.append(Sample(float(time), float(x), 1.5, 0.0))
    assert [(stop.x, stop.lines) for stop in stops_of(waiting)] == [(4.0, [])], "not at its ends"


# --- text ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("letter", list("äöüÄÖÜéèêàçôûñåšÉÇ"))
def test_accents_are_drawn_on_their_letters(letter: str) -> None:
    import unicodedata

    plain = unicodedata.normalize("NFD", letter)[0]
    assert text_width(letter, 40) == text_width(plain, 40), "no empty box of another width"
    images = []
    for text in (letter, plain):
        image = Image.new("L", (80, 100))
        draw_text(ImageDraw.Draw(image), (40, 70), text, 40, "#ffffff", "middle")
        images.append(image)
    ink = [sum(image.histogram()[128:]) for image in images]
    assert ink[0] > ink[1] + 5


@given(text=st.text(max_size=120), width=st.floats(20, 300))
@example(text="0ŒI´‘", width=20.0)
@settings(max_examples=80, deadline=None)
def test_wrapped_text_fits_and_is_complete(text: str, width: float) -> None:
    lines = wrapped(text, 12, width, 10_000)
    assert "".join("".join(lines).split()) == "".join(text.split())
    assert all(text_width(line, 12) <= width or len(line) == 1 for line in lines)
    assert len(wrapped(text, 12, width, 2)) <= 2


# --- moving pictures -----------------------------------------------------------------------------


@pytest.mark.parametrize("end", [".webp", ".gif", ".png"])
def test_a_run_as_a_moving_picture(tmp_path: Path, end: str) -> None:
    world = load_world("ward")
    short = run((1, 1.5, []), (3, 1.5, [says("Good morning!")]), (3, 5, [says("Tea or coffee?")]))
    file = tmp_path / f"run{end}"
    animate(world, short, file)
    with Image.open(file) as image:
        frames = getattr(image, "n_frames", 1)
        assert frames > 10
        first = image.convert("RGB")
        image.seek(frames - 1)
        assert image.convert("RGB").tobytes() != first.tobytes()


def test_two_minutes_of_the_hospital_stay_small(hospital: World, tmp_path: Path) -> None:
    back_and_forth = [(x, 7.75, [says(f"I am at {x} metres.")]) for x in (2, 38, 2, 26)]
    record = run(*back_and_forth)
    assert 110 < record.duration < 200
    animate(hospital, record, tmp_path / "run.webp")
    assert (tmp_path / "run.webp").stat().st_size < 2_000_000


def test_no_moving_picture_of_nothing(hospital: World, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="Nothing was recorded"):
        animate(hospital, Record("city-hospital"), tmp_path / "run.gif")
    with pytest.raises(ValueError, match=r"\.webp, \.gif or \.png"):
        animate(hospital, TOUR, tmp_path / "run.mp4")
    still = Record("ward", samples=[Sample(0, 1, 1, 0)])
    animate(load_world("ward"), still, tmp_path / "still.gif")


# --- anything ------------------------------------------------------------------------------------

spots = st.tuples(st.floats(-20, 20), st.floats(-20, 20))
names = st.text(max_size=30).filter(str.strip)


@given(
    places=st.lists(st.tuples(names, spots), max_size=5),
    legs=st.lists(st.tuples(spots, st.lists(st.text(max_size=80), max_size=3)), max_size=5),
)
@settings(max_examples=25, deadline=None)
def test_any_world_and_any_run_have_a_picture(
    places: list[tuple[str, tuple[float, float]]],
    legs: list[tuple[tuple[float, float], list[str]]],
) -> None:
    world = World(
        name="any",
        places=tuple(Place(name=name, kind="room", pose=Pose(*spot)) for name, spot in places),
    )
    record = (
        run(*((*spot, [says(text) for text in texts]) for spot, texts in legs))
        if legs
        else (Record("any"))
    )
    ElementTree.fromstring(svg(world, record))
