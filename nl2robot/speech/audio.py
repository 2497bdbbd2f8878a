"""Any recording as what the recogniser wants: 16 kHz, one channel, 16 bit.

Reads what libsndfile reads (wav of every rate and width, flac, ogg, mp3). Every failure is an
`AudioError`: what is wrong with the file, and what to do about it.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError

RATE = 16_000  # samples a second
LONGEST = 600.0  # seconds; commands are short, and a film dropped here by mistake is not one
FORMATS = "wav, flac, ogg or mp3"

Samples = NDArray[np.int16]


class AudioError(UserError):
    """A recording cannot be used."""


@dataclass(frozen=True, eq=False)
class Audio:
    """Sound as the recogniser takes it."""

    samples: Samples  # one channel at RATE

    @property
    def seconds(self) -> float:
        return len(self.samples) / RATE


def read(path: Path | str) -> Audio:
    """The recording in this file. Raises AudioError."""
    import soundfile

    path = Path(path)
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "is not there"
        raise AudioError(f"The recording {path} {what}. Check the name of the file.")
    try:
        size = path.stat().st_size
        if size == 0:
            raise AudioError(f"The recording {path} is empty. Record it again.")
        with soundfile.SoundFile(path) as file:
            return _read(path, file)
    except soundfile.LibsndfileError as error:
        raise AudioError(
            f"The file {path} is broken or is not a recording. Use a {FORMATS} file."
        ) from error
    except OSError as error:
        raise AudioError(
            f"The recording {path} cannot be read ({error.strerror}). Check who may read it."
        ) from error


def _read(path: Path, file: Any) -> Audio:
    rate: int = file.samplerate
    if file.frames > LONGEST * rate:
        raise AudioError(
            f"The recording {path} is {file.frames / rate / 60:.0f} minutes long. "
            f"Use one of at most {LONGEST / 60:.0f} minutes, with one command in it."
        )
    # What the header promises is not to be trusted with memory.
    frames = file.read(int(LONGEST * rate), dtype="float32", always_2d=True)
    if len(frames) == 0:
        raise AudioError(f"The recording {path} has no sound in it. Record it again.")
    if len(frames) < file.frames or _is_cut_short(path):
        # Half a command may mean the opposite of the whole: "go to the pharmacy" (no, wait ...).
        raise AudioError(f"The recording {path} ends in the middle. Copy or record it again.")
    return from_float(frames, rate)


def _is_cut_short(path: Path) -> bool:
    """Whether a wav file's samples end before its header says; other formats tell by themselves."""
    with path.open("rb") as file:
        if file.read(4) != b"RIFF":
            return False
        file.seek(12)
        left = path.stat().st_size - 12
        while left >= 8:
            name, length = file.read(4), int.from_bytes(file.read(4), "little")
            left -= 8
            if name == b"data":
                # A recorder that writes into a pipe does not know the length and says "all".
                return length > left and length < 0x7FFF_0000
            file.seek(length + length % 2, 1)
            left -= length + length % 2
    return False


def from_float(frames: NDArray[np.float32], rate: int) -> Audio:
    """Samples between -1 and 1, of shape (frames, channels), at `rate` a second."""
    import soxr

    frames = np.nan_to_num(frames, nan=0.0, posinf=1.0, neginf=-1.0)
    # The loudest channel: a mean would cancel a pair that is wired the wrong way round.
    channel = frames[:, int(np.argmax(np.square(frames).sum(axis=0)))]
    if rate != RATE:
        channel = soxr.resample(channel, rate, RATE)
    return Audio((np.clip(channel, -1.0, 1.0) * 32767).astype(np.int16))
