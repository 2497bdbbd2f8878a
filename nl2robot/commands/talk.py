"""`nl2robot chat --voice`: what makes lines of what is said."""

from __future__ import annotations

import argparse
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from nl2robot.commands.options import names_of
from nl2robot.hearing import Ear
from nl2robot.knowledge import Knowledge
from nl2robot.models import need
from nl2robot.routines import open_routines
from nl2robot.speech.audio import RATE, Samples, read
from nl2robot.speech.hotword import HotWord, StopWord, default_word
from nl2robot.speech.listening import Manner
from nl2robot.speech.microphone import Microphone
from nl2robot.terminal import answers
from nl2robot.voice import PATIENCE, VoiceInput
from nl2robot.voice_terminal import VoiceTerminal

BLOCK = 0.1
"""Seconds of a recording that come at a time."""


@contextmanager
def voice_terminal(options: argparse.Namespace) -> Iterator[VoiceTerminal]:
    """A terminal that listens to the microphone or the recording that the options name. Raises
    `UserError` where there is none, or no speech model."""
    knowledge = Knowledge(names_of(options), routines=open_routines())

    def voice_for(language: str) -> VoiceInput:
        word = options.hot_word if language == options.lang else None
        return voice_input(knowledge, language, word)

    with ExitStack() as stack:
        if isinstance(options.voice, str):
            blocks = as_it_came(Path(options.voice))
        else:
            blocks = stack.enter_context(Microphone(options.device)).blocks()
        terminal = VoiceTerminal(blocks, voice_for, options.lang)
        stack.callback(terminal.close)
        word = options.hot_word or default_word(options.lang)
        terminal.console.print(terminal.words["say_hot_word"].format(word=word), markup=False)
        yield terminal


def voice_input(knowledge: Knowledge, language: str, word: str | None = None) -> VoiceInput:
    """What hears commands and answers about them in a language, after the hot `word`."""
    ear = Ear(need(language), knowledge, language)
    hot_word = HotWord(language, word)
    said = answers(language)
    also = [*said, hot_word.word]
    ear.get_ready(also)
    manner = Manner(patience=PATIENCE)
    return VoiceInput(
        lambda: ear.listener(manner, also),
        lambda heard: ear.chosen(heard, also=said),
        hot_word,
        StopWord(language),
        hot_words=[hot_word.word],
    )


def as_it_came(recording: Path) -> Iterator[Samples]:
    """A recording at the pace of its speakers; then silence for ever. Raises `AudioError`."""
    import numpy as np

    samples, step = read(recording).samples, int(BLOCK * RATE)
    began = time.monotonic()
    at = 0
    while True:
        block = samples[at : at + step]
        at += step
        time.sleep(max(0.0, began + at / RATE - time.monotonic()))
        yield np.pad(block, (0, step - len(block)))
