"""When a simulated day begins beside the real one."""

from __future__ import annotations

from datetime import UTC, datetime
from zoneinfo import ZoneInfo

import pytest

from nl2robot.errors import UserError
from nl2robot.station import local_clock
from nl2robot.station.local_clock import beginning_of, moment_in
from sim.world.model import Clock, World

EVENING = datetime(2026, 11, 20, 19, 15, tzinfo=UTC)


@pytest.fixture(autouse=True)
def evening(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(local_clock, "local_now", lambda: EVENING)


def world(start: datetime | None = None, daily: bool = False, zone: str | None = None) -> World:
    return World(name="ward", clock=Clock(start=start, daily=daily, zone=zone))


@pytest.mark.parametrize(
    "ward, said, begins",
    [
        (world(), None, "2026-11-20 19:15 UTC"),
        (world(zone="Europe/Zurich"), None, "2026-11-20 20:15 CET"),
        (world(datetime(2000, 1, 1, 6, 30), daily=True), None, "2026-11-20 06:30 UTC"),
        (world(datetime(2026, 7, 1, 6), zone="Europe/Zurich"), None, "2026-07-01 06:00 CEST"),
        # what is said counts before what is written
        (world(datetime(2026, 7, 1, 6)), "08:00", "2026-11-20 08:00 UTC"),
        (world(zone="Europe/Zurich"), "2026-12-24 18:00", "2026-12-24 18:00 CET"),
    ],
)
def test_it_is_now_unless_somebody_says_otherwise(
    ward: World, said: str | None, begins: str
) -> None:
    assert f"{beginning_of(ward, said):%Y-%m-%d %H:%M %Z}" == begins


def test_a_moment_is_by_the_clocks_of_the_house_unless_it_says_by_which() -> None:
    zurich = world(zone="Europe/Zurich")
    assert moment_in(zurich, "2026-12-24T06:00").tzinfo == ZoneInfo("Europe/Zurich")
    assert moment_in(zurich, "2026-12-24T06:00+00:00").utcoffset() == UTC.utcoffset(None)
    with pytest.raises(UserError, match="no date and time"):
        moment_in(zurich, "tomorrow")
