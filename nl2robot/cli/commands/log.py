"""`nl2robot log`: past runs; one in detail; replayed in the simulator."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping
from datetime import datetime
from typing import Any

import msgspec

from nl2robot import sentences
from nl2robot.changes import difference
from nl2robot.cli.options.sentence import add_language
from nl2robot.cli.options.values import whole
from nl2robot.cli.run_log import open_log
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.plain import visible
from nl2robot.proposals.proposals import approved_and_proposed
from nl2robot.run.retention import DAY
from nl2robot.run.runlog import Run, RunLog
from nl2robot.run.trouble import call_trouble, told
from nl2robot.texts import texts_in


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "run", nargs="?", type=whole(1), help="the number of a run, to see all of it"
    )
    parser.add_argument(
        "--last", type=whole(1), default=20, metavar="N", help="how many (default: 20)"
    )
    parser.add_argument("--replay", action="store_true", help="run it again in the simulator")
    parser.add_argument(
        "--picture", metavar="FILE", help="with --replay: save its picture (.svg, .png, .webp)"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a run")
    parser.add_argument(
        "--by-hand", action="store_true", help="what people had the robot do without a program"
    )
    parser.add_argument("--delete", action="store_true", help="delete what is known of that run")
    parser.add_argument(
        "--delete-older-than",
        type=whole(0),
        metavar="DAYS",
        help="delete what is known of all runs that are older",
    )
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    log = open_log()
    terminal = Terminal(language=options.lang)
    if options.picture is not None and not options.replay:
        raise UserError("A picture is made of a replay. Add --replay.")
    if options.delete_older_than is not None:
        log.delete_by_hand(options.delete_older_than * DAY)
        return _delete(log, terminal, log.older_than(options.delete_older_than * DAY))
    if options.by_hand:
        _by_hand(log, terminal, options)
        return ExitStatus.OK
    if options.run is None:
        if options.replay:
            raise UserError("Say which run to replay: nl2robot log NUMBER --replay.")
        if options.delete:
            raise UserError("Say which run to delete: nl2robot log NUMBER --delete.")
        _list(log, terminal, options)
        return ExitStatus.OK
    row = log.run(options.run)
    if row is None:
        raise UserError(f"There is no run {options.run}. `nl2robot log` lists those there are.")
    if options.delete:
        if row.going_on:
            raise UserError(f"Run {row.id} is going on. Stop it, or wait for its end.")
        return _delete(log, terminal, [row.id])
    if options.json:
        print(json.dumps(log.whole(row), ensure_ascii=False))
    elif options.replay:
        from nl2robot.cli.replaying import replayed

        return replayed(log, row, terminal, options.picture)
    else:
        _show(log, row, terminal)
    return ExitStatus.OK


def _delete(log: RunLog, terminal: Terminal, runs: list[int]) -> int:
    log.delete(runs)
    words = _words(terminal)
    sentence = words["deleted_one" if len(runs) == 1 else "deleted"].format(number=len(runs))
    terminal.console.print(sentence, markup=False)
    return ExitStatus.OK


def _list(log: RunLog, terminal: Terminal, options: argparse.Namespace) -> None:
    runs = log.runs(options.last)
    if options.json:
        for row in runs:
            print(json.dumps(log.whole(row), ensure_ascii=False))
        return
    if not runs:
        terminal.console.print(_words(terminal)["nothing_yet"], markup=False)
        return
    table = terminal.table(*_words(terminal)["runs"])
    for row in reversed(runs):
        what = row.utterance or row.program.strip().partition("\n")[0]
        table.add_row(
            str(row.id), _when(row.started), _who(row, terminal), _how(row, terminal), visible(what)
        )
    terminal.console.print(table, markup=False)


def _by_hand(log: RunLog, terminal: Terminal, options: argparse.Namespace) -> None:
    done = log.done_by_hand(options.last)
    if options.json:
        for each in done:
            about = {**msgspec.to_builtins(each), "arguments": json.loads(each.arguments)}
            print(json.dumps(about, ensure_ascii=False))
        return
    if not done:
        terminal.console.print(_words(terminal)["nothing_by_hand"], markup=False)
        return
    table = terminal.table(*_words(terminal)["by_hand"])
    for each in reversed(done):
        table.add_row(_when(each.time), visible(each.who), _call(each.method, each.arguments))
    terminal.console.print(table, markup=False)


def _call(method: str, arguments: str) -> str:
    values = json.loads(arguments).items()
    given = ", ".join(f"{name}={value!r}" for name, value in values if value is not None)
    return visible(f"{method}({given})")


def _show(log: RunLog, row: Run, terminal: Terminal) -> None:
    words, language = _words(terminal), terminal.language
    about = {
        "run": f"{row.id}, {_how(row, terminal)}",
        "heard": row.heard,
        "understood": row.utterance,
        "approved": words["approved"].format(who=_who(row, terminal), when=_when(row.approved_at)),
        "changed": words["changed"].format(who=row.changed_by) if row.changed_by else None,
        "robot": words["robot"].format(
            robot=row.robot and sentences.told(row.robot, language), world=row.world
        ),
        "message": told(None, row.message, language) if row.message else None,
        "picture": row.picture,
        "program": f"SHA-256 {row.sha256[:16]}…",
    }
    for name, value in about.items():
        if value:
            line = visible(f"{words['about'][name] + ':':<12}{value}")
            terminal.console.print(line, markup=False, soft_wrap=True)
    if row.proposed is not None:
        names = words["was_proposed"], words["was_approved"]
        changed = difference(row.proposed, row.program, *names)
        terminal.console.print(visible(changed), markup=False, soft_wrap=True)
    terminal.show_program(row.program)
    table = terminal.table(*words["calls"])
    for call in log.calls(row.id):
        result = call.error or ("" if call.result in (None, "null") else call.result)
        if language != "en":
            result = call_trouble(call, language) or result
        seconds = words["never_came_back"] if call.seconds is None else f"{call.seconds:.2f}"
        asked = _call(call.method, call.arguments)
        table.add_row(str(call.number), str(call.line), asked, result, seconds)
    terminal.console.print(table, markup=False)
    for text in log.output(row.id):
        printed = words["printed"].format(text=visible(text).rstrip())
        terminal.console.print(printed, markup=False)


def _words(terminal: Terminal) -> Mapping[str, Any]:
    return texts_in(terminal.language, "log")


def _who(row: Run, terminal: Terminal) -> str:
    approved, proposed = approved_and_proposed(row.approved_by)
    if not proposed:
        return approved
    return str(_words(terminal)["proposed_by"].format(who=approved, proposer=proposed))


def _how(row: Run, terminal: Terminal) -> str:
    status = row.status or ("running" if row.going_on else "interrupted")
    return str(_words(terminal)["how"].get(status, status))


def _when(seconds: float) -> str:
    return datetime.fromtimestamp(seconds).strftime("%Y-%m-%d %H:%M:%S")
