"""`nl2robot models`: models for speech and language: list, get, verify."""

from __future__ import annotations

import argparse
import json

from nl2robot.errors import ExitStatus, UserError
from nl2robot.models import catalogue as models
from nl2robot.models.download import shown
from nl2robot.sentences import told
from nl2robot.words import terminal_language


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=("list", "get", "verify"), nargs="?", default="list")
    parser.add_argument("language", nargs="?", metavar="NAME", help="such as en, or planner")
    parser.add_argument("--again", action="store_true", help="get: even if it is installed")
    parser.add_argument("--json", action="store_true", help="list: as JSON")


def run(options: argparse.Namespace) -> int:
    if options.action == "list":
        return _list(options.json)
    if options.language is None:
        raise UserError(f"Say which one, such as: nl2robot models {options.action} en")
    if options.action == "get":
        with shown() as progress:
            path = models.get(options.language, progress, again=options.again)
        print(_told(f"The model is in {path}."))
        for model in models.list_models():
            second = options.language in model.beside and path != model.path
            if second and model.state == "installed":
                print(_told(f"The second one is in {model.path}."))
        return ExitStatus.OK
    with shown() as progress:
        problems = models.verify(options.language, progress)
    print("\n".join(map(_told, problems or ["What is installed is whole."])))
    return ExitStatus.FAILED if problems else ExitStatus.OK


def _told(sentence: str) -> str:
    return told(sentence, terminal_language())


def _own(words: str) -> str:
    """A few words of a table in the language of the terminal."""
    said = _told(words)
    return said if words[:1].isupper() else said[:1].lower() + said[1:]


def _list(as_json: bool) -> int:
    listed = models.list_models()
    if as_json:
        print(json.dumps([models.as_json(model) for model in listed], ensure_ascii=False))
        return ExitStatus.OK
    languages = [_own(model.language) for model in listed]
    states = [_own(model.state) for model in listed]
    width, wide = max(map(len, languages)), max(map(len, states))
    for model, language, state in zip(listed, languages, states, strict=True):
        named = f"{model.code:<13}  {language:<{width}}"
        print(f"{named} {state:<{wide}} {model.megabytes:>5.0f} MB")
        if model.state != "installed":
            print(f"    nl2robot models get {model.code}")
    return ExitStatus.OK
