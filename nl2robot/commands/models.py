"""`nl2robot models`: models for speech and language: list, get, verify."""

from __future__ import annotations

import argparse
import json

from nl2robot import models
from nl2robot.download import shown
from nl2robot.errors import ExitStatus, UserError


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
        print(f"The model is in {path}.")
        for model in models.list_models():
            second = options.language in model.beside and path != model.path
            if second and model.state == "installed":
                print(f"The second one is in {model.path}.")
        return ExitStatus.OK
    with shown() as progress:
        problems = models.verify(options.language, progress)
    print("\n".join(problems) or "What is installed is whole.")
    return ExitStatus.FAILED if problems else ExitStatus.OK


def _list(as_json: bool) -> int:
    listed = models.list_models()
    if as_json:
        print(json.dumps([models.as_json(model) for model in listed], ensure_ascii=False))
        return ExitStatus.OK
    width = max(len(model.language) for model in listed)
    for model in listed:
        named = f"{model.code:<13}  {model.language:<{width}}"
        print(f"{named} {model.state:<10} {model.megabytes:>5.0f} MB")
        if model.state != "installed":
            print(f"    nl2robot models get {model.code}")
    return ExitStatus.OK
