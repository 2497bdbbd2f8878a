"""A past run once more, in the simulator."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.run.going_on import recall_of
from nl2robot.run.replay import replay
from nl2robot.run.runlog import Run, RunLog
from nl2robot.station.pictures import check_picture, draw
from nl2robot.texts import texts_in
from sim.simulation import Simulation
from sim.world.loading import load_world


def replayed(log: RunLog, row: Run, terminal: Terminal, picture: str | None) -> int:
    """Run it again in the simulator, as it was; the exit status. Raises `UserError`."""
    if row.seed is None or row.world is None:
        raise UserError(
            f"Run {row.id} was not simulated, so it cannot be replayed."
            f" See what happened in it with: nl2robot log {row.id}."
        )
    if picture is not None:
        check_picture(Path(picture))
    world = load_world(row.world)
    simulation = Simulation(world, seed=row.seed)

    def on_call(line: int, method: str, arguments: dict[str, Any]) -> None:
        about = {"what": "call", "line": line, "method": method, "arguments": arguments}
        terminal.show_event("program", about)

    words = texts_in(terminal.language, "log")
    recall = recall_of(log, row.continues)
    again = replay(row, log.calls(row.id), simulation, on_call, recall)
    terminal.show_end(again.status, again.message)
    for each in again.differences:
        terminal.console.print(each, style="yellow", markup=False)
    if not again.differences:
        terminal.console.print(words["same"], markup=False)
    if picture is not None:
        draw(simulation.record, world, Path(picture))
        told = words["picture"].format(file=picture)
        terminal.console.print(told, soft_wrap=True, markup=False)
    return ExitStatus.OK if not again.differences else ExitStatus.FAILED
