"""What people say and write, nearly right: sounds, programs and sentences.

Each is made out of what the project tests itself with, changed as a text or as bytes.
"""

from __future__ import annotations

import contextlib
import functools
import io
import random
import re
import wave
from pathlib import Path
from typing import Any, Final

import numpy as np
import soundfile
import yaml

from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.review.review import review
from nl2robot.speech.audio import AudioError, Converter, read_bytes
from nl2robot.speech.hear.recording import opened
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from robot_api.stub import stub
from sandbox.check import check
from sim.world.loading import load_world
from tests.attacks.inputs import LANGUAGES, Case, Target, Unfit, file, is_chosen, sentence
from tests.attacks.mutations import WORDS, bytes_like, text_like
from tests.sandbox.test_check import GOOD
from tests.sandbox.test_escapes import REACHING_OUT
from tests.speech.test_audio import opus, tone, webm

TESTS: Final = Path(__file__).parents[1]
SAID_AFTER: Final = "\x1e"
"""Between two sentences of a conversation."""
STATUSES: Final = {"ok", "clarify", "rejected"}

# --- sounds --------------------------------------------------------------------------------------


@functools.cache
def _sounds() -> list[bytes]:
    """Short ones in every wrapping."""
    sound = tone(8_000, 0.05)
    made = []
    for kind, subtype in (
        *(("WAV", each) for each in ("PCM_16", "PCM_U8", "PCM_24", "FLOAT", "ULAW", "IMA_ADPCM")),
        *(("FLAC", None), ("OGG", "VORBIS"), ("MP3", None), ("AIFF", None), ("W64", None)),
    ):
        held = io.BytesIO()
        with contextlib.suppress(soundfile.SoundFileError, ValueError):
            soundfile.write(held, sound, 8_000, format=kind, subtype=subtype)
            made.append(held.getvalue())
    wide = io.BytesIO()
    soundfile.write(wide, np.stack([sound] * 3, axis=1), 44_100, format="WAV")
    made.append(wide.getvalue())
    pipe = io.BytesIO()
    with wave.open(pipe, "wb") as writer:
        writer.setparams((1, 2, 16_000, 0, "NONE", ""))
        writer.writeframes(b"\x01\x02" * 200)
    made.append(pipe.getvalue()[:40] + b"\xff\xff\xff\xff" + pipe.getvalue()[44:])
    head, packets = opus(tone(48_000, 0.1))
    made += [webm(head, packets), webm(head, packets, known=True)]
    return made


def _make_sound(chance: random.Random) -> Case:
    return Case(bytes_like(chance, _sounds()))


def _feed_sound(case: Case) -> None:
    assert isinstance(case.data, bytes)
    for way in range(1 + 2 * is_chosen(case, 4)):
        try:
            if way == 0:
                read_bytes(case.data, "the recording.wav")
            elif way == 1:
                with opened(file("sound.wav", case.data)) as recording:
                    for _ in recording.blocks():
                        pass
            else:  # as it comes from a microphone
                size = 1 + len(case.data) // 3
                converter = Converter(max(1, size) * 997 % 60_000, 1 + size % 4)
                for at in range(0, len(case.data), size):
                    converter.convert(case.data[at : at + size])
                converter.finish()
        except AudioError as error:
            sentence(str(error))


# --- programs ------------------------------------------------------------------------------------


@functools.cache
def _knowledge() -> Knowledge:
    return Knowledge(load_world("city-hospital"))


@functools.cache
def _programs() -> list[str]:
    """What the tests of the check and of the sandbox try, and what the docs show."""
    docs = (TESTS.parent / "docs").glob("*.md")
    shown = [
        block
        for each in sorted(docs)
        for block in re.findall(r"```python\n(.*?)```", each.read_text("utf-8"), re.DOTALL)
        if "robot." in block
    ]
    return [GOOD, *shown, *REACHING_OUT.values()]


@functools.cache
def _lines() -> list[str]:
    return [line for program in _programs() for line in program.splitlines() if line.strip()]


def _make_program(chance: random.Random) -> Case:
    way = chance.random()
    if way < 0.35:  # lines that belong to different programs
        made = "\n".join(chance.choices(_lines(), k=chance.randint(1, 8)))
        return Case(made, chance.choice(LANGUAGES))
    if way < 0.9:
        words = [*WORDS, *_lines(), "(" * 300, "robot", "\t", "lambda: ", "f'{", "b'\\x", "1_" * 9]
        return Case(text_like(chance, _programs(), words, half=True), chance.choice(LANGUAGES))
    samples = [each.encode() for each in _programs()]
    return Case(bytes_like(chance, samples).decode("utf-8", "replace"), "en")


def _feed_program(case: Case) -> None:
    assert isinstance(case.data, str)
    try:
        case.data.encode()
    except UnicodeEncodeError:  # nothing that comes over the wire, but out of a program of ours
        found = check(case.data, stub())
    else:
        made = review(case.data, _knowledge(), language=case.how or "en")
        found = list(made.findings)
        for each in made.risks:
            sentence(each.message)
    for finding in found:
        sentence(finding.message)
        if finding.line < 1 or finding.column < 1:
            raise Unfit(f"something is wrong nowhere: {finding}")


# --- sentences -----------------------------------------------------------------------------------


def _said(value: Any) -> list[str]:
    if isinstance(value, dict):
        say = value.get("say")
        return [say] if isinstance(say, str) else [s for v in value.values() for s in _said(v)]
    return [s for v in value for s in _said(v)] if isinstance(value, list) else []


@functools.cache
def _sentences(language: str) -> list[str]:
    """What the tests of the grammar say."""
    found: list[str] = []
    for path in sorted((TESTS / "grammar").glob(f"*_{language}*.yaml")):
        found += _said(yaml.load(path.read_text("utf-8"), Loader=yaml.CBaseLoader))
    return [each for each in found if len(each) < 300]


@functools.cache
def _words(language: str) -> list[str]:
    return sorted({word for each in _sentences(language) for word in each.split()})


def _make_sentence(chance: random.Random) -> Case:
    language = chance.choice(LANGUAGES)
    turns = 2 if chance.random() < 0.15 else 1
    said = SAID_AFTER.join(_sentence(chance, language) for _ in range(turns))
    return Case(said, chance.choice(LANGUAGES) if chance.random() < 0.05 else language)


def _sentence(chance: random.Random, language: str) -> str:
    way = chance.random()
    words = _words(language)
    if way < 0.3:
        return " ".join(chance.choices(words, k=int(2 ** chance.uniform(0, 4.5))))
    if way < 0.85:
        return text_like(chance, _sentences(language), [*WORDS, *chance.sample(words, 40)])
    if way < 0.95:  # two that were cut, one after the other
        one, two = chance.choices(_sentences(language), k=2)
        return one[: chance.randrange(len(one) + 1)] + two[chance.randrange(len(two) + 1) :]
    if way < 0.99:
        return "".join(chance.choices("abcdeißé ?!.,\"'0123456789\0\n🤖\u202e\u0301", k=40))
    return " ".join(chance.choices(words, k=chance.choice((100, 400, 2000))))


def _feed_sentence(case: Case) -> None:
    assert isinstance(case.data, str)
    talk = Talk()
    for said in case.data.split(SAID_AFTER):
        try:
            told = translate(said, _knowledge(), case.how or "en", "grammar", talk)
        except UserError as error:
            sentence(str(error))
            continue
        if told.status not in STATUSES or (told.program is not None and told.status != "ok"):
            raise Unfit(f"{told.status} {'with' if told.program else 'without'} a program")
        told.to_json()
        told.readable(case.how or "en")
        if told.program is None:
            sentence(told.message)
        elif is_chosen(case, 10):
            wrong = [each for each in check(told.program, stub()) if each.severity == "error"]
            if wrong:
                raise Unfit(f"its program is refused: {wrong[0].message} {told.program!r}")


WORDED: Final = (
    Target("sounds", _make_sound, _feed_sound, 70_000),
    Target("programs", _make_program, _feed_program, 25_000),
    Target("sentences", _make_sentence, _feed_sentence, 35_000),
)
