"""Whatever a file holds, loading it gives a world or a WorldError; and what is written is read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from sim.world.loading import load_world
from sim.world.model import World, WorldError
from sim.world.reader import _Reader

FIELDS = sorted({word for fields in _Reader.FIELDS.values() for word in fields.split()})
MODEST = settings(
    max_examples=120, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)

scalars = (
    st.none()
    | st.booleans()
    | st.integers(-(10**12), 10**12)
    | st.floats()
    | st.text(max_size=12)
    | st.sampled_from(["charger", "ward a", "m", "cm", "floor.pgm", "en"])
)
documents = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=5)
        | st.dictionaries(st.sampled_from([*FIELDS, "de", "en"]), inner, max_size=6)
    ),
    max_leaves=25,
)


def load(folder: Path, text: str | bytes) -> World:
    file = folder / "any.yaml"
    file.write_bytes(text if isinstance(text, bytes) else text.encode("utf-8", "replace"))
    return load_world(file)


@MODEST
@given(document=documents)
def test_any_data_is_a_world_or_is_refused(tmp_path: Path, document: Any) -> None:
    check(tmp_path, yaml.safe_dump(document, allow_unicode=True))


@MODEST
@given(document=st.dictionaries(st.sampled_from(FIELDS), documents, max_size=8))
def test_any_fields_are_a_world_or_are_refused(tmp_path: Path, document: Any) -> None:
    check(tmp_path, yaml.safe_dump(document))


@MODEST
@given(
    text=st.text(alphabet="ab:{}[],-&*!|>'\"%@`#?\n\t \0é", max_size=60) | st.binary(max_size=60)
)
def test_any_characters_are_a_world_or_are_refused(tmp_path: Path, text: str | bytes) -> None:
    check(tmp_path, text)


def check(folder: Path, text: str | bytes) -> None:
    try:
        world = load(folder, text)
    except WorldError as error:
        assert error.problems
        assert all(problem.message.endswith((".", "?")) for problem in error.problems)
        assert len(str(error).splitlines()) == len(error.problems)
    else:
        # What has been loaded can be asked.
        assert world.start is None or world.has_geometry
        world.place_at(0, 0)
        assert world.bounds[0] <= world.bounds[2]


names = (
    st.text(alphabet="abcdefghäöü0'- ", min_size=1, max_size=12)
    .map(lambda text: " ".join(text.split()))
    .filter(bool)
)
coordinates = st.floats(-900, 900, allow_nan=False).map(lambda x: round(x, 3))


@st.composite
def worlds(draw: st.DrawFn) -> dict[str, Any]:
    unique = draw(st.lists(names, min_size=1, max_size=6, unique_by=str.casefold))
    places = [
        {
            "name": name,
            "kind": draw(names),
            "pose": [draw(coordinates), draw(coordinates), draw(st.integers(-180, 180))],
        }
        for name in unique
    ]
    things = [
        {"name": draw(names), "at": draw(st.sampled_from(unique)), "is": draw(st.lists(names))}
        for _ in range(draw(st.integers(0, 4)))
    ]
    people = [
        {"name": name, "at": draw(st.sampled_from(unique)), "answers": draw(st.lists(names))}
        for name in draw(st.lists(names, max_size=4, unique_by=str.casefold))
    ]
    return {
        "name": draw(names),
        "units": draw(st.sampled_from(["m", "cm"])),
        "robot": {"start": draw(st.sampled_from(unique))},
        "places": places,
        "people": people,
        "objects": things,
    }


@MODEST
@given(document=worlds())
def test_what_is_written_is_read(tmp_path: Path, document: dict[str, Any]) -> None:
    world = load(tmp_path, yaml.safe_dump(document, allow_unicode=True))
    metre = 1.0 if document["units"] == "m" else 0.01
    assert world.name == document["name"]
    assert [place.name for place in world.places] == [p["name"] for p in document["places"]]
    for place, written in zip(world.places, document["places"], strict=True):
        assert place.pose is not None
        assert place.pose.x == pytest.approx(written["pose"][0] * metre)
        assert place.pose.y == pytest.approx(written["pose"][1] * metre)
        assert place.kind == written["kind"]
    for thing, written in zip(world.objects, document["objects"], strict=True):
        assert (thing.name, thing.at, list(thing.is_)) == tuple(written.values())
    for person, written in zip(world.people, document["people"], strict=True):
        assert (person.name, person.at, list(person.answers)) == tuple(written.values())
    assert world.start is not None
