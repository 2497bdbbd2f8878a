"""The run that goes on, or the last one, as every page shows it: `desk.run`."""

from __future__ import annotations

from typing import Any, TypedDict

import msgspec

from nl2robot.console.desk.highlight import highlighted
from nl2robot.review.review import reading
from nl2robot.run.runs import State as RunState
from nl2robot.run.trouble import call_trouble, told
from nl2robot.station.part import Backstage


class LineShown(TypedDict):
    """A line of a program: its HTML, and what it says."""

    code: str
    reading: str


class CallShown(TypedDict):
    """A call of a run."""

    number: int
    line: int
    method: str
    arguments: dict[str, Any]
    result: Any
    error: str | None
    seconds: float | None


class RunShown(TypedDict):
    """`nl2robot.run.runs.Status` with what every page shows beside it."""

    run: int
    state: RunState
    line: int | None
    message: str | None
    error: str | None
    program: str
    sha256: str
    robot_lost_since: float | None
    utterance: str | None
    by: str | None
    started: float | None
    lines: list[LineShown]
    calls: list[CallShown]


def run_view(backstage: Backstage, language: str) -> dict[str, Any] | None:
    """The present or last run: how it stands, its lines with what they say in plain words, its
    calls; None if there was none since the server started."""
    runner = backstage.runner
    status = runner.state()
    if status is None:
        return None
    logged = runner.log.run(status.run)
    lexicon = runner.knowledge.lexicon(language)
    read = {each.line: each for each in reading(status.program, runner.knowledge, language)}
    return {
        **msgspec.to_builtins(status),
        "message": told(status.error, status.message, language, lexicon)
        if status.message
        else None,
        "utterance": logged.utterance if logged else None,
        "by": logged.approved_by if logged else None,
        "started": logged.started if logged else None,
        "lines": [
            {"code": str(code), "reading": read[number].text if number in read else ""}
            for number, code in enumerate(highlighted(status.program), 1)
        ],
        "calls": [
            {
                "number": call.number,
                "line": call.line,
                "method": call.method,
                "arguments": msgspec.json.decode(call.arguments),
                "result": msgspec.json.decode(call.result) if call.result else None,
                "error": call_trouble(call, language, lexicon),
                "seconds": call.seconds,
            }
            for call in runner.log.calls(status.run)[-100:]
        ],
    }
