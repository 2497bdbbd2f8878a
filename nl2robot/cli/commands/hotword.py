"""`nl2robot hotword`: says each time the hot word is heard; never moves anything."""

from __future__ import annotations

import argparse
import contextlib
import json
import sys
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING

from nl2robot.cli.options.sentence import add_language
from nl2robot.cli.options.values import words
from nl2robot.errors import ExitStatus
from nl2robot.speech.audio import RATE
from nl2robot.speech.hear.microphone import Microphone
from nl2robot.speech.hear.recording import opened
from nl2robot.speech.hotword.detector import HotWord, StopWord
from nl2robot.words import words_in

if TYPE_CHECKING:
    from nl2robot.speech.audio import Samples
    from nl2robot.speech.hear.recording import Recording
    from nl2robot.speech.hotword.detector import Detector

LONG = 60.0
"""Seconds of a recording from which on a bar tells how far it is."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--word", type=words, help='the hot word (default: that of the language, "hey robot")'
    )
    parser.add_argument(
        "--stop", action="store_true", help="listen for the language's words for stop instead"
    )
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--wav", metavar="FILE", help="in a recording of any length (wav, flac, ogg, mp3)"
    )
    source.add_argument("--mic", action="store_true", help="at the microphone, until Ctrl-C")
    parser.add_argument(
        "--device", metavar="NAME", help="with --mic: which microphone, a part of its name"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object each time")
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    ears = StopWord(options.lang) if options.stop else HotWord(options.lang, options.word)
    if options.mic:
        with Microphone(options.device) as microphone, contextlib.suppress(KeyboardInterrupt):
            _listen(ears, microphone.blocks(), options.json)
        return ExitStatus.OK

    with opened(options.wav) as recording:
        _listen(ears, _in_view(recording, options.lang), options.json)
    return ExitStatus.OK


def _in_view(recording: Recording, language: str) -> Iterator[Samples]:
    """The blocks of a recording; of a long one with a bar that tells how far it is, where somebody
    looks on."""
    if recording.seconds < LONG or not sys.stderr.isatty():
        yield from recording.blocks()
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn("{task.description}"), BarColumn(), TimeRemainingColumn())
    # What is found is written above the bar, unless a pipe gets it.
    with Progress(
        *columns,
        console=Console(stderr=True),
        transient=True,
        redirect_stdout=sys.stdout.isatty(),
    ) as progress:
        task = progress.add_task(words_in(language)["listening"], total=recording.seconds)
        for block in recording.blocks():
            yield block
            progress.update(task, advance=len(block) / RATE)


def _listen(ears: Detector, blocks: Iterable[Samples], as_json: bool) -> None:
    for block in blocks:
        for heard in ears.feed(block):
            if as_json:
                data = {"word": heard.word, "time": heard.time, "score": round(heard.score, 3)}
                print(json.dumps(data, ensure_ascii=False), flush=True)
            else:
                print(f"{heard.time:.1f} s: {heard.word}", flush=True)
