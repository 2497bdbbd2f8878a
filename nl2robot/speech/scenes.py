"""The places where a robot has to hear: babble, a corridor, a room that echoes. All are made here,
from synthesised speech and noise, so that a benchmark needs no recordings of anybody.

    heard = at_snr(echoing(speech, room), babble, decibels=5)

All sounds are floating point, one channel at `RATE`, full scale 1.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech.audio import RATE, Audio

Signal = NDArray[np.float32]

SPEECH_FLOOR: Final = 0.05
"""Of the loudest 20 ms: what is quieter is a pause, and does not count for the level of speech."""
CORRIDOR_HUM: Final = (50.0, 100.0, 150.0)  # Hz: ventilation, on European mains


def signal(audio: Audio) -> Signal:
    return np.asarray(audio.samples / np.float32(32768), np.float32)


def audio(sound: Signal) -> Audio:
    """For the recogniser; clipped, as a microphone would."""
    return Audio((np.clip(sound, -1, 1) * 32767).astype(np.int16))


def level(sound: Signal) -> float:
    """Root mean square of what is not a pause."""
    frame = RATE // 50
    if len(sound) < frame:
        return float(np.sqrt(np.mean(np.square(sound)))) if len(sound) else 0.0
    frames = np.sqrt(np.mean(np.square(sound[: len(sound) // frame * frame]).reshape(-1, frame), 1))
    return float(np.sqrt(np.mean(np.square(frames[frames >= SPEECH_FLOOR * frames.max()]))))


def at_snr(speech: Signal, noise: Signal, decibels: float, rng: np.random.Generator) -> Signal:
    """Speech in a piece of noise, the speech by so many decibels louder while it is spoken. Brought
    down where it would clip."""
    start = int(rng.integers(0, max(1, len(noise) - len(speech))))
    piece = np.resize(noise[start:], len(speech))
    wanted = level(speech) / 10 ** (decibels / 20)
    mixed = speech + piece * (wanted / max(level(piece), 1e-9))
    return np.asarray(mixed * min(1.0, 0.95 / max(float(np.abs(mixed).max()), 1e-9)), np.float32)


def babble(voices: Sequence[Signal], seconds: float, rng: np.random.Generator) -> Signal:
    """Several people who speak at once, each on and on, of different loudness."""
    length = int(seconds * RATE)
    mixed = np.zeros(length, np.float32)
    for _ in range(min(8, max(3, len(voices)))):
        at = -int(rng.integers(0, RATE * 3))
        loudness = float(rng.uniform(0.4, 1.0))
        while at < length:
            said = voices[int(rng.integers(len(voices)))]
            first, last = max(0, at), min(length, at + len(said))
            if last > first:
                part = said[first - at : last - at]
                mixed[first:last] += part * (loudness / max(level(said), 1e-9))
            at += len(said) + int(rng.integers(0, RATE // 2))
    return _peak(mixed)


def corridor(seconds: float, rng: np.random.Generator) -> Signal:
    """Ventilation, steps, a trolley, a door, the beeps of a monitor."""
    length = int(seconds * RATE)
    times = np.arange(length) / RATE
    mixed = _coloured(length, rng, slope=-1.0) * 0.25
    for hum in CORRIDOR_HUM:
        mixed += 0.04 * np.sin(2 * np.pi * hum * times + rng.uniform(0, 6)).astype(np.float32)
    for start in np.arange(rng.uniform(0, 2), seconds, 0.55):  # steps, that come and go
        if np.sin(start / 5) > 0:
            _add(mixed, _burst(0.06, 900, rng) * 0.5 * float(np.sin(start / 5)), start)
    for start in _sometimes(seconds, 11, rng):
        _add(mixed, _burst(0.35, 300, rng), start)  # a door
    for start in _sometimes(seconds, 17, rng):
        trolley = _coloured(int(3 * RATE), rng, slope=-0.5) * np.hanning(3 * RATE)
        _add(mixed, 0.6 * trolley.astype(np.float32), start)
    for start in _sometimes(seconds, 7, rng):
        beep = np.sin(2 * np.pi * 960 * np.arange(int(0.15 * RATE)) / RATE)
        _add(mixed, 0.25 * beep.astype(np.float32), start)
    return _peak(mixed)


def music(seconds: float, rng: np.random.Generator) -> Signal:
    """A tune with chords and a beat, as from a radio: voiced, rhythmical, and nobody speaks."""
    length = int(seconds * RATE)
    mixed = np.zeros(length, np.float32)
    beat = float(rng.uniform(0.35, 0.6))
    key = 220 * 2 ** (float(rng.integers(0, 12)) / 12)
    for n, start in enumerate(np.arange(0, seconds, beat)):
        for semitones in (0, 4, 7) if n % 4 == 0 else (12 + int(rng.choice([0, 2, 4, 5, 7, 9])),):
            times = np.arange(int(beat * (4 if n % 4 == 0 else 1) * RATE)) / RATE
            pitch = key * 2 ** (semitones / 12)
            tone = sum(np.sin(2 * np.pi * pitch * h * times) / h**1.5 for h in range(1, 7))
            _add(mixed, np.asarray(0.3 * tone * np.exp(-3 * times), np.float32), float(start))
        _add(mixed, _burst(0.08, 2000 if n % 2 else 200, rng) * 0.5, float(start))
    return _peak(mixed)


def echo(rng: np.random.Generator, seconds: float = 0.5, direct: float = 6.0) -> Signal:
    """The impulse response of a room, `seconds` its reverberation time (to -60 dB): the direct
    sound, some early reflections, and exponentially decaying noise (Moorer 1979), of which the
    high tones die away in half the time, as walls and air swallow them. The direct sound is by
    `direct` decibels stronger than all that follows: about 6 where somebody stands a metre away."""
    length = int(seconds * RATE)
    decay = -6.9 * np.arange(length) / length
    low = _coloured(length, rng, slope=-1.0) * np.exp(decay)
    high = rng.standard_normal(length) * np.exp(2 * decay)
    response = np.asarray(0.05 * (low + high), np.float32)
    for _ in range(6):
        response[int(rng.uniform(0.003, 0.04) * RATE)] += float(rng.uniform(-0.4, 0.4))
    response[0] = 0.0
    response *= np.float32(10 ** (-direct / 20) / np.sqrt(np.sum(np.square(response))))
    response[0] = 1.0
    return response


def echoing(sound: Signal, response: Signal) -> Signal:
    from scipy.signal import fftconvolve

    return _peak(np.asarray(fftconvolve(sound, response), np.float32), at_most=True)


def _coloured(length: int, rng: np.random.Generator, slope: float) -> Signal:
    """Noise whose power falls with the frequency to this power, of level 1."""
    spectrum = np.fft.rfft(rng.standard_normal(length))
    frequencies = np.maximum(np.fft.rfftfreq(length, 1 / RATE), 30)
    noise = np.fft.irfft(spectrum * frequencies ** (slope / 2), length)
    return np.asarray(noise / max(float(np.std(noise)), 1e-9), np.float32)


def _burst(seconds: float, frequency: float, rng: np.random.Generator) -> Signal:
    """A knock: noise that dies away, mostly below a frequency."""
    length = int(seconds * RATE)
    noise = rng.standard_normal(length)
    window = max(1, int(RATE / frequency / 2))
    smooth = np.convolve(noise, np.ones(window) / window, "same")
    decay = np.exp(-5 * np.arange(length) / length)
    return _peak(np.asarray(smooth * decay, np.float32))


def _sometimes(seconds: float, every: float, rng: np.random.Generator) -> list[float]:
    times, at = [], float(rng.exponential(every))
    while at < seconds:
        times.append(at)
        at += float(rng.exponential(every))
    return times


def _add(mixed: Signal, sound: Signal, start: float) -> None:
    first = int(start * RATE)
    last = min(len(mixed), first + len(sound))
    if last > first:
        mixed[first:last] += sound[: last - first]


def _peak(sound: Signal, at_most: bool = False) -> Signal:
    """With a peak of 0.9; `at_most`: only where it would be more."""
    peak = float(np.abs(sound).max()) if len(sound) else 0.0
    if peak < 1e-9 or (at_most and peak <= 0.95):
        return sound
    return np.asarray(sound * (0.9 / peak), np.float32)
