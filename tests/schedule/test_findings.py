"""What is new in a review, and what is not."""

from __future__ import annotations

import pytest
from msgspec.structs import replace

from nl2robot.knowledge import Knowledge
from nl2robot.review.review import review
from nl2robot.schedule.findings import Findings, decoded, encoded, findings_of, news
from robot_api.driver import StopFlag
from robot_api.drivers import simulated
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import Zone

EVERY_WARD = 'for ward in robot.places("ward"):\n    robot.goto(ward)\n    robot.say("Hello!")\n'


def found(
    program: str,
    *,
    start: str | None = None,
    zones: tuple[Zone, ...] = (),
    alice: str = "ward a",
) -> Findings:
    world = load_world("ward")
    people = tuple(
        replace(each, at=alice, pose=None) if each.name == "Alice" else each
        for each in world.people
    )
    world = replace(world, people=people)
    simulation = Simulation(world)
    if zones:
        simulation.set_zones(zones)
    if start is not None:
        simulated(simulation).call("goto", {"place": start}, StopFlag())
    return findings_of(review(program, Knowledge(world), simulation))


def test_what_is_kept_is_what_was_found() -> None:
    kept = found(EVERY_WARD)
    assert decoded(encoded(kept)) == kept
    assert kept.places == ("ward a", "ward b") and kept.complete


def test_the_same_review_is_no_news() -> None:
    assert news(found(EVERY_WARD), found(EVERY_WARD)) == ()


def test_a_zone_in_the_way_is_news_and_its_end_is_none() -> None:
    zone = Zone("wet floor", ((7.0, 3.5), (11.0, 3.5), (11.0, 7.0), (7.0, 7.0)))
    before, after = found(EVERY_WARD), found(EVERY_WARD, zones=(zone,))
    assert {each.kind for each in news(before, after)} & {"risk", "closed", "fails"}
    assert all(each.kind not in ("risk", "closed", "fails") for each in news(after, before))


@pytest.mark.parametrize("change", ["ward", "error"])
def test_a_ward_more_and_another_failure_are_news(change: str) -> None:
    approved = found(EVERY_WARD)
    fields = {name: getattr(approved, name) for name in approved.__struct_fields__}
    if change == "ward":
        fields |= {"places": (*approved.places, "ward c")}
        [new] = news(approved, Findings(**fields))
        assert (new.kind, new.text) == ("place", "ward c")
    else:
        fields |= {"complete": False, "error": "Blocked", "message": "The door is locked."}
        [new] = news(approved, Findings(**fields))
        assert (new.kind, new.text) == ("fails", "The door is locked.")
        assert news(Findings(**fields), Findings(**fields)) == (), "somebody insisted on it"


def test_what_is_said_where_it_stands_is_no_other_place() -> None:
    program = 'robot.say("Hello!")\n'
    assert news(found(program), found(program, start="ward b")) == ()


def test_whoever_is_looked_for_may_have_gone_on() -> None:
    looks = 'if robot.find("Alice"):\n    robot.say("Please drink.")\n'
    before, after = found(looks), found(looks, alice="ward b")
    assert before.places != after.places and news(before, after) == ()
    there = 'robot.find("Alice", place="ward a")\n'
    assert not found(there).looks_everywhere
    older = encoded(before).replace(',"looks_everywhere":true', "")
    assert [each.kind for each in news(decoded(older), after)] == ["place"], "as it was kept then"
