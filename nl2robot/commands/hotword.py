"""`nl2robot hotword`: says each time the hot word is heard; never moves anything."""

from __future__ import annotations

import argparse
import contextlib
import json
from collections.abc import Iterable
from typing import TYPE_CHECKING

from nl2robot.commands.options import add_language, words
from nl2robot.errors import ExitStatus

if TYPE_CHECKING:
    from nl2robot.speech.audio import Samples
    from nl2robot.speech.hotword import Detector


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--word", type=words, help='the hot word (default: that of the language, "hey robot")'
    )
    parser.add_argument(
        "--stop", action="store_true", help="listen for the language's words for stop instead"
    )
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument("--wav", metavar="FILE", help="in a recording (wav, flac, ogg, mp3)")
    source.add_argument("--mic", action="store_true", help="at the microphone, until Ctrl-C")
    parser.add_argument(
        "--device", metavar="NAME", help="with --mic: which microphone, a part of its name"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object each time")
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    from nl2robot.speech.hotword import HotWord, StopWord

    ears = StopWord(options.lang) if options.stop else HotWord(options.lang, options.word)
    if options.mic:
        from nl2robot.speech.microphone import Microphone

        with Microphone(options.device) as microphone, contextlib.suppress(KeyboardInterrupt):
            _listen(ears, microphone.blocks(), options.json)
        return ExitStatus.OK
    from nl2robot.speech.audio import RATE, read

    samples = read(options.wav).samples
    blocks = (samples[at : at + RATE] for at in range(0, len(samples), RATE))
    _listen(ears, blocks, options.json)
    return ExitStatus.OK


def _listen(ears: Detector, blocks: Iterable[Samples], as_json: bool) -> None:
    for block in blocks:
        for heard in ears.feed(block):
            if as_json:
                data = {"word": heard.word, "time": heard.time, "score": round(heard.score, 3)}
                print(json.dumps(data, ensure_ascii=False), flush=True)
            else:
                print(f"{heard.time:.1f} s: {heard.word}", flush=True)
