"""`nl2robot lint`: the names of a world, looked at by somebody who has to say them."""

from __future__ import annotations

import argparse
import json

import msgspec

from grammar.language import languages
from nl2robot.checks.lint import lint, worst
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "worlds", nargs="+", metavar="WORLD", help="a built-in world's name or a YAML file"
    )
    parser.add_argument(
        "--lang",
        action="append",
        choices=languages(),
        help="a language to look at; may be repeated (default: all that the world has names in)",
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a finding")


def run(options: argparse.Namespace) -> int:
    """The exit status is 1 if there are errors; warnings alone do not count."""
    for each in options.worlds:
        if each.endswith(".py"):
            raise UserError(
                f"{each} is a program, and lint looks at worlds. `nl2robot explain {each}` tells"
                " what it does and what is wrong with it."
            )
    terminal = Terminal()
    found = [finding for world in options.worlds for finding in lint(world, options.lang)]
    for finding in found:
        if options.json:
            print(json.dumps(msgspec.to_builtins(finding), ensure_ascii=False))
            continue
        colour = "red" if finding.severity == "error" else "yellow"
        where = f"{finding.file}:{finding.line}" if finding.line else finding.file
        terminal.console.print(
            f"{terminal.plain(where)}: [{colour}]{finding.severity}[/]"
            f" ({finding.code}, {finding.language}): {terminal.plain(finding.message)}",
            soft_wrap=True,
        )
    if not options.json:
        errors = sum(finding.severity == "error" for finding in found)
        terminal.console.print(f"{errors} errors, {len(found) - errors} warnings")
    return ExitStatus.FAILED if worst(found) == "error" else ExitStatus.OK
