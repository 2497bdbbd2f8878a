"""How long after the last sound of a command its text is there: `python -m nl2robot.bench.delay`
(`--lang de recording.wav ...`).

Recordings are fed as a microphone would, in real time, so that the decoders have as long as they
will have. The last sound is the last ten milliseconds that are not quiet; the pause that ends an
utterance is taken off, for it is chosen (`listening.COMMANDS`), not computed.
"""

from __future__ import annotations

import argparse
import json
import resource
import statistics
import time
from collections.abc import Sequence
from itertools import chain
from pathlib import Path

import numpy as np

from nl2robot.errors import UserError
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.paths import PACKAGED
from nl2robot.speech.audio import RATE, Audio, Samples, read
from nl2robot.speech.hear.listening import COMMANDS, FRAME, Listener, SpeechEnded, voice_detector
from nl2robot.voice.hearing import Ear
from sim.world.loading import load_world

BLOCK = RATE // 50  # 20 ms, as a microphone gives them
QUIET = 0.02  # of the peak
REPEATS = 3


def measure(recordings: Sequence[Audio], ear: Ear, repeats: int = REPEATS) -> dict[str, float]:
    """Milliseconds and ratios by name. Takes as long as the recordings, several times."""
    texts, programs, feeding, length = [], [], 0.0, 0.0
    listener = ear.listener()
    for recording in chain.from_iterable([recordings] * repeats):
        quiet = np.random.default_rng(0).normal(0, 3, RATE).astype(np.int16)
        samples = np.concatenate([quiet[: RATE // 2], recording.samples, quiet, quiet])
        last = (RATE // 2 + _last_sound(recording.samples)) / RATE
        started, heard = time.perf_counter(), False
        for at in range(0, len(samples) - BLOCK, BLOCK):
            due = started + (at + BLOCK) / RATE  # when the microphone would have it
            time.sleep(max(0.0, due - time.perf_counter()))
            before = time.process_time()
            events = listener.feed(samples[at : at + BLOCK])
            feeding += time.process_time() - before
            length += BLOCK / RATE
            for event in events:
                if isinstance(event, SpeechEnded) and event.heard is not None and not heard:
                    heard = True
                    texts.append(time.perf_counter() - started - last)
                    ear.translate(ear.understood(event.heard))
                    programs.append(time.perf_counter() - started - last)
    pause = COMMANDS.pause
    return {
        "utterances": len(texts),
        "pause that ends an utterance (ms)": 1000 * pause,
        "last sound to text, beyond the pause (ms), median": 1000
        * (statistics.median(texts) - pause),
        "the same, slowest of twenty": 1000 * (sorted(texts)[int(len(texts) * 0.95)] - pause),
        "last sound to program, beyond the pause (ms), median": 1000
        * (statistics.median(programs) - pause),
        "time of a core by that of the sound, voice detector": _detector(recordings),
        "time of a core by that of the sound, with decoders": feeding / length,
        "memory (MB)": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,
    }


def _last_sound(samples: Samples) -> int:
    """Where it ends, in samples."""
    step = RATE // 100
    whole = np.abs(samples[: len(samples) // step * step].astype(np.int32)).reshape(-1, step)
    loud = np.nonzero(whole.max(axis=1) > QUIET * whole.max())[0]
    return int(loud[-1] + 1) * step


def _detector(recordings: Sequence[Audio]) -> float:
    detector, taken, frames = voice_detector(), 0.0, 0
    for recording in recordings:
        for at in range(0, len(recording.samples) - FRAME, FRAME):
            before = time.process_time()
            detector(recording.samples[at : at + FRAME])
            taken += time.process_time() - before
            frames += 1
    return taken / (frames * FRAME / RATE)


def main(arguments: Sequence[str] | None = None) -> None:
    """Of these files, or of the recordings of commands that come with nl2robot."""
    shown = sorted((PACKAGED / "recordings").glob("*.wav"))
    parser = argparse.ArgumentParser(description="How long after a command its text is there.")
    parser.add_argument("files", nargs="*", type=Path, default=shown)
    parser.add_argument("--lang", default="en")
    options = parser.parse_args(arguments)
    try:
        recordings = [read(file) for file in options.files]
        ear = Ear(Knowledge(load_world(DEFAULT_WORLD)), options.lang)
    except UserError as error:
        raise SystemExit(str(error)) from error
    Listener()  # loads the detector
    print(json.dumps(measure(recordings, ear), indent=2))


if __name__ == "__main__":
    main()
