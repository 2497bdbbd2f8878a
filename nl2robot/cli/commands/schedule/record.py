"""`nl2robot schedule reminders`: the record of reminders, at a terminal or for a spreadsheet."""

from __future__ import annotations

import argparse
import json
import sys
from datetime import datetime, time
from pathlib import Path
from typing import Final

import msgspec

from nl2robot.cli.commands.schedule.books import Distant, reminders_in
from nl2robot.cli.commands.schedule.times import day_of
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import UserError
from nl2robot.plain import visible
from nl2robot.schedule.reminders import MOST, as_csv
from nl2robot.schedule.rhythm import local, moment_of
from nl2robot.schedule.schedule import Schedule
from robot_api.errors import cause
from robot_api.local_time import local_zone

STANDARD_OUTPUT: Final = "-"


def show_reminders(
    terminal: Terminal, book: Schedule | Distant, options: argparse.Namespace
) -> None:
    zone, since = local_zone(), 0.0
    if options.since is not None:
        since = moment_of(datetime.combine(day_of(options.since), time.min), zone)
    whole = options.since is not None or options.csv is not None
    found = reminders_in(book, since, MOST if whole else options.last, options.lang)
    if options.csv is not None:
        _write(terminal, as_csv(found, zone), len(found), options.csv)
        return
    if options.json:
        for each in found:
            print(json.dumps(msgspec.to_builtins(each), ensure_ascii=False))
        return
    if not found:
        terminal.console.print(terminal.words["no_reminders"], markup=False)
        return
    table = terminal.table(*terminal.words["reminders"])
    for each in reversed(found):
        said = f"{local(each.said, zone):%H:%M}" if each.said is not None else ""
        words = (each.person, each.what, each.place or "", each.told, each.robot, each.approved_by)
        due = f"{local(each.due, zone):%Y-%m-%d %H:%M}"
        table.add_row(due, said, *map(visible, words))
    terminal.console.print(table, markup=False)


def _write(terminal: Terminal, text: str, count: int, file: str) -> None:
    """Raises `UserError` where the file cannot be written."""
    if file == STANDARD_OUTPUT:
        sys.stdout.write(text)
        return
    try:
        # For whoever asked, and nobody else: it tells of patients.
        path = Path(file)
        path.touch(mode=0o600)
        path.write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        raise UserError(
            f"The file {file} cannot be written ({cause(error)}). Choose another one."
        ) from error
    told = terminal.words["reminders_written"].format(count=count, file=file)
    terminal.console.print(told, markup=False, soft_wrap=True)
