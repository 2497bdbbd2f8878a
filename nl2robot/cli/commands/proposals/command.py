"""The arguments of `nl2robot proposals`, and what is listed."""

from __future__ import annotations

import argparse
import json
import queue
import sys
import time
from collections.abc import Iterator, Mapping
from typing import Any

import msgspec

from nl2robot.cli.commands.proposals.deciding import decide_on
from nl2robot.cli.operator import Operator
from nl2robot.cli.options.robot import add_ca, trust
from nl2robot.cli.options.sentence import add_language
from nl2robot.cli.options.values import user_name, whole
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.plain import visible
from nl2robot.proposals.proposals import KIND, Proposal, check_waits
from nl2robot.station.clients import client_of
from robot_api.server import DEFAULT_PORT


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "number", nargs="?", type=whole(1), help="of a proposal, to look at it and decide"
    )
    parser.add_argument("--watch", action="store_true", help="wait, and ask of each as it comes")
    parser.add_argument("--json", action="store_true", help="all of them, one JSON object a line")
    here = f"ws://127.0.0.1:{DEFAULT_PORT}"
    parser.add_argument(
        "--robot", default=here, metavar="ADDRESS", help=f"the robot server (default: {here})"
    )
    add_ca(parser)
    parser.add_argument("--token", help="the token that the robot server printed at its start")
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    trust(options)
    terminal = Terminal(language=options.lang)
    terminal.nobody, terminal.unclear = "nobody_decides", "undecided_proposal"
    with client_of(options.robot, options.token) as robot:
        operator = Operator(robot, user_name())
        if options.json:
            for each in operator.proposals():
                print(json.dumps(msgspec.to_builtins(each), ensure_ascii=False))
        elif options.watch:
            for each in _coming(operator, terminal):
                decide_on(operator, terminal, each)
        elif options.number is not None:
            found = _one(operator, options.number)
            check_waits(found)
            return decide_on(operator, terminal, found)
        else:
            _list(terminal, [each for each in operator.proposals() if each.state == "waiting"])
    return ExitStatus.OK


def _one(operator: Operator, number: int) -> Proposal:
    found = next((each for each in operator.proposals() if each.id == number), None)
    if found is None:
        raise UserError(
            f"There is no proposal {number} (any more). `nl2robot proposals` lists those that wait."
        )
    return found


def _list(terminal: Terminal, waiting: list[Proposal]) -> None:
    if not waiting:
        terminal.console.print(terminal.words["no_proposals"], markup=False)
        return
    table = terminal.table(*terminal.words["proposals"])
    for each in waiting:
        minutes = max(0, round((time.time() - each.at) / 60))
        table.add_row(str(each.id), visible(each.by), visible(each.sentence), f"{minutes} min")
    terminal.console.print(table, markup=False)


def _coming(operator: Operator, terminal: Terminal) -> Iterator[Proposal]:
    """Those that wait, and each that comes from now on."""
    if not sys.stdin.isatty():
        raise UserError(terminal.words[terminal.nobody], ExitStatus.NOT_APPROVED)
    told: queue.SimpleQueue[int] = queue.SimpleQueue()

    def note(kind: str, data: Mapping[str, Any]) -> None:
        if data["state"] == "waiting":
            told.put(data["id"])

    operator.watch(note, KIND)
    for each in operator.proposals():
        told.put(each.id)
    terminal.console.print(terminal.words["waits_for_proposals"], markup=False)
    asked = 0
    while True:
        number = told.get()
        if number <= asked:
            continue
        asked = number
        found = _one(operator, number)
        if found.state == "waiting":
            yield found
