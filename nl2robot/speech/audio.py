"""Any sound as what the recogniser wants: 16 kHz, one channel, 16 bit.

Files: what libsndfile reads (wav of every rate and width, flac, ogg, mp3), and what browsers record
(webm). Live sound, which comes in blocks: `Converter`. Every failure is an `AudioError`: what is
wrong, and what to do about it.
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from nl2robot.errors import UserError
from nl2robot.speech import webm

RATE = 16_000  # samples a second
LONGEST = 600.0  # seconds; commands are short, and a film dropped here by mistake is not one
LARGEST = 512 * 1024**2  # bytes; ten minutes of the widest sound there is are less
FORMATS = "wav, flac, ogg, mp3 or webm"
SLOWEST, FASTEST = 1_000, 768_000  # samples a second of what is still a recording of a voice
CHANNELS = 16  # at most

Samples = NDArray[np.int16]


class AudioError(UserError):
    """A recording or a microphone cannot be used."""


@dataclass(frozen=True, eq=False)
class Audio:
    """Sound as the recogniser takes it."""

    samples: Samples  # one channel at RATE

    @property
    def seconds(self) -> float:
        return len(self.samples) / RATE


def read(path: Path | str) -> Audio:
    """The recording in this file. Raises AudioError."""
    path = Path(path)
    with reading(path) as file:
        return _read(file, path.stat().st_size, str(path))


@contextmanager
def reading(path: Path) -> Iterator[BinaryIO]:
    """The file of a recording, open. Raises AudioError."""
    if not path.is_file():
        what = "is a folder" if path.is_dir() else "is not there"
        raise AudioError(f"The recording {path} {what}. Check the name of the file.")
    try:
        if path.stat().st_size == 0:
            raise AudioError(f"The recording {path} is empty. Record it again.")
        with path.open("rb") as file:
            yield file
    except OSError as error:
        raise AudioError(
            f"The recording {path} cannot be read ({error.strerror}). Check who may read it."
        ) from error


def read_bytes(content: bytes, name: str) -> Audio:
    """The recording that is the content of a file; `name` is for messages. Raises AudioError."""
    return _read(io.BytesIO(content), len(content), name)


def _read(file: BinaryIO, size: int, name: str) -> Audio:
    import soundfile

    if size == 0:
        raise AudioError(f"The recording {name} is empty. Record it again.")
    if size > LARGEST:
        raise AudioError(
            f"The recording {name} is larger than {LARGEST // 1024**2} MB. "
            f"Use one of at most {LONGEST / 60:.0f} minutes, with one command in it."
        )
    start = file.read(4)
    file.seek(0)
    if start == webm.MAGIC:
        file = _unwrapped(file.read(), name)
    try:
        with soundfile.SoundFile(file) as sound:
            cut_short = start == b"RIFF" and _is_cut_short(file, size)
            return _decoded(sound, cut_short, name)
    except (soundfile.SoundFileError, MemoryError) as error:
        raise no_recording(name) from error


def no_recording(name: str) -> AudioError:
    return AudioError(f"The file {name} is broken or is not a recording. Use a {FORMATS} file.")


def _unwrapped(content: bytes, name: str) -> BinaryIO:
    try:
        return io.BytesIO(webm.to_ogg(content))
    except webm.CutShort as error:
        raise _cut_short(name) from error
    except webm.NoSound as error:
        raise without_sound(name) from error
    except webm.WebmError as error:
        raise AudioError(
            f"The file {name} is broken, or its sound is not of the kind that browsers record "
            f"(Opus). Use a {FORMATS} file."
        ) from error


def _decoded(sound: Any, cut_short: bool, name: str) -> Audio:
    check_voice(sound, name)
    rate: int = sound.samplerate
    if sound.frames > LONGEST * rate:
        raise _too_long(name, sound.frames / rate)
    # In pieces, for neither what the header promises nor what is packed in it is to be trusted with
    # memory: ten minutes of silence in eight fast channels are a small file, and twelve gigabytes.
    resampler, count, pieces = _resampler(rate, sound.channels), 0, []
    while len(frames := sound.read(max(rate, RATE), dtype="float32", always_2d=True)):
        count += len(frames)
        if count > LONGEST * rate:  # more than the header said
            raise _too_long(name, count / rate)
        pieces.append(_whole(_resampled(resampler, _finite(frames))))
    if count == 0:
        raise without_sound(name)
    if count < sound.frames or cut_short:
        raise _cut_short(name)
    pieces.append(_whole(_resampled(resampler, np.zeros((0, sound.channels)), last=True)))
    return Audio(_loudest(np.concatenate(pieces)))


def check_voice(sound: Any, name: str) -> None:
    """Raise AudioError if no voice has the rate or the channels of an open soundfile."""
    if not SLOWEST <= sound.samplerate <= FASTEST or sound.channels > CHANNELS:
        raise AudioError(
            f"The recording {name} says that it has {sound.samplerate} samples a second in "
            f"{sound.channels} channels, which no voice has. It is probably broken; record it"
            " again."
        )


def without_sound(name: str) -> AudioError:
    return AudioError(f"The recording {name} has no sound in it. Record it again.")


def _too_long(name: str, seconds: float) -> AudioError:
    return AudioError(
        f"The recording {name} is {seconds / 60:.0f} minutes long. "
        f"Use one of at most {LONGEST / 60:.0f} minutes, with one command in it."
    )


def _cut_short(name: str) -> AudioError:
    """Half a command may mean the opposite of the whole: "go to the pharmacy" (no, wait ...)."""
    return AudioError(f"The recording {name} ends in the middle. Copy or record it again.")


def _is_cut_short(file: BinaryIO, size: int) -> bool:
    """Whether a wav file's samples end before its header says; other formats tell by themselves.
    Leaves the file where it was."""
    here = file.tell()
    try:
        file.seek(12)
        left = size - 12
        while left >= 8:
            name, length = file.read(4), int.from_bytes(file.read(4), "little")
            left -= 8
            if name == b"data":
                # A recorder that writes into a pipe does not know the length and says "all".
                return length > left and length < 0x7FFF_0000
            file.seek(length + length % 2, 1)
            left -= length + length % 2
        return False
    finally:
        file.seek(here)


def from_float(frames: NDArray[np.float32], rate: int) -> Audio:
    """Samples between -1 and 1, of shape (frames, channels), at `rate` a second."""
    resampler = _resampler(rate, frames.shape[1])
    return Audio(_loudest(_whole(_resampled(resampler, _finite(frames), last=True))))


class Converter:
    """Live sound, block by block, of one rate and number of channels.

        converter = Converter(48_000, channels=2)
        samples = converter.convert(block)  # as they come; at last converter.finish()

    Of several channels, the one that has been the loudest for a while is heard.
    """

    _WEIGHT = 0.5  # seconds over which loudness is compared
    _LOUDER = 4.0  # times the energy that another channel must have before it is changed to

    def __init__(self, rate: int, channels: int = 1) -> None:
        """`rate` in samples a second. Raises AudioError if no voice has such a rate."""
        if not (SLOWEST <= rate <= FASTEST and 1 <= channels <= CHANNELS):
            raise AudioError(
                f"Sound with {rate} samples a second in {channels} channels cannot be used. "
                "Send one channel at 16000 or 48000."
            )
        self._rate = rate
        self._channels = channels
        self._rest = b""  # of a frame that ended in the middle
        self._energy = np.zeros(channels)
        self._loudest = 0
        self._resampler = _resampler(rate, 1)  # at 48 kHz it is 37 ms late

    def convert(self, block: bytes | NDArray[np.int16] | NDArray[np.float32]) -> Samples:
        """A block of any length: 16-bit samples, or floats between -1 and 1, the channels of a
        moment side by side; as bytes, 16 bit, the lower byte first."""
        frames = _finite(self._frames(block))
        if len(frames) == 0:
            return np.zeros(0, np.int16)
        channel = frames[:, self._loudest_of(frames), np.newaxis]
        return _whole(_resampled(self._resampler, channel))[:, 0]

    def finish(self) -> Samples:
        """What is still on its way; the converter then begins anew."""
        rest = _whole(_resampled(self._resampler, np.zeros((0, 1)), last=True))[:, 0]
        self._resampler = _resampler(self._rate, 1)
        self._rest = b""
        return rest

    def _frames(self, block: bytes | NDArray[np.int16] | NDArray[np.float32]) -> NDArray[Any]:
        if isinstance(block, bytes | bytearray | memoryview):
            content = self._rest + bytes(block)
            whole = len(content) // (2 * self._channels) * 2 * self._channels
            self._rest = content[whole:]
            block = np.frombuffer(content[:whole], "<i2")
        if block.dtype == np.int16:
            block = block.astype(np.float32) / np.float32(32768)
        return block.reshape(-1, self._channels)

    def _loudest_of(self, frames: NDArray[np.float32]) -> int:
        if self._channels > 1:
            kept = 0.5 ** (len(frames) / self._rate / self._WEIGHT)
            self._energy = self._energy * kept + np.square(frames).sum(axis=0)
            loudest = int(np.argmax(self._energy))
            if self._energy[loudest] > self._LOUDER * self._energy[self._loudest]:
                self._loudest = loudest
        return self._loudest


def _resampler(rate: int, channels: int) -> Any:
    """From `rate` to RATE, in pieces; None where there is nothing to do."""
    import soxr

    return None if rate == RATE else soxr.ResampleStream(rate, RATE, channels, "float32")


def _resampled(resampler: Any, frames: NDArray[Any], *, last: bool = False) -> NDArray[np.float32]:
    frames = np.ascontiguousarray(frames, np.float32)
    return frames if resampler is None else resampler.resample_chunk(frames, last=last)


def _loudest(frames: Samples) -> Samples:
    """The loudest channel: a mean would cancel a pair that is wired the wrong way round."""
    energy = np.square(frames, dtype=np.float64).sum(axis=0)
    return np.ascontiguousarray(frames[:, int(np.argmax(energy))])


def _finite(frames: NDArray[np.float32]) -> NDArray[np.float32]:
    return np.nan_to_num(frames, nan=0.0, posinf=1.0, neginf=-1.0)


def _whole(channel: NDArray[np.float32]) -> Samples:
    # Enormous samples become none at all in a resampler.
    return (_finite(np.clip(channel, -1.0, 1.0)) * 32767).astype(np.int16)
