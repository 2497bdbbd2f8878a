"""The weights in a file that CTranslate2 has converted (its format 6).

values = read(folder / "model.bin")
values["decoder/embeddings/weight"].shape
"""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

FORMAT: Final = 6
_KINDS: Final = (np.float32, np.int8, np.int16, np.int32, np.float16)


def read(path: Path) -> dict[str, NDArray[Any]]:
    """Every array by its name, as it lies in the file. Raises OSError, or ValueError if it is no
    such file."""
    file = _File(path.read_bytes())
    try:
        if (found := file.number("I")) != FORMAT:
            raise ValueError(f"{path} has the format {found}, not {FORMAT}")
        file.text()
        file.number("I")
        return {file.text(): file.array() for _ in range(file.number("I"))}
    except (struct.error, IndexError, _TooShort) as error:
        raise ValueError(f"{path} ends early or is damaged") from error


class _TooShort(Exception):
    """The file ends within an array."""


class _File:
    def __init__(self, data: bytes) -> None:
        self._data, self._at = data, 0

    def number(self, kind: str) -> int:
        (value,) = struct.unpack_from(f"<{kind}", self._data, self._at)
        self._at += struct.calcsize(f"<{kind}")
        return int(value)

    def text(self) -> str:
        length = self.number("H")
        self._at += length
        return self._data[self._at - length : self._at - 1].decode()  # a zero ends it

    def array(self) -> NDArray[Any]:
        shape = [self.number("I") for _ in range(self.number("B"))]
        kind = np.dtype(_KINDS[self.number("B")])
        count = self.number("I") // kind.itemsize
        if self._at + count * kind.itemsize > len(self._data):
            raise _TooShort
        values = np.frombuffer(self._data, kind, count, self._at).reshape(shape)
        self._at += count * kind.itemsize
        return values
