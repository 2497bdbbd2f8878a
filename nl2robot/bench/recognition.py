"""How fast speech becomes text on this machine."""

from __future__ import annotations

import statistics
import time

from nl2robot.models.catalogue import need
from nl2robot.paths import PACKAGED
from nl2robot.speech import audio
from nl2robot.speech.hear.recogniser import Recogniser

RECORDINGS = PACKAGED / "recordings"
# Enough words that the limited decoder has to choose, as with a real grammar.
PHRASES = (
    "go to the pharmacy and say good morning",
    "wait for a visitor then take them to radiology",
    "bring the red cup from the supply room to alice",
    "turn left and move two metres",
)


def measure(repeats: int = 5) -> dict[str, float]:
    """Seconds and ratios by name, medians over `repeats`; raises ModelError without the model."""
    started = time.perf_counter()
    recogniser = Recogniser(need("en"), "en")
    loading = time.perf_counter() - started
    recordings = [audio.read(path) for path in sorted(RECORDINGS.glob("*.wav"))]
    seconds = sum(recording.seconds for recording in recordings) / len(recordings)
    limited = _median(recogniser, recordings, PHRASES, repeats)
    free = _median(recogniser, recordings, None, repeats)
    return {
        "load model (s)": loading,
        "recording to text, with second opinion (s)": limited,
        "real-time factor, with second opinion": limited / seconds,
        "real-time factor, free": free / seconds,
    }


def _median(
    recogniser: Recogniser,
    recordings: list[audio.Audio],
    phrases: tuple[str, ...] | None,
    repeats: int,
) -> float:
    return statistics.median(
        recogniser.recognise(recording, phrases).seconds_taken
        for _ in range(repeats)
        for recording in recordings
    )
