"""`nl2robot bench`: how fast everything is on this machine, in one table."""

from __future__ import annotations

import argparse
import json

from nl2robot.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="as one JSON object")
    parser.add_argument("only", nargs="*", help="the parts to measure (default: all)")


def run(options: argparse.Namespace) -> int:
    from nl2robot.benchmark import PARTS, measure
    from nl2robot.terminal import Terminal

    terminal = Terminal()
    table = terminal.table("part", "what", "measured", "aim")
    results = []
    for part in options.only or PARTS:
        for figure in measure(part):
            results.append(figure)
            table.add_row(figure.part, figure.what, figure.shown, figure.aim)
    if options.json:
        print(json.dumps({f"{f.part}: {f.what}": [f.value, f.unit] for f in results}))
    else:
        terminal.console.print(table)
    return ExitStatus.OK
