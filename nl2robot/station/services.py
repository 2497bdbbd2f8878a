"""The methods on the wire besides the robot's own: the runner's, `program.translate` to
`program.stop`, and `voice_services`."""

from __future__ import annotations

import math
import time
from collections.abc import Mapping
from typing import Any, TypedDict

import msgspec

from grammar.planning.planner import Interrupted
from grammar.samples import samples
from nl2robot.review.review import Review
from nl2robot.run import trouble
from nl2robot.run.answers import Sentence, answer
from nl2robot.run.going_on import DoneCall
from nl2robot.run.runlog import Run
from nl2robot.run.runner import Runner
from nl2robot.run.runs import Approval, Status
from nl2robot.run.state import GOING, Reviewing, Told
from nl2robot.schedule.schedule import Schedule
from nl2robot.station.local_clock import moment_in
from nl2robot.translate.outcome import Translation
from nl2robot.translate.planners import names
from nl2robot.translate.talks import Talks
from nl2robot.translate.thinking import EVENT, Thought, published
from nl2robot.translate.translation import translate
from nl2robot.voice.services import Microphones, voice_services
from nl2robot.wire import (
    LANGUAGE,
    NAME,
    NUMBER,
    SHA256,
    an_object,
    schema_of,
    service,
    service_of_call,
)
from robot_api.driver import StopFlag
from robot_api.errors import Stopped
from robot_api.methods import MAX_TEXT
from robot_api.server import Context, Service

LONGEST_PROGRAM = 65_536
SECONDS_TO_END = 2.0
"""How long a stopped run may take to be over, beside what the robot takes to stand."""

_STRING = {"type": "string", "maxLength": MAX_TEXT}
_MAYBE = {"type": ["string", "null"], "maxLength": 4 * LONGEST_PROGRAM}
_PROGRAM = {"type": "string", "maxLength": LONGEST_PROGRAM}
_MAYBE_RUN = {"type": ["integer", "null"], "minimum": 1}


EVENTS: Mapping[str, str] = {
    "program": "what (state | line | call | result | print), run, state, line, message, and of a"
    " call number, method, arguments, of a result also result or error and seconds, of print text",
    EVENT: "what (thinking | writing), talk, utterance, microphone if it was spoken, and of writing"
    " text, the program so far: a language model is at work on a sentence; at most 10 a second."
    " What was spoken only the microphone's client is told",
}
"""The events that these services publish."""


class LeftOver(TypedDict):
    """`nl2robot.run.going_on.Unfinished`, with where it goes on and what is told of it."""

    run: int
    program: str
    sha256: str
    utterance: str | None
    done: list[DoneCall]
    again: DoneCall | None
    stood: dict[str, float] | None
    line: int
    told: list[str]


def services(
    runner: Runner, talks: Talks, microphones: Microphones, schedule: Schedule | None = None
) -> dict[str, Service]:
    """The methods to register with a `robot_api.server.Server`."""

    def translated(p: Mapping[str, Any], context: Context) -> Translation:
        """Ends at once when nobody waits for it any more, whatever a model is at."""
        talk, utterance = p.get("talk"), p["utterance"]
        remembered = talks.of(talk)
        mine = remembered.copy()
        thought = Thought(
            lambda watch: translate(
                utterance,
                runner.knowledge,
                p.get("language", "en"),
                p.get("planner", "auto"),
                mine,
                runner,
                watch,
                runner.think,
                schedule,
            ),
            published(context.publish, {"talk": talk, "utterance": utterance}),
        )
        context.stop.on_set(thought.give_up)
        try:
            translation = thought.result()
        except Interrupted:
            context.stop.check()
            raise Stopped("The sentence was given up.") from None
        remembered.adopt(mine)
        return translation

    def checked(p: Mapping[str, Any]) -> Any:
        at = moment_in(runner.knowledge.world, p["at"]) if "at" in p else None
        return runner.check(p["program"], p.get("language", "en"), p.get("continues"), at)

    def reviewed(p: Mapping[str, Any], context: Context) -> None:
        runner.present.happened(Reviewing(reviewer(context.connection), p["lies"]))

    def approved(p: Mapping[str, Any], context: Context) -> Any:
        rest = _rest(p, "program sha256 by")
        return runner.approve(
            p["program"], p["sha256"], p["by"], **rest, connection=context.connection
        )

    def waited(p: Mapping[str, Any], stop: StopFlag) -> Any:
        """Until the run is over, the time is up or the call is cancelled. A stop of the robot sets
        the flag as well; the run then has a moment to end."""
        status = runner.wait(p["run"], 0)
        began = time.monotonic()
        enough = began + p.get("timeout", math.inf)
        has = runner.knowledge.capabilities
        to_end = SECONDS_TO_END + (has.stop_within if has else 0.0)
        while status.state in GOING and time.monotonic() < enough:
            if stop.is_set():
                enough = min(enough, time.monotonic() + to_end)
            status = runner.wait(p["run"], 0.05)
        return status

    def left_of(run: int | None, language: str) -> dict[str, Any] | None:
        rest = runner.unfinished(run)
        if rest is None:
            return None
        more = {"line": rest.line, "told": runner.told_of(rest, language)}
        return {**msgspec.to_builtins(rest), **more}

    def listed(p: Mapping[str, Any]) -> Any:
        return runner.log.runs(p.get("last", 20))

    return {
        **voice_services(microphones),
        "program.translate": service_of_call(
            translated,
            "Turn words into a program; moves nothing. A language model may take seconds: events"
            " of the kind translation tell how far it is, and the call can be cancelled.",
            {
                # How long it may be is the grammar's business, which says so in words.
                "utterance": {"type": "string"},
                "language": LANGUAGE,
                "planner": {"enum": names()},
                "talk": {"type": ["string", "null"], "maxLength": 100},
            },
            "utterance",
            for_caller=True,
            right="propose",
            result=Translation,
        ),
        "program.phrases": service(
            lambda p: samples(
                runner.knowledge.lexicon(p.get("language", "en")), p.get("language", "en")
            ),
            "List what can be said here, by topic.",
            {"language": LANGUAGE},
            observes=True,
            result=dict[str, list[str]],
        ),
        "program.check": service(
            checked,
            "Review a program: types, what this robot lacks, a dry run; moves nothing. With"
            " `continues`, of what is left of it after that run; with `at` (2026-12-24T06:00), as"
            " if it began then.",
            {
                "program": _PROGRAM,
                "language": LANGUAGE,
                "continues": _MAYBE_RUN,
                "at": {"type": "string", "maxLength": 40},
            },
            "program",
            right="propose",
            result=Review,
        ),
        "program.unfinished": service(
            lambda p: left_of(p.get("run"), p.get("language", "en")),
            "Tell what is done and what is left of a run that was broken off, the last one if none"
            " is named; null if nothing is. It goes on as any program: approved, with `continues`.",
            {"run": NUMBER, "language": LANGUAGE},
            observes=True,
            result=LeftOver | None,
        ),
        "program.reviewing": service_of_call(
            reviewed,
            "Tell that a program lies before somebody here who decides on it, or no longer.",
            {"lies": {"type": "boolean"}},
            "lies",
            result=None,
        ),
        "program.approve": service_of_call(
            approved,
            "Approve exactly the program with this SHA-256 for one run, within ten minutes and as"
            " long as the connection lasts. With `continues`, the"
            " number of a run that was broken off, what was done there is not done again. Where it"
            " was changed by hand, `proposed` is the program from before; the log keeps both, and"
            " who did. One that does not come to its end in the dry run, which is made now unless"
            " it was lately, is refused unless somebody `insists`.",
            {
                "program": _PROGRAM,
                "sha256": SHA256,
                "by": NAME,
                "utterance": _MAYBE,
                "heard": _MAYBE,
                "language": {"type": ["string", "null"], "maxLength": 5},
                "plan": _MAYBE,
                "continues": _MAYBE_RUN,
                "proposed": _MAYBE,
                "changed_by": {"type": ["string", "null"], "minLength": 1, "maxLength": 200},
                "insists": {"type": "boolean"},
            },
            "program sha256 by",
            result=Approval,
        ),
        "program.run": service(
            lambda p: runner.run(p["approval"]),
            "Start an approved program; returns the run's number at once.",
            {"approval": _STRING},
            "approval",
            result=int,
        ),
        "program.wait": Service(
            handler=lambda p, context: msgspec.to_builtins(waited(p, context.stop)),
            params=an_object({"run": NUMBER, "timeout": {"type": "number", "minimum": 0}}, "run"),
            doc="Wait until a run is over and tell how it ended.",
            result=schema_of(Status),
            observes=True,
            lane="wait",
            after_stop=True,
        ),
        "program.answer": service(
            lambda p: answer(runner.log, runner.knowledge, p["run"], p.get("language", "en")),
            "Tell what came of a run, in sentences for whoever asked for it; each says whether the"
            " robot has spoken it there.",
            {"run": NUMBER, "language": LANGUAGE},
            "run",
            observes=True,
            result=list[Sentence],
        ),
        "program.state": service(
            lambda p: runner.state(),
            "Tell how the present or last run stands.",
            observes=True,
            lane="control",
            result=Status | None,
        ),
        "sentence.told": service(
            lambda p: trouble.told(
                None, p["sentence"], p["language"], runner.knowledge.lexicon(p["language"])
            ),
            "Tell a sentence of an error in another language; one that is not the robot's own"
            " software's as it is.",
            {"sentence": {"type": "string", "maxLength": 2000}, "language": LANGUAGE},
            "sentence language",
            right="know",
            result=str,
        ),
        "station.state": service(
            lambda p: runner.present.on_wire(),
            "Tell how the robot and its program stand, as the event `state` does.",
            observes=True,
            lane="control",
            result=Told,
        ),
        "program.pause": service(
            lambda p: runner.pause(),
            "Halt the robot and the program: pausing, and paused when it has come to rest.",
            lane="control",
            result=Status,
        ),
        "program.step": service(
            lambda p: runner.step(),
            "Do one robot call, then hold again.",
            lane="control",
            result=Status,
        ),
        "program.resume": service(
            lambda p: runner.resume(),
            "Go on after a pause; a movement goes on to its goal.",
            lane="control",
            result=Status,
        ),
        "program.stop": service(
            lambda p: runner.stop(),
            "Stop the program; `robot.stop` stops the robot as well.",
            right="know",
            lane="control",
            result=None,
        ),
        "program.list": service(
            listed,
            "List the newest runs of the log.",
            {"last": {"type": "integer", "minimum": 1, "maximum": 1000}},
            observes=True,
            result=list[Run],
        ),
    }


def reviewer(connection: str) -> str:
    """Whoever reviews a program at that connection, for `nl2robot.run.state`."""
    return f"connection {connection}"


def _rest(parameters: Mapping[str, Any], taken: str) -> dict[str, Any]:
    return {name: value for name, value in parameters.items() if name not in taken.split()}
