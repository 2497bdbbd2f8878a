"""What clocks show where a robot is: when simulations and dry runs begin."""

from __future__ import annotations

from datetime import datetime

from nl2robot.errors import UserError
from robot_api.local_time import local_now
from sim.world.model import World
from sim.world.starts import starting


def now_in(world: World) -> datetime:
    """The real date and time, by the clocks of the world; where it does not say which, of this
    machine."""
    now = local_now()
    return now.astimezone(world.clock.zone_info) if world.clock.zone is not None else now


def beginning_of(world: World, said: str | None = None) -> datetime:
    """When a simulation of the world begins that goes on beside the real time: as is `said`
    ("08:00", "2026-12-24 18:00"), else as the world's file says, else now. A time of day alone is
    today's. Raises `ValueError` with a sentence."""
    now = now_in(world)
    if said is None:
        moment = world.clock.starts(now)
    else:
        moment, daily = starting(said)
        if daily:
            moment = datetime.combine(now, moment.time())
    return moment if moment.tzinfo is not None else moment.replace(tzinfo=now.tzinfo)


def moment_in(world: World, said: str) -> datetime:
    """A moment in ISO 8601, "2026-12-24T06:00"; without an offset, by the clocks of the world.
    Raises `UserError`."""
    try:
        moment = datetime.fromisoformat(said)
    except ValueError:
        raise UserError(
            f'"{said}" is no date and time. Write one such as "2026-12-24T06:00".'
        ) from None
    return moment if moment.tzinfo is not None else moment.replace(tzinfo=now_in(world).tzinfo)
