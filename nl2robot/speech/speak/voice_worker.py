"""The process that speaks: `python voice_worker.py espeak`, or `piper`.

espeak-ng and piper stand under the GPL. This file is a program of its own: it imports nothing of
nl2robot, nothing of nl2robot imports it, and what is said between them goes through two pipes
(`voice_process` is the other end). Nowhere else is either of them imported.

A frame is how long its head and its body are (4 bytes each, the largest first), the head in JSON,
and the body. What is to be done has no body:

    {"id": 1, "do": "speak", "voice": "en-us+f3", "text": "Good morning.", "speed": 1, "pitch": 1}
    {"id": 2, "do": "speak", "model": FILE, "described": FILE, "text": "Good morning.", "speed": 1}
    {"id": 3, "do": "tell", "voice": "en-us", "text": "Hey robot!"}
    {"id": 1, "do": "cancel"}

What comes of it, in the same order; a cancellation overtakes, and what was cancelled is not whole:

    {"ready": true}                 first of all; false where the program cannot be started
    {"id": 1, "rate": 22050}        and the samples, 16 bit of one channel
    {"id": 3, "text": "hˈeɪ ɹˈoʊbɑːt!"}
    {"id": 2, "cannot": "model"}    or "voice"

It ends when nobody can send anything any more, in the middle of a word, too.
"""

from __future__ import annotations

import ctypes
import json
import os
import re
import struct
import sys
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from queue import SimpleQueue
from typing import Any, BinaryIO, Final, NoReturn

WORDS_A_MINUTE: Final = 165
"""At which espeak-ng speaks when it is told nothing else (its own default is 175)."""
PAUSE: Final = 0.2
"""Seconds of silence after what piper speaks; espeak-ng makes its own."""

LENGTHS: Final = struct.Struct(">II")

_INITIALISE_FAILED: Final = -1
_RETRIEVAL: Final = 1  # AUDIO_OUTPUT_RETRIEVAL: samples come to the callback
_UTF8: Final = 1  # and neither espeakSSML nor espeakPHONEMES: text is text
_IPA: Final = 2  # in the mode of phonemes
_MARKED: Final = re.compile(r"([^,.;:!?…]+)([,.;:!?…]*\s*)")  # what espeak-ng leaves out of them
_RATE, _PITCH = 1, 3  # espeak_PARAMETER
_SLOWEST, _FASTEST = 80, 450  # words a minute that espeak-ng takes
_CALLBACK: Final = ctypes.CFUNCTYPE(
    ctypes.c_int, ctypes.POINTER(ctypes.c_short), ctypes.c_int, ctypes.c_void_p
)

Order = Mapping[str, Any]
IsCancelled = Callable[[], bool]


class Cannot(Exception):
    """Why not, in a word."""


class Espeak:
    """espeak-ng from the package espeakng-loader; it keeps one voice at a time."""

    def __init__(self) -> None:
        import espeakng_loader

        self._library = ctypes.CDLL(espeakng_loader.get_library_path())
        data = str(Path(espeakng_loader.get_data_path()).parent)
        self._rate = self._library.espeak_Initialize(_RETRIEVAL, 0, os.fsencode(data), 0)
        if self._rate == _INITIALISE_FAILED:
            raise Cannot("start")
        self._library.espeak_TextToPhonemes.restype = ctypes.c_char_p
        self._library.espeak_TextToPhonemes.argtypes = (
            *(ctypes.c_void_p, ctypes.c_int, ctypes.c_int),
        )

    def speak(self, order: Order, is_cancelled: IsCancelled) -> tuple[int, bytes]:
        received: list[bytes] = []

        def receive(samples: Any, count: int, _events: Any) -> int:
            if samples and count:
                received.append(ctypes.string_at(samples, count * ctypes.sizeof(ctypes.c_short)))
            return int(is_cancelled())  # 1 ends the synthesis

        callback = _CALLBACK(receive)
        data = _encoded(order["text"])
        words_a_minute = round(min(_FASTEST, max(_SLOWEST, WORDS_A_MINUTE * order["speed"])))
        self._choose(order["voice"])
        library = self._library
        library.espeak_SetSynthCallback(callback)
        library.espeak_SetParameter(_RATE, words_a_minute, 0)
        library.espeak_SetParameter(_PITCH, round(min(99, max(0, 50 * order["pitch"]))), 0)
        library.espeak_Synth(data, len(data) + 1, 0, 0, 0, _UTF8, None, None)
        library.espeak_Synchronize()
        return self._rate, b"".join(received)

    def tell(self, order: Order) -> str:
        """How a text is spoken, in the letters of the IPA, with its punctuation."""
        self._choose(order["voice"])
        told: list[str] = []
        for words, marks in _MARKED.findall(order["text"]):
            left = ctypes.c_char_p(_encoded(words))
            while left.value:  # a clause each time; it moves the pointer on
                clause = self._library.espeak_TextToPhonemes(ctypes.byref(left), _UTF8, _IPA)
                told.append(clause.decode())
            told.append(marks)
        return "".join(told).replace("\u200d", "")

    def _choose(self, voice: str) -> None:
        if self._library.espeak_SetVoiceByName(_encoded(voice)) != 0:
            raise Cannot("voice")


class Piper:
    """Neural voices: a model and its description each, loaded when it first speaks and kept."""

    def __init__(self) -> None:
        import piper

        self._load: Final = piper.PiperVoice.load
        self._config: Final = piper.SynthesisConfig
        self._loaded: dict[str, Any] = {}

    def speak(self, order: Order, is_cancelled: IsCancelled) -> tuple[int, bytes]:
        rate, parts = 16_000, []
        try:
            voice = self._voice(order["model"], order["described"])
            config = self._config(length_scale=1 / order["speed"])
            for sound in voice.synthesize(order["text"], config):
                if is_cancelled():
                    break
                rate = sound.sample_rate
                parts += [sound.audio_int16_bytes, bytes(2 * int(PAUSE * rate))]
        except Exception as error:  # onnxruntime and json have errors of their own
            raise Cannot("model") from error
        return rate, b"".join(parts)

    def tell(self, order: Order) -> str:
        raise Cannot("voice")

    def _voice(self, model: str, described: str) -> Any:
        if model not in self._loaded:
            self._loaded[model] = self._load(model, described)
        return self._loaded[model]


KINDS: Final[Mapping[str, type[Espeak] | type[Piper]]] = {"espeak": Espeak, "piper": Piper}


class Worker:
    """Does what it is told, one order after the other; only a cancellation overtakes."""

    def __init__(self, out: BinaryIO) -> None:
        self._out = out
        self._orders: SimpleQueue[Order] = SimpleQueue()
        self._cancelled = 0
        """The newest that was; whoever asked for one before has an answer, or wants none."""

    def listen(self, source: BinaryIO) -> NoReturn:
        """Take orders until there can be no more; then all ends at once."""
        while len(lengths := source.read(LENGTHS.size)) == LENGTHS.size:
            head, body = LENGTHS.unpack(lengths)
            order = json.loads(source.read(head))
            source.read(body)
            if order["do"] == "cancel":
                self._cancelled = order["id"]
            else:
                self._orders.put(order)
        os._exit(0)

    def work(self, kind: str) -> None:
        try:
            speaks = KINDS[kind]()
        except Exception:  # noqa: BLE001 - a library that is damaged: whoever asks tells of it
            self._answer({"ready": False})
            return
        self._answer({"ready": True})
        while True:
            order = self._orders.get()
            number = order["id"]
            try:
                self._do(speaks, order)
            except Cannot as why:
                self._answer({"id": number, "cannot": str(why)})

    def _do(self, speaks: Espeak | Piper, order: Order) -> None:
        number = order["id"]
        if number <= self._cancelled:
            self._answer({"id": number, "rate": 16_000})
        elif order["do"] == "tell":
            self._answer({"id": number, "text": speaks.tell(order)})
        else:
            rate, samples = speaks.speak(order, lambda: number <= self._cancelled)
            self._answer({"id": number, "rate": rate}, samples)

    def _answer(self, answer: Mapping[str, Any], body: bytes = b"") -> None:
        head = json.dumps(answer).encode()
        self._out.write(LENGTHS.pack(len(head), len(body)) + head + body)
        self._out.flush()


def _encoded(text: str) -> bytes:
    return text.encode(errors="ignore")  # half a letter, such as a broken terminal sends


def main() -> None:
    # What libraries print must not come between the frames.
    out = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    worker = Worker(out)
    threading.Thread(target=worker.listen, args=(sys.stdin.buffer,), daemon=True).start()
    try:
        worker.work(sys.argv[1])
    except BrokenPipeError:
        os._exit(0)  # nobody is there any more


if __name__ == "__main__":
    main()
