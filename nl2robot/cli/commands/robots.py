"""`nl2robot robots`: the kinds of robots there are drivers for, a check of one robot, and the guard
that runs on one."""

from __future__ import annotations

import argparse
import json
from importlib import import_module

from nl2robot.cli.options.robot import add_ca, add_robot_file, trust
from nl2robot.cli.options.world import add_world, world_of
from nl2robot.errors import ExitStatus
from nl2robot.station.robots import chosen
from robot_api.robots.registry import RobotKind, known


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="as JSON")
    actions = parser.add_subparsers(dest="action", metavar="check|guard")
    check = actions.add_parser(
        "check",
        help="run the conformance suite on a robot: what works, is stood in for, is lacking",
        description="Run the conformance suite. The robot drives: give it room, or use --still.",
    )
    check.add_argument("robot", metavar="ADDRESS", help="such as sim, or ros2://HOST:9090")
    add_ca(check)
    add_robot_file(check)
    add_world(check)
    check.add_argument("--token", help="of the robot server, if it asks for one")
    check.add_argument("--still", action="store_true", help="leave out what moves the robot")
    check.add_argument("--json", action="store_true", help="as JSON")
    guard = actions.add_parser(
        "guard",
        help="watch over a robot with ROS, on its own computer: stop it when its server is gone",
    )
    guard.add_argument("robot", metavar="ADDRESS", help="the robot's own rosbridge")
    guard.add_argument("more", nargs=argparse.REMAINDER, help="options of the guard")


def run(options: argparse.Namespace) -> int:
    match options.action:
        case "check":
            return _check(options)
        case "guard":
            guard = import_module("robot_api.robots.ros.guard")
            return int(guard.main([options.robot, *options.more]))
    return _list(options.json)


def _list(as_json: bool) -> int:
    there = known()
    if as_json:
        kinds = [_as_json(kind) for kind in there.kinds.values()]
        told = {"robots": kinds, "troubles": dict(there.troubles)}
        print(json.dumps(told, ensure_ascii=False))
        return ExitStatus.OK
    width = max(len(kind.scheme) for kind in there.kinds.values())
    for kind in there.kinds.values():
        print(f"{kind.scheme:<{width}}  {kind.title}")
        print(f"{'':<{width}}  --robot {kind.example}")
        if kind.missing():
            print(f"{'':<{width}}  {kind.how_to_install()}")
    for trouble in there.troubles.values():
        print(trouble)
    return ExitStatus.OK


def _as_json(kind: RobotKind) -> dict[str, object]:
    return {
        "scheme": kind.scheme,
        "title": kind.title,
        "example": kind.example,
        "needs": list(kind.modules),
        "missing": list(kind.missing()),
        "extra": kind.extra,
    }


def _check(options: argparse.Namespace) -> int:
    from nl2robot.station.robot_check import checked

    robot = chosen(options.robot, options.robot_file)
    if robot.is_server:
        trust(options)
    report = checked(robot, world_of(options), options.token, move=not options.still)
    if options.json:
        print(json.dumps(report.to_json(), ensure_ascii=False))
    else:
        print(report.table(), end="")
    return ExitStatus.FAILED if report else ExitStatus.OK
