"""How fast Pepper's wire is, measured on the stand-in: `python -m tests.robots.pepper.measure`.

Prints what docs/robots/pepper.md says.
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Sequence
from typing import Any

from robot_api.robots.address import parse
from robot_api.robots.pepper import PEPPER, PepperSettings
from robot_api.robots.registry import Setup
from tests.robots.pepper.conftest import MAP, PLACES, Call, StandIn, call, until

CALLS = 2000
STOPS = 50
LOSSES = 5
AT_ONCE = 1e6
"""A braking that takes no time: what is left is ours and the wire's."""


def driver_of(pepper: StandIn) -> Any:
    address = parse(f"pepper://127.0.0.1:{pepper.port}")
    return PEPPER.connect(Setup(address=address, settings=PepperSettings(map=MAP), places=PLACES))


def tell(what: str, seconds: Sequence[float]) -> None:
    ordered = sorted(1000 * each for each in seconds)
    at_95 = ordered[round(0.95 * (len(ordered) - 1))]
    print(
        f"{what}: median {statistics.median(ordered):.1f} ms, 95% {at_95:.1f} ms,"
        f" worst {ordered[-1]:.1f} ms ({len(ordered)} runs)"
    )


def light_calls() -> list[float]:
    pepper = StandIn()
    driver = driver_of(pepper)
    took = []
    for _ in range(CALLS):
        began = time.perf_counter()
        call(driver, "battery")
        took.append(time.perf_counter() - began)
    driver.close()
    pepper.close()
    return took


def stops(braking: float) -> tuple[list[float], list[float]]:
    """From the stop to zero speed, and to its confirmation here."""
    pepper = StandIn(braking=braking)
    driver = driver_of(pepper)
    stood, confirmed = [], []
    for run in range(STOPS):
        driving = Call(driver, "move", metres=2 if run % 2 else -2)
        assert until(lambda: pepper.speed > 0.3)
        began = time.monotonic()
        driving.stop.set()
        driver.stop("measured")
        confirmed.append(time.monotonic() - began)
        stood.append(pepper.stood_at - began)
        assert driving.over()
    driver.close()
    pepper.close()
    return stood, confirmed


def losses(how: str) -> list[float]:
    """From a robot that is dead to everybody knowing it."""
    took = []
    for _ in range(LOSSES):
        pepper = StandIn()
        driver = driver_of(pepper)
        told: list[float] = []
        driver.subscribe(
            lambda kind, _, told=told: told.append(time.monotonic()) if kind == "link" else None
        )
        began = time.monotonic()
        getattr(pepper, how)()
        assert until(lambda told=told: told)
        took.append(told[0] - began)
        driver.close()
        pepper.close()
    return took


def main() -> None:
    took = light_calls()
    print(f"light calls: {len(took) / sum(took):.0f} a second")
    tell("round trip of a light call", took)
    for name, braking in (("brakes in no time", AT_ONCE), ("brakes at 1 m/s²", 1.0)):
        stood, confirmed = stops(braking)
        tell(f"stop to zero speed, a robot that {name}", stood)
        tell(f"stop to its confirmation, a robot that {name}", confirmed)
    tell("until a killed robot is known to be lost", losses("kill"))
    tell("until a frozen robot is known to be lost", losses("freeze"))


if __name__ == "__main__":
    main()
