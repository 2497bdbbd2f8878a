"""`nl2robot bench`: how fast everything is on this machine, in one table; `nl2robot bench hearing`:
how well it hears; `nl2robot bench console`: how fast the web console is, in a real browser;
`nl2robot bench planner`: how fast the language model is; `nl2robot bench robots`: how fast robots
are, and stop, over each wire; `nl2robot bench fleet`: how fast ten robots hear of each other."""

from __future__ import annotations

import argparse
import json

from nl2robot.bench import benchmark, console, fleet, hearing, planner, robots
from nl2robot.bench.figures import Figure
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--json", action="store_true", help="as one JSON object")
    parser.add_argument(
        "only",
        nargs="*",
        help="parts (default: all but hearing, console, planner, robots and fleet)",
    )
    group = parser.add_argument_group(
        "hearing", "with the part hearing: commands and answers, synthesised and in noise"
    )
    group.add_argument("--quick", action="store_true", help="a smaller sample")
    group.add_argument("--lang", default="en", help="the language that is spoken (en, de, fr)")
    group.add_argument("--seed", type=int, default=1, help="for another sample")
    group = parser.add_argument_group("robots", "with the part robots")
    group.add_argument(
        "--robot",
        action="append",
        default=[],
        metavar="ADDRESS",
        help="a further robot, which will drive to and fro (may be given several times)",
    )


def run(options: argparse.Namespace) -> int:
    terminal = Terminal()
    if "hearing" in options.only:
        return _hearing(options, terminal)
    if "console" in options.only:
        return _console(options, terminal)
    if "robots" in options.only:
        return _robots(options, terminal)
    if "fleet" in options.only:
        return _fleet(options, terminal)
    table = terminal.table("part", "what", "measured", "aim")
    results = []
    for part in options.only or benchmark.PARTS:
        for figure in planner.measure() if part == "planner" else benchmark.measure(part):
            results.append(figure)
            table.add_row(figure.part, figure.what, figure.shown, figure.aim)
    if options.json:
        print(json.dumps({f"{f.part}: {f.what}": [f.value, f.unit] for f in results}))
    else:
        terminal.console.print(table)
    return ExitStatus.OK


def _console(options: argparse.Namespace, terminal: Terminal) -> int:
    from rich.progress import Progress

    rows: list[tuple[str, float, str, str]] = []
    with Progress(console=terminal.console, transient=True) as progress:
        progress.add_task("Looking at the pages", total=None)
        rows.extend(console.measure())
    if options.json:
        print(json.dumps({what: [round(figure, 1), unit] for what, figure, unit, _ in rows}))
        return ExitStatus.OK
    table = terminal.table("what", "measured", "aim")
    for what, figure, unit, aim in rows:
        table.add_row(what, f"{figure:.1f} {unit}", f"{aim} {unit}" if aim else "")
    terminal.console.print(table)
    return ExitStatus.OK


def _robots(options: argparse.Namespace, terminal: Terminal) -> int:
    from rich.progress import Progress

    measured: dict[str, dict[str, float]] = {}
    with Progress(console=terminal.console, transient=True) as progress:
        progress.add_task("Driving to and fro", total=None)
        measured.update(robots.measure(options.robot))
    if options.json:
        print(json.dumps(measured))
        return ExitStatus.OK
    table = terminal.table("what", *measured, "aim")
    for key, (what, unit, aim) in robots.WHAT.items():
        figures = [robot.get(key) for robot in measured.values()]
        shown = ["" if figure is None else f"{_rounded(figure)} {unit}" for figure in figures]
        table.add_row(what, *shown, f"{aim} {unit}" if aim else "")
    terminal.console.print(table)
    return ExitStatus.OK


def _fleet(options: argparse.Namespace, terminal: Terminal) -> int:
    from rich.progress import Progress

    figures: list[Figure] = []
    with Progress(console=terminal.console, transient=True) as progress:
        task = progress.add_task("Starting them", total=None)
        figures.extend(fleet.measure(told=lambda what: progress.update(task, description=what)))
    if options.json:
        print(json.dumps({figure.what: [figure.value, figure.unit] for figure in figures}))
        return ExitStatus.OK
    table = terminal.table("what", "measured, or on paper")
    for figure in figures:
        table.add_row(figure.what, figure.shown)
    terminal.console.print(table)
    return ExitStatus.OK


def _rounded(figure: float) -> str:
    return f"{figure:,.0f}" if figure >= 100 else f"{figure:.3g}"


def _hearing(options: argparse.Namespace, terminal: Terminal) -> int:
    from rich.progress import Progress

    with Progress(console=terminal.console, transient=True) as progress:
        task = progress.add_task("Listening", total=None)
        tally = hearing.run(
            options.lang,
            "quick" if options.quick else "full",
            options.seed,
            lambda done, of: progress.update(task, completed=done, total=of),
        )
    rows = list(tally.rows())
    speed = {
        "from the end of the sound to the program, median (ms)": round(tally.seconds * 1000),
        "real-time factor, median": round(tally.real_time_factor, 3),
        "memory (MB)": round(hearing.megabytes()),
        "trials": len(tally.outcomes),
    }
    if options.json:
        columns = [*hearing.CONDITIONS, "all"]
        shares = {what: dict(zip(columns, figures, strict=True)) for what, figures in rows}
        print(json.dumps({**shares, **speed}))
        return ExitStatus.OK
    table = terminal.table("what", *hearing.CONDITIONS, "all")
    for what, figures in rows:
        table.add_row(what, *figures)
    terminal.console.print(table)
    for what, figure in speed.items():
        terminal.console.print(f"{what}: {figure}")
    return ExitStatus.OK
