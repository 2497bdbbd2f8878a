"""`nl2robot chat --voice`: what makes lines of what is said."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from nl2robot.cli.options.world import names_of
from nl2robot.cli.terminal import answers
from nl2robot.cli.voice_terminal import VoiceTerminal
from nl2robot.knowledge import Knowledge
from nl2robot.models.catalogue import lacking_beside
from nl2robot.speech.audio import RATE, Audio, Samples, read
from nl2robot.speech.hear.full_duplex import FullDuplex
from nl2robot.speech.hear.listening import Manner
from nl2robot.speech.hear.microphone import Microphone
from nl2robot.speech.hotword.detector import HotWord, StopWord, default_word
from nl2robot.translate.routines import open_routines
from nl2robot.voice.hearing import Ear
from nl2robot.voice.voice import PATIENCE, OwnVoice, VoiceInput

BLOCK = 0.1
"""Seconds of a recording that come at a time."""
SILENCE = 3.0
"""Seconds behind a recording: what is said at its end is over by then."""


@contextmanager
def voice_terminal(
    options: argparse.Namespace, duplex: FullDuplex | None = None
) -> Iterator[VoiceTerminal]:
    """A terminal that listens to the microphone or the recording that the options name. Raises
    `UserError` where there is none, or no speech model."""
    knowledge = Knowledge(names_of(options), routines=open_routines())
    for sentence in lacking_beside(options.lang):
        print(sentence, file=sys.stderr)
    own_voice = OwnVoice()
    aloud = options.speak is True or options.robot != "sim"

    def robot_says(word: str) -> bool:
        if duplex is not None:
            return duplex.hears_nobody()
        return aloud and own_voice.says(word)

    def voice_for(language: str) -> VoiceInput:
        word = options.hot_word if language == options.lang else None
        return voice_input(knowledge, language, word, robot_says)

    with ExitStack() as stack:
        if isinstance(options.voice, str):
            blocks = as_it_came(read(Path(options.voice)))
        else:
            microphone = stack.enter_context(Microphone(options.device))
            blocks = duplex.hear(microphone.timed_blocks()) if duplex else microphone.blocks()
        terminal = VoiceTerminal(
            blocks, voice_for, options.lang, own_voice=own_voice, aloud=options.speak is True
        )
        stack.callback(terminal.close)
        word = options.hot_word or default_word(options.lang)
        terminal.console.print(terminal.words["say_hot_word"].format(word=word), markup=False)
        yield terminal


def voice_input(
    knowledge: Knowledge,
    language: str,
    word: str | None = None,
    says_itself: Callable[[str], bool] = lambda word: False,
) -> VoiceInput:
    """What hears commands and answers about them in a language, after the hot `word`."""
    ear = Ear(knowledge, language)
    hot_word = HotWord(language, word)
    said = answers(language)
    also = [*said, hot_word.word]
    ear.get_ready(also)
    manner = Manner(patience=PATIENCE)
    return VoiceInput(
        lambda: ear.listener(manner, also),
        lambda heard: ear.understood(heard, also=said),
        hot_word,
        StopWord(language),
        hot_words=[hot_word.word],
        says_itself=says_itself,
    )


def as_it_came(recording: Audio) -> Iterator[Samples]:
    """A recording at the pace of its speakers, and some silence."""
    import numpy as np

    step = int(BLOCK * RATE)
    samples = np.concatenate([recording.samples, np.zeros(int(SILENCE * RATE), np.int16)])
    began = time.monotonic()
    for at in range(0, len(samples), step):
        time.sleep(max(0.0, began + (at + step) / RATE - time.monotonic()))
        yield samples[at : at + step]
