"""`nl2robot paraphrases`: how well a file of commands with logical forms is understood."""

from __future__ import annotations

import argparse
import json
import random
from pathlib import Path

from nl2robot.checks.paraphrases import DEFAULT_WORLD, Total, by_kind, load, score, total
from nl2robot.cli.options.sentence import add_planner
from nl2robot.cli.options.values import whole
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from sim.world.loading import load_world


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("file", metavar="FILE.tsv", help="a command, a tab, its logical form")
    parser.add_argument(
        "--world",
        default=DEFAULT_WORLD,
        metavar="W",
        help=f"a built-in world's name or a YAML file (default: {DEFAULT_WORLD})",
    )
    add_planner(parser, default="grammar")
    parser.add_argument(
        "--most", type=whole(1), metavar="N", help="only N commands of the file, by chance (seed 0)"
    )
    parser.add_argument("--misses", action="store_true", help="list what was not right, and why")
    parser.add_argument("--json", action="store_true", help="the figures as one JSON object")


def run(options: argparse.Namespace) -> int:
    from rich.console import Console
    from rich.progress import track

    knowledge = Knowledge(load_world(options.world, names_only=True))
    rows = load(Path(options.file))
    if options.most is not None and options.most < len(rows):
        rows = random.Random(0).sample(rows, options.most)
    terminal = Terminal()
    aside = Console(stderr=True)
    bar = track(rows, "commands", console=aside, transient=True, disable=not aside.is_terminal)
    scores = [score(row, knowledge, options.planner) for row in bar]
    if options.json:
        figures = total(scores)
        print(json.dumps({"rows": figures.rows, **dict(_shares(figures))}))
        return ExitStatus.OK
    if options.misses:
        for each in scores:
            if each.outcome != "right":
                print(
                    f"{each.outcome}: {each.row.words}\n  wanted {each.wanted}\n  got    {each.got}"
                )
        return ExitStatus.OK
    table = terminal.table("kind of command", "rows", "head", "right", "refused", "wrong")
    kinds = {kind: total(own) for kind, own in by_kind(scores).items()}
    for kind, figures in {**kinds, "all": total(scores)}.items():
        table.add_row(kind, str(figures.rows), *(f"{share:.1%}" for _, share in _shares(figures)))
    terminal.console.print(table)
    return ExitStatus.OK


def _shares(figures: Total) -> list[tuple[str, float]]:
    return [
        ("head", figures.head),
        ("right", figures.right),
        ("refused", figures.refused),
        ("wrong", figures.wrong),
    ]
