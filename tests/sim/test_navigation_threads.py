"""A dry run plans its ways on the chart that the live simulation uses at the same moment."""

from __future__ import annotations

import random
import threading

from sim.physics.navigation import Chart
from sim.world.model import World


def test_a_chart_answers_several_threads(hospital: World) -> None:
    """GEOS's prepared shapes do not bear this: without turns the process dies."""
    chart = Chart(hospital.walls, [piece.outline for piece in hospital.furniture])
    start = hospital.start
    assert start is not None
    found: list[bool] = []

    def plan(seed: int) -> None:
        where = random.Random(seed)
        for _ in range(50):
            goal = where.uniform(1, 40), where.uniform(1, 20)
            found.append(chart.route((start.x, start.y), goal) is not None)

    threads = [threading.Thread(target=plan, args=(seed,)) for seed in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(found) == 300
    assert any(found)
