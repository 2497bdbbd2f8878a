"""What happens in a ward, and what it begins."""

from __future__ import annotations

import itertools
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nl2robot.schedule.topics import matches
from nl2robot.schedule.triggers import (
    GONE_AFTER,
    SHORTEST,
    BadTrigger,
    Trigger,
    Watch,
    checked,
)

GREETS, CHARGES = 1, 2


def watch(*triggers: Trigger, last: dict[int, float] | None = None) -> Watch:
    return Watch(dict(enumerate(triggers, 1)), last or {})


def low(percent: float, charging: bool = False) -> dict[str, Any]:
    return {"percent": percent, "charging": charging}


def test_a_visitor_is_greeted_once_and_the_next_one_too() -> None:
    desk = watch(Trigger(what="seen", thing="person", place="lobby", every=SHORTEST))
    person = {"thing": "person", "there": True}
    assert desk.happened("seen", person, 0) == []  # wherever that was
    desk.happened("pose", {"place": "lobby"}, 90)
    assert desk.looks_for() == ["person"]
    assert desk.happened("seen", person, 100) == [GREETS]
    for second in range(101, 130):
        assert desk.happened("seen", person, second) == []  # still the same one
    assert desk.happened("seen", {"thing": "person", "there": False}, 131) == []
    assert desk.happened("seen", person, 129 + GONE_AFTER) == [GREETS]
    desk.happened("pose", {"place": "corridor"}, 200)
    assert desk.looks_for() == []


def test_a_battery_that_trembles_is_low_once() -> None:
    ward = watch(Trigger(what="battery", below=20, every=SHORTEST))
    readings = [25, 21, 19, 20, 19, 24, 19, 26, 19]
    due = [
        ward.happened("battery", low(percent), 100 * index)
        for index, percent in enumerate(readings)
    ]
    assert due == [[], [], [1], [], [], [], [], [], [1]]


def test_who_charges_already_is_not_sent_to_charge() -> None:
    ward = watch(Trigger(what="battery", below=20))
    assert ward.happened("battery", low(10, charging=True), 0) == []
    assert ward.happened("battery", low(11, charging=True), 500) == []
    assert ward.happened("battery", low(12), 1000) == []  # taken from the charger, as low as before
    assert ward.happened("battery", low(60), 2000) == []
    assert ward.happened("battery", low(19), 3000) == [1]


def test_a_low_battery_is_seen_at_the_first_look_but_not_again_after_a_restart() -> None:
    trigger = Trigger(what="battery", below=20, every=3600)
    assert watch(trigger).happened("battery", low(10), 1000) == [1]
    assert watch(trigger, last={1: 1000}).happened("battery", low(10), 1100) == []
    assert watch(trigger, last={1: 1000}).happened("battery", low(10), 1000 + 3600) == [1]


def test_where_it_stands_from_the_first_is_not_where_it_comes_to() -> None:
    round_trip = watch(Trigger(what="place", place="lobby"))
    places = ["lobby", "lobby", "corridor", "lobby", "lobby"]
    due = [round_trip.happened("pose", {"place": place}, 100 * i) for i, place in enumerate(places)]
    assert due == [[], [], [], [1], []]


def test_where_it_was_when_somebody_wished_it_is_where_it_comes_from() -> None:
    wish = {1: Trigger(what="place", place="lobby")}
    in_corridor = Watch(wish, {}, place=None, located=True)
    assert in_corridor.happened("pose", {"place": "lobby"}, 0) == [1]
    in_lobby = Watch(wish, {}, place="lobby", located=True)
    assert in_lobby.happened("pose", {"place": "lobby"}, 0) == []


def test_words_are_heard_as_words() -> None:
    room = watch(Trigger(what="heard", text="help me", every=SHORTEST))
    said = ["Help me, please!", "Can you HELP me?", "help meat", "me help", "Hilf mir"]
    due = [room.happened("heard", {"text": text}, 100 * i) for i, text in enumerate(said)]
    assert due == [[1], [1], [], [], []]


def test_the_house_presses_and_scans() -> None:
    ward = watch(
        Trigger(what="message", topic="ward-3/+/call", text="pressed"),
        Trigger(what="message", topic="ward-3/#"),
        Trigger(what="scanned", text="4006381333931"),
        Trigger(what="scanned"),
        Trigger(what="pressed", text="call a nurse"),
    )
    assert ward.topics() == {"ward-3/+/call", "ward-3/#"}
    assert ward.buttons() == ["call a nurse"]
    assert ward.happened("message", {"topic": "ward-3/12/call", "text": "pressed"}, 0) == [1, 2]
    assert ward.happened("message", {"topic": "ward-4/12/call", "text": "pressed"}, 100) == []
    assert ward.happened("message", {"topic": "ward-3/12/call", "text": "over"}, 100) == [2]
    assert ward.happened("scanned", {"code": "4006381333931"}, 200) == [3, 4]
    assert ward.happened("scanned", {"code": "12"}, 300) == [4]
    assert ward.happened("pressed", {"button": "call a nurse"}, 400) == [5]
    assert ward.happened("pressed", {"button": "?"}, 500) == []


def test_what_is_added_and_taken_away_meanwhile() -> None:
    one, two = Trigger(what="battery", below=20), Trigger(what="battery", below=50)
    ward = Watch({1: one}, {})
    assert ward.happened("battery", low(15), 0) == [1]
    ward.now({1: one, 2: two})
    assert ward.happened("battery", low(14), 1000) == [2]
    ward.now({2: two})
    assert ward.happened("battery", low(80), 2000) == []
    assert ward.happened("battery", low(10), 3000) == [2]


@given(
    st.floats(SHORTEST, 10_000),
    st.lists(st.tuples(st.floats(0, 1000), st.booleans()), max_size=60),
)
def test_nothing_happens_more_often_than_it_may(
    every: float, said: list[tuple[float, bool]]
) -> None:
    ward = watch(Trigger(what="message", topic="call", every=every))
    now, due = 0.0, []
    for later, call in said:
        now += later
        if ward.happened("message", {"topic": "call" if call else "other", "text": ""}, now):
            due.append(now)
    assert all(after - before >= every for before, after in itertools.pairwise(due))
    first = next((t for t, (_, call) in zip(_times(said), said, strict=True) if call), None)
    assert due[:1] == ([first] if first is not None else [])


def _times(said: list[tuple[float, bool]]) -> list[float]:
    now, times = 0.0, []
    for later, _ in said:
        now += later
        times.append(now)
    return times


def test_a_clock_that_was_set_back_silences_nobody() -> None:
    ward = watch(Trigger(what="message", topic="call"))
    call = {"topic": "call", "text": ""}
    assert ward.happened("message", call, 1e9) == [1]
    assert ward.happened("message", call, 5e8) == [1]


@pytest.mark.parametrize(
    ("trigger", "says"),
    [
        (Trigger(what="seen"), "needs 'thing'"),
        (Trigger(what="place"), "needs 'place'"),
        (Trigger(what="heard", text=" "), "needs 'text'"),
        (Trigger(what="pressed"), "needs 'text'"),
        (Trigger(what="message"), "needs 'topic'"),
        (Trigger(what="message", topic="ward/#/call"), "no topic of MQTT"),
        (Trigger(what="battery"), "say how many"),
        (Trigger(what="battery", below=100), "say how many"),
        (Trigger(what="scanned", text="x" * 201), "200 letters"),
        (Trigger(what="scanned", every=0), "every 5 seconds at most"),
        (Trigger(what="scanned", every=float("nan")), "every 5 seconds at most"),
    ],
)
def test_what_makes_no_sense_is_said_to(trigger: Trigger, says: str) -> None:
    with pytest.raises(BadTrigger, match=says):
        checked(trigger)


@pytest.mark.parametrize(
    ("topic", "means", "not_"),
    [
        ("a/b", "a/b", "a"),
        ("a/+", "a/b", "a/b/c"),
        ("a/#", "a/b/c", "b"),
        ("a/#", "a", "ab"),
        ("+/b", "/b", "b"),
        ("#", "a/b", "$SYS/a"),
    ],
)
def test_topics_of_mqtt(topic: str, means: str, not_: str) -> None:
    assert matches(topic, means)
    assert not matches(topic, not_)
