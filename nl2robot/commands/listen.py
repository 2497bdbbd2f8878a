"""`nl2robot listen`: recordings in, programs or answers out; never moves anything."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path

import msgspec

from nl2robot.commands.options import add_language, add_planner, add_world, names_of
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.models import need
from nl2robot.routines import open_routines


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--wav", nargs="+", required=True, metavar="FILE", help="recordings (wav, flac, ogg, mp3)"
    )
    parser.add_argument(
        "--expect",
        metavar="WHAT",
        help='digits, yes-no, or options as "a,b,c": what is said is the answer to a question',
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a file")
    add_world(parser)
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    model = need(options.lang)
    if options.expect:
        return _answers(options, model)
    from nl2robot.hearing import Ear

    ear = Ear(model, Knowledge(names_of(options), routines=open_routines()), options.lang)
    for missing in ear.deaf_to():
        print(missing.message, file=sys.stderr)

    def command(recording: Path) -> None:
        heard = ear.hear(recording)
        translation = ear.translate(heard, options.planner)
        if options.json:
            data = {**msgspec.to_builtins(translation), "heard": heard.text}
            print(json.dumps(data, ensure_ascii=False), flush=True)
        else:
            print(f'heard: "{heard.text}" ({heard.confidence:.0%})')
            print(translation.readable(options.lang), flush=True)

    return _each(options.wav, command)


def _answers(options: argparse.Namespace, model: Path) -> int:
    from nl2robot.speech.answers import expect, hear_answer
    from nl2robot.speech.audio import read
    from nl2robot.speech.recogniser import Recogniser

    expected = expect(options.expect, options.lang)
    recogniser = Recogniser(model, options.lang)

    def answer(recording: Path) -> None:
        heard = hear_answer(recogniser, read(recording), expected)
        if options.json:
            print(json.dumps(msgspec.to_builtins(heard), ensure_ascii=False), flush=True)
        else:
            said = f'"{heard.heard}"' if heard.heard else "nothing"
            print(f"heard: {said}, answer: {heard.answer or '-'} ({heard.confidence:.0%})")

    return _each(options.wav, answer)


def _each(files: list[str], hear: Callable[[Path], None]) -> int:
    """Hear every file; one that cannot be used does not keep the others from being heard."""
    status = ExitStatus.OK
    for file in files:
        try:
            hear(Path(file))
        except UserError as error:
            print(error, file=sys.stderr)
            status = error.status
    return status
