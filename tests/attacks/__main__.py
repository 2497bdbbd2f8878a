"""All attacks, one after the other, in one table.

    python -m tests.attacks [--minutes M] [--seed S]

Stops while somebody attacks, a million inputs, 500 kills, and what befalls disk, log and clock;
each part is a command of its own as well (`stops`, `wire`, `fuzz`, `kills`, `disasters`). In fewer
minutes than an hour, as many fewer of all. Exits with 1 if anything was lost, was run unapproved,
printed a traceback, or if an answer was no sentence.
"""

from __future__ import annotations

import argparse
import logging
import sys
import time
from typing import Final

from tests.attacks import disasters, fuzz, kills, stops, wire
from tests.attacks.outcome import Row, report, say

MINUTES: Final = 60.0
"""Of the whole."""
INPUTS: Final = 1_000_000
ON_THE_WIRE: Final = 0.6
"""Of all inputs."""
KILLS: Final = 500
DISASTERS: Final = 36
"""Of each of the three kinds."""
SECONDS_OF_STOPS: Final = 25.0
"""For each attack."""


def attacked(seed: int, share: float) -> list[Row]:
    """`share` of all that there is to try."""
    rows: list[Row] = []
    say(f"Stops while somebody attacks, {SECONDS_OF_STOPS * share:.0f} s for each ...")
    rows += stops.measured(max(3.0, SECONDS_OF_STOPS * share))[0]
    inputs = round(INPUTS * share)
    say(f"{inputs:,} inputs ...")
    on_the_wire = round(inputs * ON_THE_WIRE)
    rows += wire.fuzzed(seed, on_the_wire)
    rows += fuzz.in_processes(seed, inputs - on_the_wire, list(fuzz.targets()))
    say(f"{KILLS * share:.0f} kills ...")
    rows += kills.all_killed(seed, round(KILLS * share))
    say("Disk, log and clock ...")
    rows += disasters.struck(seed, max(len(disasters.TAMPERINGS), round(DISASTERS * share)))
    return rows


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--minutes", type=float, default=MINUTES, help="about (default: an hour)")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    logging.disable()  # of clients whose server is gone
    began = time.monotonic()
    rows = attacked(given.seed, min(1.0, given.minutes / MINUTES))
    took = (time.monotonic() - began) / 60
    return report(rows, f"Attacks, seed {given.seed}, {took:.0f} minutes")


if __name__ == "__main__":
    sys.exit(main())
