"""`nl2robot routines`: commands that go by a name: list, explain, learn, change, rename, forget; to
hand them on in a file, and to review what came in one."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from nl2robot.cli.options.sentence import add_language
from nl2robot.cli.options.values import user_name, words
from nl2robot.cli.options.world import add_world, names_of
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate import routine_files
from nl2robot.translate.routines import as_data, open_routines
from nl2robot.translate.teaching import Pending, Reply, Teacher, settle
from sim.world.files import read_text

ACTIONS = (
    *("list", "explain", "learn", "change", "rename", "forget", "export", "import", "review"),
)
WITH_SENTENCE = {
    "learn": "go to every ward and say good night",
    "change": "go to ward a and say good night",
    "rename": "night round",
}
"""Actions that need something more than a name, with an example of it."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=ACTIONS, nargs="?", default="list")
    parser.add_argument(
        "name", nargs="?", type=words, help="what the routine is called; import: the file"
    )
    parser.add_argument(
        "sentence", nargs="?", type=words, help="learn, change: what it does; rename: its new name"
    )
    parser.add_argument("-y", "--yes", action="store_true", help="without being asked")
    parser.add_argument("--replace", action="store_true", help="import: also those of known names")
    parser.add_argument("-o", "--out", type=Path, help="export: the file; else it is printed")
    parser.add_argument("--json", action="store_true", help="list: one JSON object a routine")
    add_world(parser)
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    knowledge = Knowledge(names_of(options), routines=open_routines())
    if options.action == "list":
        return _list(knowledge, options.json)
    if options.action == "export":
        return _export(knowledge, options)
    if options.action == "import":
        return _import(knowledge, options)
    if options.action == "review":
        return _review(knowledge, options)
    example = '"evening round"'
    if options.action in WITH_SENTENCE:
        example += f' "{WITH_SENTENCE[options.action]}"'
    if not options.name or (options.action in WITH_SENTENCE) != bool(options.sentence):
        raise UserError(f"Write it so: nl2robot routines {options.action} {example}.")
    terminal = Terminal()
    reply = _reply(Teacher.of(knowledge, options.lang), options)
    terminal.console.print(reply.message, markup=False)
    if not isinstance(reply.pending, Pending):
        return ExitStatus.OK if reply.status == "ok" else ExitStatus.BAD_INPUT
    agreed = _agreed(terminal, options)
    told = settle(reply.pending, agreed, knowledge, user_name())
    terminal.console.print(told.message, markup=False)
    return ExitStatus.OK if agreed else ExitStatus.NOT_APPROVED


def _agreed(terminal: Terminal, options: argparse.Namespace) -> bool:
    return options.yes or terminal.ask("[y]es or [n]o? ").strip().lower() in ("y", "yes")


def _export(knowledge: Knowledge, options: argparse.Namespace) -> int:
    """All routines, or one, as a file."""
    assert knowledge.routines is not None
    known = knowledge.routines.known()
    if options.name:
        one = knowledge.routines.get(options.name, options.lang)
        if one is None:
            raise UserError(Teacher.of(knowledge, options.lang).unknown(options.name).message)
        known = (one,)
    if not known:
        raise UserError("There are no routines to export. Teach one first.")
    text = routine_files.exported(known)
    if options.out is None:
        print(text, end="")
        return ExitStatus.OK
    try:
        options.out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UserError(
            f"The routines cannot be written to {options.out} ({error.strerror})."
            " Choose another place."
        ) from error
    told = "One routine was" if len(known) == 1 else f"{len(known)} routines were"
    Terminal().console.print(f"{told} written to {options.out}.", markup=False)
    return ExitStatus.OK


def _import(knowledge: Knowledge, options: argparse.Namespace) -> int:
    """Those of a file, all that are new; each needs a review before it can be used."""
    if not options.name:
        raise UserError("Write it so: nl2robot routines import routines.yaml.")
    file = Path(options.name)
    try:
        text = read_text(file)
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is no text in UTF-8"
        raise UserError(f"The file {file} cannot be read ({why}). Check its name.") from error
    found = routine_files.read(text, str(file))
    terminal = Terminal()
    choices = []
    for number, each in enumerate(found):
        routine = each.routine
        state, why = routine_files.state_of(routine, knowledge)
        _, does = Teacher.of(knowledge, routine.language).does(routine)
        terminal.console.print(f"{routine.name} ({routine.language}): {does}", markup=False)
        if state == "same":
            terminal.console.print("  It is known here just so already.")
        elif state == "unfit":
            terminal.console.print(f"  {why} It is left out.", markup=False)
        elif state == "taken" and not options.replace:
            terminal.console.print(
                "  Another routine has this name here. It is left out; --replace puts it in its"
                " place."
            )
        else:
            replaces = state == "taken"
            if replaces:
                terminal.console.print("  It takes the place of the routine of this name.")
            choices.append(routine_files.Choice(number, routine.name, replaces))
    if not choices:
        terminal.console.print("There is nothing to import in this file.")
        return ExitStatus.OK
    terminal.console.print(f"Import {len(choices)} of {len(found)}?")
    if not _agreed(terminal, options):
        return ExitStatus.NOT_APPROVED
    for routine in routine_files.take_over(found, choices, knowledge, file.name):
        terminal.console.print(
            f"Imported: {routine.name}. Look at it before it can be used:"
            f' nl2robot routines review "{routine.name}"'
            + (f" --lang {routine.language}" if routine.language != "en" else ""),
            markup=False,
        )
    return ExitStatus.OK


def _review(knowledge: Knowledge, options: argparse.Namespace) -> int:
    """Look at what an imported routine does, and let it be used."""
    assert knowledge.routines is not None
    if not options.name:
        raise UserError('Write it so: nl2robot routines review "evening round".')
    routine = knowledge.routines.get(options.name, options.lang)
    teacher = Teacher.of(knowledge, options.lang)
    if routine is None:
        raise UserError(teacher.unknown(options.name).message)
    terminal = Terminal()
    terminal.console.print(teacher.explain(routine.name).message, markup=False)
    if routine.program:
        terminal.console.print(routine.program, markup=False)
    if routine.reviewed:
        terminal.console.print("It can be used already.")
        return ExitStatus.OK
    terminal.console.print("May it be used from now on?")
    if not _agreed(terminal, options):
        return ExitStatus.NOT_APPROVED
    knowledge.routines.accept(routine.name, routine.language, routine.body, user_name())
    terminal.console.print(f"The routine “{routine.name}” can be used now.", markup=False)
    return ExitStatus.OK


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
            always = {"sentence": routine.sentence, "learned": routine.learned}
            data = {**always, **as_data(routine), "works": works, "explanation": does}
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
