"""`nl2robot voices`: the voices of this machine by language, and a check of one."""

from __future__ import annotations

import argparse

from grammar.language import languages
from nl2robot.errors import ExitStatus
from nl2robot.speech.speak.checker import check_voice
from nl2robot.speech.speak.voices import others, voice, voices


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="check")
    checking = actions.add_parser(
        "check",
        help="have a voice speak, and look whether it keeps to what is promised",
        description="Have a voice speak, and look whether it keeps to what is promised.",
    )
    checking.add_argument("voice", metavar="NAME", help="such as piper, or as `voices` lists it")
    checking.add_argument(
        "--lang", choices=languages(), help="in this language (default: all that it speaks)"
    )


def run(options: argparse.Namespace) -> int:
    """The exit status of a check is 1 if something is wrong."""
    return _check(options.voice, options.lang) if options.action == "check" else _list()


def _list() -> int:
    troubles: dict[str, str] = {}
    for code in languages():
        troubles |= others(code)[1]
        print(f"{code}  {', '.join(each.name for each in voices(code)) or 'none'}")
    print(*troubles.values(), sep="\n", end="\n" if troubles else "")
    return ExitStatus.OK


def _check(name: str, language: str | None) -> int:
    codes = [language] if language else _languages_of(name)
    found = {code: check_voice(voice(code, name), code) for code in codes or ["en"]}
    for code, troubles in found.items():
        for trouble in troubles or ["It keeps to what is promised."]:
            print(f"{code}: {trouble}")
    return ExitStatus.FAILED if any(found.values()) else ExitStatus.OK


def _languages_of(name: str) -> list[str]:
    return [
        code
        for code in languages()
        if any(each.name == name or each.name.startswith(f"{name}-") for each in voices(code))
    ]
