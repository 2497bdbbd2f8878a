"""`nl2robot languages`: what each language has, and a check of one."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from pathlib import Path

from grammar.language import languages, troubles
from grammar.languages import registry
from grammar.languages.checker import Finding
from nl2robot.checks.languages import check, overview
from nl2robot.cli.options.values import words
from nl2robot.cli.options.world import add_world, world_of
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.translation import translate


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_world(parser)
    parser.add_argument("--json", action="store_true", help="as JSON")
    actions = parser.add_subparsers(dest="action", metavar="check")
    checking = actions.add_parser(
        "check",
        help="look for what is wrong with a language, and for what it lacks",
        description="Look for what is wrong with a language, and for what it lacks.",
    )
    checking.add_argument(
        "language",
        metavar="CODE|FOLDER",
        help="such as de, or a folder that is called by the code of a language of your own",
    )
    checking.add_argument(
        "--say",
        action="append",
        default=[],
        type=words,
        metavar="SENTENCE",
        help="show also what this becomes; may be repeated",
    )
    add_world(checking)
    checking.add_argument("--json", action="store_true", help="one JSON object a finding")


def run(options: argparse.Namespace) -> int:
    """The exit status of a check is 1 if something is wrong; notes alone do not count."""
    return _check(options) if options.action == "check" else _list(options)


def _list(options: argparse.Namespace) -> int:
    listed = overview(world_of(options))
    if options.json:
        known = [asdict(each) for each in listed]
        print(json.dumps({"languages": known, "troubles": troubles()}, ensure_ascii=False))
        return ExitStatus.OK
    for each in listed:
        print(f"{each.code}  {each.name}: {each.samples} sample sentences")
        print(f"    texts: {each.texts} % of them, the others in English")
        print(f"    a robot asks in it: {'yes' if each.asked else 'no'}")
        print(f"    speech model: {each.model}")
        print(f"    voices: {', '.join(each.voices) or 'none'}")
    for trouble in troubles().values():
        print(trouble)
    return ExitStatus.OK


def _check(options: argparse.Namespace) -> int:
    code = _code_of(options.language)
    world = world_of(options)
    found = check(code, world)
    errors = [each for each in found if each.severity == "error"]
    for each in found:
        print(_as_json(each) if options.json else f"{each.severity}: {each}")
    if not options.json:
        print(f"{len(errors)} errors, {len(found) - len(errors)} notes")
    for sentence in options.say if code in languages() else ():
        translation = translate(sentence, Knowledge(world), code)
        print(f"\n{sentence}\n{translation.program or translation.message}")
        print(translation.explanation or "")
    return ExitStatus.FAILED if errors else ExitStatus.OK


def _as_json(finding: Finding) -> str:
    return json.dumps(asdict(finding), ensure_ascii=False)


def _code_of(given: str) -> str:
    """The language that is named, or that is in a folder, tried out from there. Raises
    `UserError`."""
    folder = Path(given)
    if given in registry.codes() or not folder.is_dir():
        return given
    if not any(folder.glob("*.yaml")):
        raise UserError(f"There is no .yaml in {folder}. Name the folder of a language.")
    try:
        registry.try_out(folder.resolve().name, folder.resolve())
    except registry.UnknownLanguage as error:
        raise UserError(str(error)) from error
    return folder.resolve().name
