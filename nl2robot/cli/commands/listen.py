"""`nl2robot listen`: speech in, programs or answers out; never moves anything."""

from __future__ import annotations

import argparse
import json
import shutil
import sys
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Final, Protocol, TextIO

import msgspec

from nl2robot.cli.options.sentence import add_language, add_planner
from nl2robot.cli.options.world import add_world, names_of
from nl2robot.cli.waiting import GivenUp, thought_aloud
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.models.catalogue import lacking_beside, need
from nl2robot.sentences import told
from nl2robot.speech.audio import read
from nl2robot.speech.hear.answers import Answer, expect, hear_answer
from nl2robot.speech.hear.listening import (
    ANSWERS,
    COMMANDS,
    Listener,
    NothingHeard,
    PartialText,
    SpeechEnded,
    TooLong,
    has_speech,
)
from nl2robot.speech.hear.microphone import Microphone
from nl2robot.speech.hear.recogniser import load
from nl2robot.translate.routines import open_routines
from nl2robot.voice.hearing import Ear
from nl2robot.words import words_in

if TYPE_CHECKING:
    from nl2robot.speech.audio import Audio, Samples
    from nl2robot.speech.hear.listening import Event
    from nl2robot.speech.hear.recogniser import Heard

PATIENCE: Final = 30.0
"""Seconds without speech after which somebody may wonder whether the microphone is on."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    source = parser.add_mutually_exclusive_group(required=True)
    source.add_argument(
        "--wav", nargs="+", metavar="FILE", help="recordings (wav, flac, ogg, mp3, webm)"
    )
    source.add_argument("--mic", action="store_true", help="the microphone, until Ctrl-C")
    parser.add_argument(
        "--device", metavar="NAME", help="with --mic: which microphone, a part of its name"
    )
    parser.add_argument(
        "--expect",
        metavar="WHAT",
        help='what is said is an answer: digits, number, times, yes-no, or options as "a,b,c"',
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a file or utterance")
    add_world(parser)
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    if options.device is not None and not options.mic:
        raise UserError("--device chooses a microphone. Add --mic, or leave --device out.")
    need(options.lang)
    for sentence in lacking_beside(options.lang):
        print(told(sentence, options.lang), file=sys.stderr)
    if not options.mic:
        return recordings(options.wav, _hearing(options), options.lang)

    microphone = Microphone(options.device)  # before the model is loaded, for it may be missing
    hearing = _hearing(options)
    with microphone:
        blocks, quiet = microphone.blocks(), options.json
        return live(blocks, hearing, sys.stdout, quiet=quiet, language=options.lang)


class Hearing(Protocol):
    """What is made of speech, and printed."""

    def recording(self, audio: Audio) -> None: ...
    def listener(self) -> Listener: ...
    def spoken(self, speech: SpeechEnded) -> None: ...


def _hearing(options: argparse.Namespace) -> Hearing:
    return _Answers(options) if options.expect else _Commands(options)


class _Commands:
    def __init__(self, options: argparse.Namespace) -> None:
        self._options = options
        self._words = words_in(options.lang)
        knowledge = Knowledge(names_of(options), routines=open_routines())
        self._ear = Ear(knowledge, options.lang)
        for missing in self._ear.deaf_to():
            print(told(missing.message, options.lang), file=sys.stderr)

    def recording(self, audio: Audio) -> None:
        self._print(self._ear.hear(audio))

    def listener(self) -> Listener:
        return self._ear.listener(replace(COMMANDS, patience=PATIENCE))

    def spoken(self, speech: SpeechEnded) -> None:
        assert speech.heard is not None
        self._print(self._ear.understood(speech.heard))

    def _print(self, heard: Heard) -> None:
        translation = thought_aloud(
            lambda watch: self._ear.translate(heard, self._options.planner, watch=watch),
            self._options.lang,
        )
        if self._options.json:
            data = {**msgspec.to_builtins(translation), "heard": heard.text}
            print(json.dumps(data, ensure_ascii=False), flush=True)
        else:
            told = self._words["heard"].format(text=heard.text, share=f"{heard.confidence:.0%}")
            print(told)
            print(translation.readable(self._options.lang), flush=True)


class _Answers:
    def __init__(self, options: argparse.Namespace) -> None:
        self._json = options.json
        self._words = words_in(options.lang)
        self._expected = expect(options.expect, options.lang)
        self._recogniser = load(options.lang)

    def recording(self, audio: Audio) -> None:
        if has_speech(audio):
            heard = hear_answer(self._recogniser, audio, self._expected)
        else:
            heard = Answer("", None, 0.0)
        if self._json:
            print(json.dumps(msgspec.to_builtins(heard), ensure_ascii=False), flush=True)
        else:
            told = self._words["heard_answer" if heard.heard else "heard_none"].format(
                text=heard.heard, answer=heard.answer or "-", share=f"{heard.confidence:.0%}"
            )
            print(told, flush=True)

    def listener(self) -> Listener:
        # So short a speech is decoded as a whole when it has ended.
        return Listener(manner=replace(ANSWERS, patience=PATIENCE))

    def spoken(self, speech: SpeechEnded) -> None:
        self.recording(speech.audio)


def recordings(files: Sequence[str], hearing: Hearing, language: str = "en") -> int:
    """Hear every file; one that cannot be used does not keep the others from being heard, which is
    told in a language."""
    status = ExitStatus.OK
    for file in files:
        try:
            hearing.recording(read(file))
        except GivenUp:
            raise
        except UserError as error:
            print(told(str(error), language), file=sys.stderr)
            status = error.status
    return status


def live(
    blocks: Iterable[Samples],
    hearing: Hearing,
    output: TextIO,
    *,
    quiet: bool,
    language: str = "en",
) -> int:
    """Hear what is said until Ctrl-C, or until the sound ends. Partial words are shown where they
    can be overwritten, unless `quiet`; what else is told, in that language. Raises `AudioError`."""
    texts = words_in(language)
    listener = hearing.listener()
    line = _Line(output, shown=output.isatty() and not quiet)
    complained = False
    print(texts["speak_now"], file=sys.stderr, flush=True)
    try:
        for event in _events(listener, blocks):
            if isinstance(event, PartialText):
                line.show(event.text)
                continue
            line.clear()
            match event:
                case SpeechEnded():
                    complained = False
                    try:
                        hearing.spoken(event)
                    except UserError as error:  # the next one may be heard
                        print(told(str(error), language), file=sys.stderr)
                case TooLong():
                    print(texts["too_long"], file=sys.stderr)
                case NothingHeard(seconds) if not complained:
                    complained = True
                    nothing = texts["nothing_heard"].format(seconds=round(seconds))
                    print(nothing, file=sys.stderr)
    except KeyboardInterrupt:
        pass
    finally:
        line.clear()
    return ExitStatus.OK


def _events(listener: Listener, blocks: Iterable[Samples]) -> Iterator[Event]:
    for block in blocks:
        yield from listener.feed(block)
    yield from listener.finish()


class _Line:
    """A line of a terminal that is written again and again."""

    def __init__(self, output: TextIO, *, shown: bool) -> None:
        self._output = output
        self._shown = shown

    def show(self, text: str) -> None:
        if self._shown:
            width = shutil.get_terminal_size().columns - 3
            end = text if len(text) <= width else "…" + text[1 - width :]  # what was said last
            self._write(f"\r\x1b[K… {end}")

    def clear(self) -> None:
        if self._shown:
            self._write("\r\x1b[K")

    def _write(self, text: str) -> None:
        self._output.write(text)
        self._output.flush()
