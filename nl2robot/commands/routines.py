"""`nl2robot routines`: commands that go by a name: list, explain, learn, change, rename, forget."""

from __future__ import annotations

import argparse
import json

import msgspec

from nl2robot.commands.options import add_language, add_world, names_of, words
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.routines import open_routines
from nl2robot.teaching import Reply, Teacher, settle
from nl2robot.terminal import Terminal

ACTIONS = ("list", "explain", "learn", "change", "rename", "forget")
WITH_SENTENCE = {
    "learn": "go to every ward and say good night",
    "change": "go to ward a and say good night",
    "rename": "night round",
}
"""Actions that need something more than a name, with an example of it."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=ACTIONS, nargs="?", default="list")
    parser.add_argument("name", nargs="?", type=words, help="what the routine is called")
    parser.add_argument(
        "sentence", nargs="?", type=words, help="learn, change: what it does; rename: its new name"
    )
    parser.add_argument("-y", "--yes", action="store_true", help="without being asked")
    parser.add_argument("--json", action="store_true", help="list: one JSON object a routine")
    add_world(parser)
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    knowledge = Knowledge(names_of(options), routines=open_routines())
    if options.action == "list":
        return _list(knowledge, options.json)
    example = '"evening round"'
    if options.action in WITH_SENTENCE:
        example += f' "{WITH_SENTENCE[options.action]}"'
    if not options.name or (options.action in WITH_SENTENCE) != bool(options.sentence):
        raise UserError(f"Write it so: nl2robot routines {options.action} {example}.")
    terminal = Terminal()
    reply = _reply(Teacher.of(knowledge, options.lang), options)
    terminal.console.print(reply.message, markup=False)
    if reply.pending is None:
        return ExitStatus.OK if reply.status == "ok" else ExitStatus.BAD_INPUT
    agreed = options.yes or terminal.ask("[y]es or [n]o? ").strip().lower() in ("y", "yes")
    terminal.console.print(settle(reply.pending, agreed, knowledge).message, markup=False)
    return ExitStatus.OK if agreed else ExitStatus.NOT_APPROVED


def _reply(teacher: Teacher, options: argparse.Namespace) -> Reply:
    match options.action:
        case "learn":
            return teacher.learn(options.name, options.sentence)
        case "change":
            return teacher.change(options.name, options.sentence)
        case "rename":
            return teacher.rename(options.name, options.sentence)
        case "forget":
            return teacher.forget(options.name)
        case _:
            return teacher.explain(options.name)


def _list(knowledge: Knowledge, as_json: bool) -> int:
    """All routines, with what each does in this world."""
    assert knowledge.routines is not None
    known = knowledge.routines.known()
    teachers = {code: Teacher.of(knowledge, code) for code in {each.language for each in known}}
    if as_json:
        for routine in known:
            works, does = teachers[routine.language].does(routine)
            data = {**msgspec.to_builtins(routine), "works": works, "explanation": does}
            print(json.dumps(data, ensure_ascii=False))
        return ExitStatus.OK
    terminal = Terminal()
    if not known:
        terminal.console.print(
            "No routines are known yet. Teach one:"
            ' nl2robot routines learn "evening round" "go to every ward and say good night"',
            markup=False,
        )
        return ExitStatus.OK
    table = terminal.table("routine", "language", "sentence", "what it does here")
    for routine in known:
        works, does = teachers[routine.language].does(routine)
        table.add_row(
            *map(terminal.plain, (routine.name, routine.language, routine.sentence)),
            terminal.plain(does) if works else f"[red]{terminal.plain(does)}[/]",
        )
    terminal.console.print(table)
    return ExitStatus.OK
