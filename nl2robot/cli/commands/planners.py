"""`nl2robot planners`: what turns words into plans here, and a check of one."""

from __future__ import annotations

import argparse

from nl2robot.cli.commands.options import add_world, names_of
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from nl2robot.translate.planner_checker import check_planner
from nl2robot.translate.planners import available, names, planner, troubles


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="check")
    checking = actions.add_parser(
        "check",
        help="have a planner plan, and look whether it keeps to what is promised",
        description="Have a planner plan, and look whether it keeps to what is promised.",
    )
    checking.add_argument("planner", metavar="NAME", help="such as grammar, or model")
    add_world(checking)


def run(options: argparse.Namespace) -> int:
    """The exit status of a check is 1 if something is wrong."""
    if options.action != "check":
        broken = troubles()
        for name in names():
            if name not in broken:
                print(name if available(name) else f"{name}  (not installed)")
        print(*broken.values(), sep="\n", end="\n" if broken else "")
        return ExitStatus.OK
    found = check_planner(planner(options.planner), Knowledge(names_of(options)))
    print("\n".join(found or ["It keeps to what is promised."]))
    return ExitStatus.FAILED if found else ExitStatus.OK
