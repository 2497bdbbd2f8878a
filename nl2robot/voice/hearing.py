"""From a recording to words: the recogniser, told what this world and this robot can be asked."""

from __future__ import annotations

import functools
from collections.abc import Container, Sequence
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from grammar.language import load_language
from grammar.plan import Text, calls, from_data
from grammar.planning.planner import Watch
from grammar.planning.rules import NAME as RULES
from grammar.samples import all_samples
from grammar.vocabulary import vocabulary
from nl2robot.knowledge import Knowledge
from nl2robot.schedule.schedule import Schedule
from nl2robot.speech.audio import RATE, Audio, read
from nl2robot.speech.hear.listening import COMMANDS, Listener, Manner, has_speech
from nl2robot.speech.hear.recogniser import Decoding, Heard, choose, load
from nl2robot.speech.hear.sounding_like import respelled
from nl2robot.speech.hear.streaming import Streaming
from nl2robot.speech.hear.vocabulary import Missing, missing_words
from nl2robot.speech.hotword.words import WORDS
from nl2robot.translate.completing import names_said
from nl2robot.translate.outcome import Translation
from nl2robot.translate.planners import AUTO
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from nl2robot.work import Do, here

MOST_RESPELLED: Final = 8
"""Texts with names of the world in the place of what sounds like them that are tried."""
LONGEST_CRY: Final = 3
"""Words: who wants the robot to stop says no more. "Go to the bus stop" is longer."""


class Ear:
    """Hears commands: whole sample sentences teach it which word follows which, the grammar's and
    the world's words are what it can hear at all."""

    def __init__(self, knowledge: Knowledge, language: str = "en", think: Do = here) -> None:
        """Sentences are thought about by `think` (`nl2robot.review.apart`). Raises ModelError if
        the language has no speech model here."""
        self._think = think
        lexicon = knowledge.lexicon(language)
        self.knowledge = knowledge
        self.language = language
        self.recogniser = load(language)
        self.phrases = [
            *all_samples(lexicon, language),
            *vocabulary(lexicon, language),
        ]

    def hear(self, recording: Path | Audio) -> Heard:
        """What a recording says: of its readings the best fitting one that is understood, for
        people say what makes sense. Music and noise say nothing. Raises `AudioError`."""
        audio = recording if isinstance(recording, Audio) else read(recording)
        if not has_speech(audio):
            return Heard("", 0.0, (), False, None, (), audio.seconds, 0.0)
        return self.understood(self.recogniser.recognise(audio, self.phrases))

    def listener(self, manner: Manner = COMMANDS, also: Sequence[str] = ()) -> Listener:
        """Hears live what `hear` hears of recordings, but for the choice (`understood`). `also`
        is what may be said besides commands."""
        return Listener(Streaming(self.recogniser, [*self.phrases, *also]), manner)

    def get_ready(self, also: Sequence[str] = ()) -> None:
        """Make the first command as fast as those after it: decoders are slow until they were used
        once."""
        noise = np.random.default_rng(0).normal(0, 500, RATE // 2).astype(np.int16)
        self.recogniser.recognise(Audio(noise), [*self.phrases, *also])

    def open(self, gain: float = 1.0) -> Decoding:
        """A decoding of a command to be fed with sound while it comes; `understood` chooses among
        what it finds."""
        return self.recogniser.open(self.phrases, gain=gain)

    def understood(self, heard: Heard, also: Container[str] = ()) -> Heard:
        """The reading that is understood, or is one of `also`; where none is, or it is about
        something that there is not here, the one with a name of the world that sounds like it."""

        def is_one(text: str) -> bool:
            return text.lower().replace(",", "") in also

        chosen = choose(heard, lambda text: is_one(text) or self._is_understood(text))
        if not chosen.text or chosen.doubtful or is_one(chosen.text):
            return chosen
        instead = self._with_names(chosen.text)
        return chosen if instead is None else replace(chosen, text=instead, words=())

    def _with_names(self, text: str) -> str | None:
        """The text with a name of the world in the place of what sounds like it: "fork", not
        "fourth", where there are forks. None if it makes sense as it is, or no more with one."""
        if self._is_about_here(text) is not False:
            return None
        names = names_said(self.knowledge.world, self.language)
        likely = islice(respelled(text, names, self.language, self._things), MOST_RESPELLED)
        return next((each for each in likely if self._is_about_here(each)), None)

    def _is_about_here(self, text: str) -> bool | None:
        """Whether a command is understood and speaks of nothing that there is not in this world;
        None for what is no command and needs no names: a question about a run, say."""
        translation = self._by_rules(text)
        if translation.request is not None:
            return None
        if translation.plan is None:
            return False
        spoken_of = {
            value.value.lower()
            for call in calls(from_data(translation.plan))
            for name, value in call.arguments.items()
            if name == "thing" and isinstance(value, Text)
        }
        return spoken_of <= self._things

    @functools.cached_property
    def _things(self) -> frozenset[str]:
        """What things may be called here: names, parts of names ("bottle", of a water bottle), and
        the kinds of things and people there are, here or in the language's lists."""
        world, pack = self.knowledge.world, load_language(self.language)
        names = [name.lower() for name in names_said(world, self.language)]
        kinds = {
            *(each.kind for each in world.objects),
            *(each.kind for each in world.people),
            *(each.kind for each in world.furniture),
        }
        parts = (part for name in names for part in name.split())
        listed = (pack.lists.get("person_kind", {}), pack.lists.get("furniture", {}))
        ways = (" ".join(way) for kind in listed for said in kind.values() for way in said)
        return frozenset((*names, *parts, *kinds, *pack.kinds, *listed[0], *listed[1], *ways))

    def program(self, text: str) -> str | None:
        """What a command means when it is typed, as far as the rules know. Asked of every few
        syllables, which is no work for a language model."""
        return self._by_rules(text).program

    def is_stop(self, text: str) -> bool:
        """Whether the words so far are a cry to stop: "stop", "please stop", "no, stop!"."""
        words = text.lower().split()
        if not words or len(words) > LONGEST_CRY:
            return False
        known = WORDS.get(self.language)
        if known is not None and words[-1] in known.stop:
            return True
        program = self.program(text)
        return program is not None and set(program.split()) == {"robot.stop()"}

    def _is_understood(self, text: str) -> bool:
        translation = self._by_rules(text)
        return translation.program is not None or translation.request is not None

    def deaf_to(self) -> list[Missing]:
        """The words in names of this world that the model can never hear, each with a way round. A
        second ear hears any."""
        if self.recogniser.second is not None:
            return []
        world = self.knowledge.world
        names = [item.name for items in (world.places, world.people) for item in items]
        return missing_words(self.recogniser, names)

    def translate(
        self,
        heard: Heard,
        planner: str = AUTO,
        talk: Talk | None = None,
        watch: Watch | None = None,
        schedule: Schedule | None = None,
    ) -> Translation:
        """The program for what was heard; nothing, and a question back, if that is in doubt. A
        language model is asked only about what surely was said: it makes sense of anything.
        `schedule` knows the appointments.
        Raises `grammar.planning.planner.Interrupted` when `watch` has ended it."""
        if heard.doubtful or not heard.text:
            translation = self._by_rules(heard.text)
        else:
            translation = translate(
                heard.text,
                self.knowledge,
                self.language,
                planner,
                talk,
                watch=watch,
                do=self._think,
                schedule=schedule,
            )
        phrase = load_language(self.language).phrase
        if not heard.text:
            return msgspec.structs.replace(translation, message=phrase("heard_nothing"))
        if translation.program is None or not heard.doubtful:
            return translation
        return msgspec.structs.replace(
            translation,
            status="clarify",
            program=None,
            plan=None,
            source=None,
            explanation="",
            confidence=heard.confidence * 0.5,
            message=phrase("heard_unsure", text=heard.text, perhaps=heard.free_text),
            suggestions=(heard.text,),
        )

    def _by_rules(self, text: str) -> Translation:
        return translate(text, self.knowledge, self.language, RULES, do=self._think)
