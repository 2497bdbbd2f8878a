"""The methods on the wire of a robot in a fleet: `fleet.list` to `fleet.stop`."""

from __future__ import annotations

import secrets
import time
from collections.abc import Mapping
from typing import Any, Final, TypedDict

import msgspec

from nl2robot.errors import UserError
from nl2robot.fleet.book import Errand
from nl2robot.fleet.joining import Fleet
from nl2robot.fleet.keeping import Kept, check_for_all
from nl2robot.fleet.messages import About, Standing
from nl2robot.review.review import digest
from nl2robot.run.runner import Runner
from nl2robot.schedule.findings import encoded, findings_of
from nl2robot.wire import LANGUAGE, NAME, PROGRAM, SHA256, service, service_of_call
from robot_api.errors import AccessDenied
from robot_api.methods import MAX_TEXT
from robot_api.server import Context, Service

EVENTS: Final[Mapping[str, str]] = {
    "fleet": "members and errands, as fleet.list tells them, when something has changed; at most"
    " five times a second",
    "fleet.plans": "nothing more: something of the appointments of the fleet is another, which the"
    " method of this name lists",
}
WAITS: Final = 60.0
"""Seconds that `fleet.wait` waits at most."""
_ID: Final = {"type": "string", "pattern": "^[0-9a-f]{16}$"}


class Told(msgspec.Struct, frozen=True, kw_only=True):
    """A robot's answer to a stop."""

    id: str
    name: str
    confirmed: bool
    answered: bool
    because: str


def approved(
    runner: Runner, fleet: Fleet, program: str, sha256: str, by: str, sentence: str, language: str
) -> Errand:
    """An errand of a program that somebody has approved here. It is reviewed for a robot that can
    do everything: what its own robot lacks, the review there says. Raises `AccessDenied`."""
    if digest(program) != sha256:
        raise AccessDenied(
            "The program was changed after its review. Review it again, then approve it."
        )
    made = check_for_all(runner, program, language)
    errors = [each for each in made.findings if each.severity == "error"]
    if errors:
        raise AccessDenied(
            f"The program cannot be approved: line {errors[0].line}: {errors[0].message}"
        )
    if not made.came_through:
        raise AccessDenied(
            "The program did not come to its end when it was tried. Change it before it is given"
            " to a robot of the fleet."
        )
    return Errand(
        id=secrets.token_hex(8),
        program=program,
        sha256=sha256,
        sentence=sentence,
        language=language,
        by=f"{by} (fleet, from {fleet.name})",
        reviewed=encoded(findings_of(made)),
        at=time.time(),
    )


class MemberTold(TypedDict):
    """A robot of the fleet as this one has heard of it; `heard`: seconds ago by the clock here."""

    id: str
    name: str
    here: bool
    known: bool
    heard: float
    left: bool
    twin: bool
    same_map: bool
    about: About | None
    standing: Standing | None


class FleetTold(TypedDict):
    """The robots of the fleet, and what this one has given them to do, the newest first."""

    members: list[MemberTold]
    errands: list[Errand]
    trouble: dict[str, str] | None


def fleet_services(fleet: Fleet, runner: Runner) -> dict[str, Service]:
    """The methods to register with a `robot_api.server.Server`."""

    def listed(p: Mapping[str, Any]) -> dict[str, Any]:
        return {
            "members": fleet.members(),
            "errands": fleet.errands(),
            "trouble": fleet.trouble_told(),
        }

    def ran(p: Mapping[str, Any], context: Context) -> Errand:
        # Whoever has no account may call themselves anything, but not what somebody is called.
        wanted = fleet.fit(p["robot"], p["program"]) if "robot" in p else None
        errand = approved(
            runner,
            fleet,
            p["program"],
            p["sha256"],
            p["by"],
            p.get("sentence", ""),
            p.get("language", "en"),
        )
        return fleet.add(msgspec.structs.replace(errand, wanted=wanted))

    def stopped(p: Mapping[str, Any], context: Context) -> list[dict[str, Any]]:
        robots = [fleet.one(p["robot"])] if "robot" in p else None
        because = f"The fleet was stopped at {fleet.name}."
        return fleet.stop(robots, because)

    def called_off(p: Mapping[str, Any]) -> Errand:
        errand = fleet.call_off(p["errand"])
        if errand is None:
            raise UserError("That is over already, or nobody knows of it.")
        if errand.state != "called_off":
            raise UserError(
                f"{errand.robot_name} has been told to begin it. Stop that robot instead."
            )
        return errand

    return {
        "fleet.list": service(
            listed,
            "List the robots of the fleet as this one has heard of them, and what it has given"
            " them to do, the newest first. `heard` is how many seconds ago by the clock here; one"
            " that is not `known` may stand any way. `trouble`: why the fleet is not reached, by"
            " language, if it is not.",
            observes=True,
            result=FleetTold,
        ),
        "fleet.plans": service(
            lambda p: fleet.keeping.plans(p.get("language", "en")),
            "List the appointments of the fleet: each is kept by the robot where it was made, which"
            " has it handed out at its time to the one that does it best. Of one whose keeper is"
            " not `known`, `planned.unknown` is the last time of which nobody knows whether it was"
            " done. `planned.next` is when it is done if its keeper is there then.",
            {"language": LANGUAGE},
            observes=True,
            result=list[Kept],
        ),
        "fleet.fit": service(
            lambda p: fleet.fit(p["robot"], p["program"]),
            "Tell the id of the robot of that name or id. Refuses one that is none of the fleet,"
            " has another floor, or lacks a method that the program calls; whether it is free now"
            " is nothing to this.",
            {"robot": NAME, "program": PROGRAM},
            "robot program",
            observes=True,
            result=str,
        ),
        "fleet.run": service_of_call(
            ran,
            "Approve exactly the program with this SHA-256, for one run by the robot of the fleet"
            " that does it best, or by the `robot` of that name or id. That robot reviews it again"
            " before it begins. Returns what is to be done, which `fleet.wait` waits for.",
            {
                "program": PROGRAM,
                "sha256": SHA256,
                "by": NAME,
                "sentence": {"type": "string", "maxLength": MAX_TEXT},
                "language": {"type": "string", "pattern": "^[a-z]{2}$"},
                "robot": NAME,
            },
            "program sha256 by",
            result=Errand,
        ),
        "fleet.wait": service_of_call(
            lambda p, context: fleet.wait(
                p["errand"], p.get("timeout", WAITS), context.stop.is_set
            ),
            "Wait until something that was given to the fleet is over, `timeout` seconds at most,"
            " and tell how it stands.",
            {"errand": _ID, "timeout": {"type": "number", "minimum": 0, "maximum": WAITS}},
            "errand",
            observes=True,
            for_caller=True,
            lane="wait",
            result=Errand,
        ),
        "fleet.call_off": service(
            called_off,
            "Have something not done that no robot was told to begin yet.",
            {"errand": _ID},
            "errand",
            result=Errand,
        ),
        "fleet.stop": service_of_call(
            stopped,
            "Stop all robots of the fleet, or the `robot` of that name or id; returns what each"
            " says to that. One that has not `answered` may still move.",
            {"robot": NAME},
            right="know",
            lane="control",
            result=list[Told],
        ),
    }
