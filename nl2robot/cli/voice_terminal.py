"""A terminal that also listens: what is said counts as typed."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

from rich.console import Console

from grammar.language import load_language
from nl2robot.cli.operator import Operator
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.sentences import told
from nl2robot.speech.audio import Samples
from nl2robot.voice.voice import (
    Cried,
    Ended,
    Event,
    Hears,
    OwnVoice,
    Said,
    Slept,
    SpokenLines,
    VoiceInput,
    Woke,
)

if TYPE_CHECKING:
    from sim.world.model import World

LOOK_EVERY = 0.05
"""Seconds between two looks at the keyboard."""
BELL = "\a"
CLEAR = "\r\x1b[K"


class VoiceTerminal(Terminal):
    """Takes lines from a microphone and from the keyboard, whichever comes first."""

    hears = True

    def __init__(
        self,
        blocks: Iterable[Samples],
        voice_for: Callable[[str], VoiceInput],
        language: str = "en",
        console: Console | None = None,
        own_voice: OwnVoice | None = None,
        aloud: bool = False,
    ) -> None:
        """`blocks` of sound come from the microphone; `voice_for` a language says how they are
        heard, and raises `UserError` where they cannot be."""
        self.aloud = aloud
        self._own_voice = own_voice or OwnVoice()
        self._voice_for = voice_for
        self._heard_language = language
        self._spoken = SpokenLines(voice_for(language), blocks)
        self._prompt = ""
        self._deaf = False
        """The microphone is gone, or the recording over; the keyboard is left."""
        self._no_keyboard = False
        """A robot in a corridor has none."""
        super().__init__(console, language)
        self._spoken.start()

    @property
    def somebody_is_there(self) -> bool:
        return True

    def speak(self, language: str) -> None:
        super().speak(language)
        if language == self._heard_language:
            return
        try:
            self._spoken.use(self._voice_for(language))
            self._heard_language = language
        except UserError as error:  # it can still be typed in
            self.console.print(told(str(error), language), markup=False)

    def accompany(self, operator: Operator, world: World | None = None) -> None:
        super().accompany(operator, world)
        operator.watch(self._own_voice.note, "speech", "program")

    def close(self) -> None:
        """Listen no more."""
        self._spoken.close()

    def next_line(self) -> str | None:
        self._show_prompt(f"\n{self.words['you']}")
        try:
            return self._line(awake=False)
        except EOFError:
            return None

    def ask(self, question: str, undecided: str | None = None) -> str:
        self._show_prompt(question)
        try:
            return self._line(awake=True)
        except EOFError:
            raise UserError(self.words["nobody_there"], ExitStatus.NOT_APPROVED) from None

    def typed(self, seconds: float) -> str | None:
        self._spoken.busy(True)
        self.heard = None
        if self._deaf:
            return super().typed(seconds)
        typed = None if self._no_keyboard else super().typed(0)
        if typed:
            return typed
        return self._said(self._next(seconds))

    def _line(self, awake: bool) -> str:
        """The next line, once it is there. Raises `EOFError` at the end of the input."""
        self.heard = None
        self._spoken.busy(False)
        if awake:
            self._spoken.wake()
        while True:
            if not self._no_keyboard and self.keyboard_ready(LOOK_EVERY if self._deaf else 0):
                line = sys.stdin.readline()
                if line:
                    return line.rstrip("\n")
                if sys.stdin.isatty():  # Ctrl-D
                    raise EOFError
                self._no_keyboard = True
            if self._deaf and self._no_keyboard:
                raise EOFError
            said = None if self._deaf else self._said(self._next(LOOK_EVERY))
            if said is not None:
                return said

    def _next(self, seconds: float) -> Event | None:
        try:
            return self._spoken.next(seconds)
        except UserError as error:
            self._deaf = True
            self.console.print(f"{CLEAR}{error}", markup=False)
            self._show_prompt(self._prompt)
            return None

    def _said(self, event: Event | None) -> str | None:
        """The line that an event is, if it is one; what else happens is shown."""
        match event:
            case Woke():
                self._show(f"{BELL}{self.words['listening']}")
            case Hears(text):
                self._show(f"{text} …")
            case Cried(word):
                return word
            case Ended():
                self._deaf = True
            case Said("") | Slept():
                self._show_prompt(self._prompt)
            case Said(text, doubtful=False):
                self._show(f"{text}\n")
                self.heard = text
                return text
            case Said(text, perhaps=perhaps):
                phrase = load_language(self.language).phrase
                unsure = phrase("heard_unsure", text=text, perhaps=perhaps)
                self._show(f"\n{unsure}\n")
                self._show_prompt(self._prompt)
                self._spoken.wake()
        return None

    def _show_prompt(self, prompt: str) -> None:
        self._prompt = prompt
        print(prompt, end="", flush=True)

    def _show(self, text: str) -> None:
        print(f"{CLEAR}{self._prompt.lstrip()}{text}", end="", flush=True)
