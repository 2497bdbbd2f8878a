"""How fast the simulator is: a busy hospital floor, all of it stepped on one core."""

from __future__ import annotations

import threading
import time

import msgspec

from sim.errors import SimError
from sim.hospital import RAYS, chart_of
from sim.simulation import Simulation
from sim.world.loading import load_world
from sim.world.model import Person, World

PEOPLE = 10


def measure(seconds: float = 300.0) -> dict[str, float]:
    """Let a robot drive from place to place for so many simulated seconds among ten people who
    all walk about, the lidar on; returns what was measured, times in seconds of real time."""
    world = _busy(load_world("city-hospital"))
    begin = time.perf_counter()
    chart_of(world)
    built = time.perf_counter() - begin
    simulation = Simulation(world, seed=1)
    begin = time.perf_counter()
    simulation.copy()
    copied = time.perf_counter() - begin

    begin, begin_cpu = time.perf_counter(), time.thread_time()
    _tour(simulation, seconds)
    real, cpu = time.perf_counter() - begin, time.thread_time() - begin_cpu
    return {
        "people": float(len(simulation.world.people)),
        "rays": float(RAYS),
        "simulated_seconds": simulation.time,
        "times_real_time": simulation.time / real,
        "times_real_time_of_cpu": simulation.time / cpu,
        "metres_driven": simulation.record.distance,
        "build_map_seconds": built,
        "copy_seconds": copied,
    }


def _busy(world: World) -> World:
    """The world with ten people who walk all day."""
    places = [place.name for place in world.places if place.pose is not None]
    walkers = tuple(
        Person(name=f"walker {i}", at=places[2 * i], walks=tuple(places[i::4]))
        for i in range(PEOPLE)
    )
    return msgspec.structs.replace(world, people=walkers)


def _tour(simulation: Simulation, seconds: float) -> None:
    never = threading.Event()
    places = [place.name for place in simulation.world.places]
    stops = iter(places * (2 + int(seconds / 5 / len(places))))
    while simulation.time < seconds:
        try:
            simulation.run(simulation.drive_to(*simulation.locate(next(stops))), never)
        except SimError:
            simulation.run(simulation.wait(5), never)
