"""When a simulation starts, as people write it: "08:00", or with the day "2026-12-24 18:00"."""

from __future__ import annotations

from datetime import datetime

from sim.world.model import World
from sim.world.yaml_nodes import short

OPENING = datetime(2026, 3, 2, 8, 0)  # a Monday
"""When a simulation starts if nobody says, by the clocks of the world's zone."""


def starting(said: str) -> tuple[datetime, bool]:
    """That moment, without a zone, and whether only its time of day was said. Raises `ValueError`
    with a sentence."""
    for form, daily in (("%H:%M", True), ("%Y-%m-%d %H:%M", False), ("%Y-%m-%dT%H:%M", False)):
        try:
            return datetime.strptime(said, form), daily
        except ValueError:
            continue
    raise ValueError(
        f'"{short(said)}" is no time to start at. Write "08:00", or with the day'
        ' "2026-12-24 18:00", in quotes.'
    )


def beginning(world: World, start: datetime | None) -> datetime:
    """When a simulation of it starts: then, else as the world's file says, else at the `OPENING`;
    what has no zone is by the clocks of the world, or in UTC."""
    moment = start or world.clock.starts(OPENING)
    return moment if moment.tzinfo is not None else moment.replace(tzinfo=world.clock.zone_info)
