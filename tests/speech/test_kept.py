"""What the robot said before is there at once, and a disk that fails costs nothing but time."""

from __future__ import annotations

import errno
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest

from nl2robot.speech.speak.sound_cache import KeptSounds
from nl2robot.speech.speak.voices import Sound, joined, never


class Parrot:
    """Counts what it is asked to say."""

    name = "parrot"

    def __init__(self) -> None:
        self.said: list[str] = []

    def speak(
        self,
        text: str,
        *,
        speed: float = 1.0,
        pitch: float = 1.0,
        stopped: Callable[[], bool] = never,
    ) -> Iterator[Sound]:
        self.said.append(text)
        yield Sound(np.full(1000, len(text), np.int16), 8000)


@pytest.fixture
def parrot() -> Parrot:
    return Parrot()


def hear(kept: KeptSounds, parrot: Parrot, text: str) -> list[int]:
    return [int(sound.samples[0]) for sound in kept.speak(parrot, text)]


def test_a_greeting_is_made_once(parrot: Parrot) -> None:
    kept = KeptSounds(None)
    assert hear(kept, parrot, "Hello. How are you?") == [6, 12]
    assert hear(kept, parrot, "Hello. Go on.") == [6, 6]
    assert parrot.said == ["Hello.", "How are you?", "Go on."]


def test_it_is_still_there_tomorrow(parrot: Parrot, tmp_path: Path) -> None:
    hear(KeptSounds(tmp_path), parrot, "Hello.")
    sound = joined(KeptSounds(tmp_path).speak(parrot, "Hello."))
    assert (sound.rate, len(sound.samples), parrot.said) == (8000, 1000, ["Hello."])


def test_another_voice_says_it_itself(parrot: Parrot, tmp_path: Path) -> None:
    hear(KeptSounds(tmp_path), parrot, "Hello.")
    other = Parrot()
    other.name = "other"
    hear(KeptSounds(tmp_path), other, "Hello.")
    assert other.said == ["Hello."]


@pytest.mark.parametrize("damage", [b"", b"x", b"\0" * 3000])
def test_a_damaged_file_is_made_again(parrot: Parrot, tmp_path: Path, damage: bytes) -> None:
    hear(KeptSounds(tmp_path), parrot, "Hello.")
    [file] = tmp_path.iterdir()
    file.write_bytes(damage)
    assert hear(KeptSounds(tmp_path), parrot, "Hello.") == [6]
    assert hear(KeptSounds(tmp_path), parrot, "Hello.") == [6]
    assert parrot.said == ["Hello.", "Hello."]


def test_a_full_disk_keeps_nobody_from_speaking(
    parrot: Parrot, tmp_path: Path, monkeypatch
) -> None:
    def full(*_: object, **__: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(tempfile, "mkstemp", full)
    assert hear(KeptSounds(tmp_path), parrot, "Hello.") == [6]
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_cannot_be_made_does_neither(parrot: Parrot, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    assert hear(KeptSounds(tmp_path / "file" / "spoken"), parrot, "Hello.") == [6]


def test_the_folder_and_the_memory_stay_within_their_bounds(parrot: Parrot, tmp_path: Path) -> None:
    kept = KeptSounds(tmp_path, memory=5000, disk=10_000)  # a sound has 2000 bytes
    for number in range(20):
        hear(kept, parrot, f"Number {number}.")
    assert sum(file.stat().st_size for file in tmp_path.iterdir()) <= 10_000
    assert hear(kept, parrot, "Number 19.") and len(parrot.said) == 20
    hear(kept, parrot, "Number 1.")
    assert len(parrot.said) == 21


def test_half_a_sentence_is_not_kept(parrot: Parrot, tmp_path: Path) -> None:
    kept = KeptSounds(tmp_path)
    stopped = iter([False, True])
    assert list(kept.speak(parrot, "Hello.", lambda: next(stopped))) == []
    assert hear(kept, parrot, "Hello.") == [6]
    assert len(parrot.said) == 2
