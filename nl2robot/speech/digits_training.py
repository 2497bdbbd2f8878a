"""Trains the ear for digits (`digits`) on synthesised speech.

    python -m nl2robot.speech.digits_training en     # writes nl2robot/data/digits-en.npz

No recording of anybody is used. Every digit is spoken by many speakers of
espeak-ng and by the neural voices, faster and slower, higher and lower; then treated as short
answers are on their way to the recogniser: the band of a telephone, edges cut off where they are
faint, a little noise, another place in the window.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech import digits, scenes
from nl2robot.speech.audio import RATE, from_float
from nl2robot.speech.embeddings import embed_windows
from nl2robot.speech.scenes import Signal
from nl2robot.speech.vocabulary import number_words
from nl2robot.speech.voices import Sound, espeak, joined, voices

HIDDEN: Final = 96
NETWORKS: Final = 4
ROUNDS: Final = 3  # each spoken word is treated so often
NEURAL_MARKS: Final = ("", ".", "?", "!") * 3
"""Said so often by a neural voice, which never says a word twice alike."""
_DIALECTS: Final = {
    "en": ("en-us", "en-029", "en-gb-scotland", "en-gb-x-rp"),
    "fr": ("fr", "fr-be", "fr-ch"),
    "de": ("de",),
}
_VARIANTS: Final = (
    *("", "m1", "m2", "m3", "m4", "m5", "m6", "m7", "m8", "f1", "f2", "f3", "f4", "f5"),
    *("Alex", "Andy", "Annie", "Mario", "Michael", "belinda", "edward", "linda", "steph"),
)
_PACE: Final = (0.7, 0.8, 0.9, 1.0, 1.1, 1.2, 1.3)


def train(language: str, seed: int = 0) -> digits.Network:
    """Raises VoiceError where nothing can be spoken."""
    rng = np.random.default_rng(seed)
    clips = list(_clips(language, rng)) * ROUNDS
    print(f"{len(clips)} sounds", file=sys.stderr)
    values = embed_windows([_treated(clip, rng) for _, clip in clips]).astype(float)
    answers = np.array([answer for answer, _ in clips])
    return _together([_fitted(values, answers, rng) for _ in range(NETWORKS)])


def _clips(language: str, rng: np.random.Generator) -> Iterator[tuple[int, Signal]]:
    """Which digit, and how it sounds."""
    neural = [voice for voice in voices(language) if voice.name.startswith("piper")]
    for n, digit in enumerate(digits.DIGITS):
        word = number_words(digit, language)
        for dialect in _DIALECTS[language]:
            for variant in _VARIANTS:
                speed, pitch = rng.uniform(0.75, 1.3), rng.uniform(0.7, 1.4)
                speaker = espeak(dialect, variant)
                yield n, _signal(joined(speaker.speak(word, speed=speed, pitch=pitch)))
        for voice in neural:
            for pace in _PACE:
                for mark in NEURAL_MARKS:
                    yield n, _signal(joined(voice.speak(word + mark, speed=pace)))


def _signal(sound: Sound) -> Signal:
    frames = (sound.samples.reshape(-1, 1) / 32768).astype(np.float32)
    return digits.cut(scenes.signal(from_float(frames, sound.rate)), 0.03)


def _treated(clip: Signal, rng: np.random.Generator) -> Signal:
    import soxr

    sound = soxr.resample(clip, RATE, RATE * rng.uniform(0.85, 1.2))  # another throat
    if rng.random() < 0.6:  # a telephone
        sound = soxr.resample(soxr.resample(sound, RATE, 8000), 8000, RATE)
    if rng.random() < 0.7:  # cut where it is faint
        sound = digits.cut(sound, float(10 ** rng.uniform(-1.7, -0.6)))
    window = digits.placed(np.asarray(sound, np.float32), float(rng.uniform(0.3, 0.7)))
    noise = rng.normal(0, 10 ** rng.uniform(-4.5, -2) * digits.LOUDNESS, len(window))
    return np.asarray(window + noise, np.float32)


def _together(networks: Sequence[digits.Network]) -> digits.Network:
    """Their mean opinion, as one network."""
    first = networks[0]
    return digits.Network(
        first.mean,
        first.scale,
        np.concatenate([network.hidden for network in networks], axis=1),
        np.concatenate([network.hidden_bias for network in networks]),
        np.concatenate([network.out for network in networks]) / len(networks),
        np.mean([network.out_bias for network in networks], axis=0),
    )


def _fitted(
    values: NDArray[np.float64], answers: NDArray[np.int64], rng: np.random.Generator
) -> digits.Network:
    """By Adam (Kingma and Ba 2015), with dropout of the hidden layer."""
    mean, scale = values.mean(axis=0), values.std(axis=0) + 1e-6
    inputs = (values - mean) / scale
    kinds, size = len(digits.DIGITS), inputs.shape[1]
    layers = [
        rng.normal(0, (2 / size) ** 0.5, (size, HIDDEN)),
        np.zeros(HIDDEN),
        rng.normal(0, (2 / HIDDEN) ** 0.5, (HIDDEN, kinds)),
        np.zeros(kinds),
    ]
    first, second = ([np.zeros_like(layer) for layer in layers] for _ in range(2))
    step = 0
    for _ in range(30):
        for batch in np.array_split(rng.permutation(len(inputs)), len(inputs) // 128):
            keep = (rng.random((len(batch), HIDDEN)) > 0.3) / 0.7
            hidden = np.maximum(0, inputs[batch] @ layers[0] + layers[1]) * keep
            scores = hidden @ layers[2] + layers[3]
            error = np.exp(scores - scores.max(axis=1, keepdims=True))
            error /= error.sum(axis=1, keepdims=True)
            error[np.arange(len(batch)), answers[batch]] -= 1
            error /= len(batch)
            back = (error @ layers[2].T) * (hidden > 0) * keep
            slopes = [inputs[batch].T @ back, back.sum(0), hidden.T @ error, error.sum(0)]
            step += 1
            for n, slope in enumerate(slopes):
                slope = slope + 1e-4 * layers[n]
                first[n] = 0.9 * first[n] + 0.1 * slope
                second[n] = 0.999 * second[n] + 0.001 * slope**2
                size_now = np.sqrt(second[n] / (1 - 0.999**step)) + 1e-8
                layers[n] = layers[n] - 0.002 * first[n] / (1 - 0.9**step) / size_now
    return digits.Network(mean, scale, *layers)


def main() -> None:
    for language in sys.argv[1:]:
        network = train(language)
        values = {name: np.asarray(value, np.float16) for name, value in vars(network).items()}
        with digits.weights(language).open("wb") as file:
            np.savez_compressed(file, **values)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
