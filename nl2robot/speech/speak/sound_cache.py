"""What was spoken before, kept: a greeting is made once and is there at once from then on.

    for sound in KeptSounds(folder()).speak(voice("en"), "Good morning. How are you?"):
        ...

Kept piece by piece, in memory and in a folder that never grows beyond its bounds. It is only ever a
help: a full disk, a damaged file, a folder that may not be written cost time and nothing else.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import tempfile
import threading
from collections import OrderedDict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final

import numpy as np

from nl2robot.paths import cache_folder
from nl2robot.speech.speak.sentences import pieces
from nl2robot.speech.speak.voices import Sound, Voice, joined, never

MEMORY: Final = 8_000_000  # bytes of samples, about three minutes
DISK: Final = 64_000_000  # bytes
_FORM: Final = b"1"  # of the files; another form has other names
_DIGEST: Final = 32  # bytes of a checksum at the start of a file
_HEAD: Final = _DIGEST + 4  # and the rate


def folder() -> Path:
    """The folder for them; it need not be there."""
    return cache_folder() / "spoken"


class KeptSounds:
    """Any thread may use it, and any number of processes the same folder."""

    def __init__(self, folder: Path | None, memory: int = MEMORY, disk: int = DISK) -> None:
        """`folder`: None keeps nothing on the disk. `memory` and `disk` are bounds in bytes."""
        self._folder = folder
        self._most_memory, self._most_disk = memory, disk
        self._sounds: OrderedDict[str, Sound] = OrderedDict()
        self._bytes = 0
        self._lock = threading.Lock()

    def speak(
        self, voice: Voice, text: str, stopped: Callable[[], bool] = never
    ) -> Iterator[Sound]:
        """As `Voice.speak`, at once where the voice has spoken the piece before."""
        for piece in pieces(text):
            if stopped():
                return
            name = _name(voice, piece)
            sound = self._found(name)
            if sound is None:
                sound = joined(voice.speak(piece, stopped=stopped))
                if stopped():  # then it is not whole
                    return
                self._keep(name, sound)
            if sound.seconds:
                yield sound

    def _found(self, name: str) -> Sound | None:
        with self._lock:
            sound = self._sounds.get(name)
            if sound is not None:
                self._sounds.move_to_end(name)
                return sound
        sound = self._read(name)
        if sound is not None:
            self._remember(name, sound)
        return sound

    def _keep(self, name: str, sound: Sound) -> None:
        self._remember(name, sound)
        # No room, no right to write: the next time it is made again.
        with contextlib.suppress(OSError):
            self._write(name, sound)

    # --- in memory -------------------------------------------------------------------------------

    def _remember(self, name: str, sound: Sound) -> None:
        if sound.samples.nbytes > self._most_memory:
            return
        with self._lock:
            old = self._sounds.pop(name, None)
            self._bytes += sound.samples.nbytes - (old.samples.nbytes if old else 0)
            self._sounds[name] = sound
            while self._bytes > self._most_memory:
                self._bytes -= self._sounds.popitem(last=False)[1].samples.nbytes

    # --- on the disk -----------------------------------------------------------------------------

    def _read(self, name: str) -> Sound | None:
        if self._folder is None:
            return None
        file = self._folder / name
        try:
            data = file.read_bytes()
            if hashlib.sha256(data[_DIGEST:]).digest() != data[:_DIGEST]:
                file.unlink()  # damaged
                return None
            os.utime(file)  # used: it goes last
        except OSError:
            return None
        rate = int.from_bytes(data[_DIGEST:_HEAD], "little")
        return Sound(np.frombuffer(data[_HEAD:], np.int16), rate)

    def _write(self, name: str, sound: Sound) -> None:
        if self._folder is None:
            return
        self._folder.mkdir(mode=0o700, parents=True, exist_ok=True)  # what a patient was told
        data = sound.rate.to_bytes(4, "little") + sound.samples.astype("<i2").tobytes()
        number, new = tempfile.mkstemp(dir=self._folder, prefix=".new-")
        try:
            with open(number, "wb") as file:  # noqa: PTH123 - mkstemp gives a number
                file.write(hashlib.sha256(data).digest() + data)
            Path(new).replace(self._folder / name)
        except OSError:
            Path(new).unlink(missing_ok=True)
            raise
        self._shrink()

    def _shrink(self) -> None:
        """Delete those unused for longest until the folder is within its bounds."""
        assert self._folder is not None
        files = []
        for file in self._folder.iterdir():
            with contextlib.suppress(OSError):  # another process deleted it meanwhile
                about = file.stat()
                files.append((about.st_mtime, about.st_size, file))
        total = sum(size for _, size, _ in files)
        for _, size, file in sorted(files):
            if total <= self._most_disk:
                return
            file.unlink(missing_ok=True)
            total -= size


def _name(voice: Voice, piece: str) -> str:
    return hashlib.sha256(b"\0".join((_FORM, voice.name.encode(), piece.encode()))).hexdigest()
