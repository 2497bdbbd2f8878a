"""What is said at the desk goes by the clock of the station, as the appointments do."""

from __future__ import annotations

from pathlib import Path

from nl2robot.console.desk.dialogue import Dialogue
from nl2robot.run.runlog import RunLog
from nl2robot.schedule.service import Timing
from nl2robot.station.part import Backstage
from nl2robot.station.station import simulated_station
from sim.world.loading import load_world
from tests.schedule.conftest import Clock


def test_tomorrow_is_the_day_after_the_stations(tmp_path: Path) -> None:
    behind_the_scenes: list[Backstage] = []
    clock = Clock()
    clock.set("2026-12-31 09:00")
    log = RunLog(tmp_path / "runs.sqlite")
    with simulated_station(
        load_world("ward"),
        log,
        seed=1,
        console=behind_the_scenes.append,
        timing=Timing(clock=clock),
    ):
        dialogue = Dialogue(behind_the_scenes[0], "test")
        dialogue.say("tomorrow at eleven go to ward a", "en", "Nurse Kim")
        draft = dialogue.draft
        assert draft is not None and draft.times is not None and draft.review is not None
        assert draft.times.rhythm.begins.isoformat() == "2027-01-01T11:00:00"
        assert "tomorrow, Friday, 1 January 2027, at 11:00" in dialogue.lines[-1].text
        dialogue.say("at eight go to ward a", "en", "Nurse Kim")
        assert dialogue.lines[-1].tone == "question"
        assert "today at 20:00 or tomorrow at 08:00" in dialogue.lines[-1].text
    log.close()
