"""Whether a voice keeps to what is promised (`nl2robot.speech.speak.voices.Voice`).

for trouble in check_voice(voice("en", "ward"), "en"):
    print(trouble)
"""

from __future__ import annotations

import time
from collections.abc import Iterator
from itertools import islice
from typing import Final

import numpy as np

from grammar.language import languages, load_language
from nl2robot.errors import UserError
from nl2robot.speech.speak.voices import Sound, Voice, VoiceError, joined
from robot_api.errors import cause

PHRASES: Final = ("hello", "thanks", "about_me")
"""What it is to say, from the phrases of the language."""
ODD: Final = ("", " ", "…", "🙂", "<speak>1</speak>", "a\x00b", "ß¿漢字", "x" * 400, '"`$(ls)')
"""Texts that no voice needs to say, and none may stumble over."""
RATES: Final = (8_000, 48_000)
"""Samples a second."""
SECONDS_A_LETTER: Final = (0.02, 0.35)
LOUDEST: Final = 32_767
QUIET: Final = 0.01
"""The least loudness, as a share of the loudest there can be (root mean square)."""
CLIPPED: Final = 0.01
"""The most samples that may be as loud as can be."""
STOPS_WITHIN: Final = 0.5
"""Seconds from a stop to the end of the work."""


def check_voice(voice: Voice, language: str) -> list[str]:
    """A sentence for each thing that is wrong with a voice in a language."""
    known = load_language(language if language in languages() else "en")
    texts = [known.phrase(name) for name in PHRASES]
    try:
        found = [trouble for text in texts for trouble in _of_speech(voice, text)]
        found += _of_stop(voice, " ".join(texts))
    except Exception as error:  # noqa: BLE001 - others' code may do anything
        return [f"It cannot say “{texts[0]}” ({type(error).__name__}: {cause(error)})."]
    return [*dict.fromkeys((*found, *_of_odd_texts(voice)))]


def _of_speech(voice: Voice, text: str) -> Iterator[str]:
    sound = joined(voice.speak(text))
    least, most = RATES
    if sound.samples.dtype != np.int16 or sound.samples.ndim != 1:
        yield "Its samples are not of one channel with 16 bits."
        return
    if not least <= sound.rate <= most:
        yield f"Its rate is {sound.rate} samples a second; {least} to {most} can be played."
        return
    shortest, longest = (len(text) * seconds for seconds in SECONDS_A_LETTER)
    if not shortest <= sound.seconds <= longest:
        yield (
            f"“{text}” takes {sound.seconds:.1f} s; between {shortest:.1f} and {longest:.1f} s"
            " were to be expected."
        )
    yield from _of_loudness(sound)


def _of_loudness(sound: Sound) -> Iterator[str]:
    samples = np.abs(sound.samples.astype(np.float64)) / LOUDEST
    loudness = float(np.sqrt(np.mean(samples**2))) if len(samples) else 0.0
    if loudness < QUIET:
        yield f"It is too quiet to be heard: {loudness:.3f} of the loudest."
    if len(samples) and np.mean(samples >= 1.0) > CLIPPED:
        yield "It is clipped: many of its samples are as loud as can be."


def _of_stop(voice: Voice, text: str) -> Iterator[str]:
    """Stopped as soon as its first piece is there."""
    stops_at: list[float] = []
    pieces = voice.speak(text * 20, stopped=lambda: bool(stops_at))
    if not list(islice(pieces, 1)):
        return
    stops_at.append(time.monotonic())
    more = sum(1 for _ in pieces)
    took = time.monotonic() - stops_at[0]
    if took > STOPS_WITHIN or more > 1:
        yield f"It went on for {took:.1f} s and {more} pieces after it was stopped."


def _of_odd_texts(voice: Voice) -> Iterator[str]:
    for text in ODD:
        try:
            joined(voice.speak(text))
        except (VoiceError, UserError) as error:
            yield f"It stumbles over {text[:20]!r}: {error}"
        except Exception as error:  # noqa: BLE001 - others' code may do anything
            yield f"It stumbles over {text[:20]!r} ({type(error).__name__}: {cause(error)})."
