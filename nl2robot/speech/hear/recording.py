"""A recording of any length, block by block, as a microphone would give it.

    with opened("night.wav") as recording:
        for block in recording.blocks():
            ears.feed(block)

What hears commands wants a whole one (`nl2robot.speech.audio.read`); who listens for a word through
a whole night must not keep the night in memory.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from nl2robot.speech import webm
from nl2robot.speech.audio import (
    RATE,
    AudioError,
    Converter,
    Samples,
    check_voice,
    no_recording,
    read,
    reading,
    without_sound,
)


@dataclass(frozen=True)
class Recording:
    """One that is open."""

    seconds: float
    """How long it says that it is."""
    _blocks: Iterator[Samples]

    def blocks(self) -> Iterator[Samples]:
        """A second at a time, at 16 kHz; once. Raises `AudioError` where the file is broken."""
        return self._blocks


@contextmanager
def opened(path: Path | str) -> Iterator[Recording]:
    """The recording in this file. One out of a browser (webm) is unwrapped as a whole, and so has
    at most ten minutes. Raises `AudioError`."""
    import soundfile

    path = Path(path)
    with reading(path) as file:
        start = file.read(4)
        file.seek(0)
        if start == webm.MAGIC:
            audio = read(path)
            seconds = range(0, len(audio.samples), RATE)
            yield Recording(audio.seconds, (audio.samples[at : at + RATE] for at in seconds))
            return
        try:
            with soundfile.SoundFile(file) as sound:
                check_voice(sound, str(path))
                yield Recording(sound.frames / sound.samplerate, _blocks(sound, str(path)))
        except (soundfile.SoundFileError, MemoryError) as error:
            raise no_recording(str(path)) from error


def _blocks(sound: Any, name: str) -> Iterator[Samples]:
    import soundfile

    converter, empty = Converter(sound.samplerate, sound.channels), True
    try:
        while len(frames := sound.read(sound.samplerate, dtype="float32", always_2d=True)):
            empty = False
            yield converter.convert(frames.reshape(-1))
    except soundfile.SoundFileError as error:
        raise AudioError(
            f"The recording {name} is broken in the middle. Copy or record it again."
        ) from error
    if empty:
        raise without_sound(name)
    yield converter.finish()
