"""One decoder of libvosk: blocks of sound in, results out."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from typing import Any

from nl2robot.speech.audio import RATE

BLOCK = RATE // 4  # samples handed over at a time
READINGS = 10  # of each decoder


@dataclass(frozen=True)
class Scored:
    text: str
    score: float  # log likelihood of sound and words together; only differences mean anything


class Decoder:
    """A decoder of libvosk with what it has found. After `finish` the next sound may follow."""

    def __init__(self, kaldi: Any) -> None:
        self._kaldi = kaldi
        self._waiting = b""
        self._bytes = 0
        self.started = 0.0
        """Seconds of all sounds before this one: libvosk goes on counting."""
        self.results: list[dict[str, Any]] = []

    def feed(self, sound: bytes) -> None:
        self._waiting += sound
        whole = len(self._waiting) // (BLOCK * 2) * (BLOCK * 2)
        for start in range(0, whole, BLOCK * 2):
            self._decode(self._waiting[start : start + BLOCK * 2])
        self._waiting = self._waiting[whole:]

    @property
    def so_far(self) -> str:
        texts = [result.get("text", "") for result in self.results]
        texts.append(json.loads(self._kaldi.PartialResult()).get("partial", ""))
        return " ".join(filter(None, texts))

    def finish(self) -> None:
        if self._waiting:  # libvosk refuses an empty buffer
            self._decode(self._waiting)
        self._waiting = b""
        self.results.append(json.loads(self._kaldi.FinalResult()))

    def anew(self) -> Decoder:
        self.results = []
        self.started = self._bytes / 2 / RATE
        return self

    def _decode(self, block: bytes) -> None:
        self._bytes += len(block)
        # After a pause in the speech a result is complete, and the next begins.
        if self._kaldi.AcceptWaveform(block):
            self.results.append(json.loads(self._kaldi.Result()))


@cache
def helpers() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(os.cpu_count(), "second opinion")


def scored(results: Sequence[Mapping[str, Any]]) -> list[Scored]:
    """The likeliest texts with their scores, at least one."""
    texts = [Scored("", 0.0)]
    for result in results:
        # A pause divides the speech: every text so far goes on in each of these ways.
        texts = [
            Scored(f"{text.text} {way['text']}".strip(), text.score + way["confidence"])
            for text in texts
            for way in result.get("alternatives") or [{"text": "", "confidence": 0.0}]
        ]
        texts = sorted(texts, key=lambda text: -text.score)[:READINGS]
    return texts
