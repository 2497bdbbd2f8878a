"""Trains the ear for digits (`digits`) on synthesised speech.

    nl2robot models get kokoro
    python -m nl2robot.training.digits.training en     # writes nl2robot/data/digits-en.npz

No recording of anybody is used. Every digit is spoken by many people of Kokoro and of espeak-ng,
with accents, faster and slower (`speakers`); then treated as short answers are on their way
to the recogniser: other throats and microphones, edges cut off where they are faint, rooms, noise,
a telephone. Some of what is no digit is spoken as well. It takes an hour on two cores.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech import scenes
from nl2robot.speech.audio import RATE, Audio
from nl2robot.speech.digits import classifier as digits
from nl2robot.speech.digits.encoder import encoder
from nl2robot.speech.embeddings import embed_windows
from nl2robot.speech.scenes import Signal
from nl2robot.training.digits.speakers import NONE, Spoken, neural, robotic

HIDDEN: Final = {digits.BY_EMBEDDING: 256, digits.BY_ENCODER: 96}
EPOCHS: Final = {digits.BY_EMBEDDING: 25, digits.BY_ENCODER: 12}
NETWORKS: Final = 2  # of each kind, together
TIMES: Final = {"en": 2}  # each neural speaker says each digit so often, or else once ...
ROUNDS: Final = 4  # ... and each of these is treated so often
_NOISES: Final = 600  # pieces of noise in which nobody speaks
_SMOOTHING: Final = 0.05  # of the answers: none is quite sure
_SECONDS: Final = 40.0  # of each noise

Values = NDArray[np.float32]


def train(language: str, seed: int = 0) -> dict[str, digits.Network]:
    """By their kind. Raises VoiceError where nothing can be spoken."""
    rng = np.random.default_rng(seed)
    spoken = list(neural(language, TIMES.get(language, 1))) * ROUNDS + list(robotic(language, rng))
    noises = _noises(spoken, rng)
    spoken += [Spoken(NONE, _piece(noises, rng)) for _ in range(_NOISES)]
    ear = encoder(language)
    windows, encoded, answers = [], [], []
    for n, each in enumerate(spoken):
        sound = digits.word_in(heard(each.sound, noises, rng).samples.astype(np.float32))
        if len(sound) > digits.LONGEST * RATE:
            continue
        windows.append(digits.placed(sound, float(rng.uniform(0.3, 0.7))))
        if ear is not None:
            encoded.append(ear.values(sound))
        answers.append(each.digit)
        if n % 500 == 0:
            print(f"{n} of {len(spoken)} sounds", file=sys.stderr)
    values: dict[str, Values] = {digits.BY_EMBEDDING: embed_windows(windows)}
    if encoded:
        values[digits.BY_ENCODER] = np.array(encoded, np.float32)
    return {
        kind: _together([_fitted(each, np.array(answers), kind, rng) for _ in range(NETWORKS)])
        for kind, each in values.items()
    }


def heard(word: Signal, noises: Sequence[Signal], rng: np.random.Generator) -> Audio:
    """As it may come to the robot: more often a short piece from a telephone than a word in a
    noisy room."""
    import soxr

    def chance(room: float, telephone: float) -> bool:
        return bool(rng.random() < (room if in_room else telephone))

    in_room = bool(rng.random() < 0.4)
    sound: Signal = np.asarray(
        soxr.resample(word, RATE, RATE * rng.uniform(0.87, 1.17)), np.float32
    )
    if rng.random() < 0.5:  # a microphone that likes high or low tones
        tilt = np.float32(rng.uniform(-0.6, 0.6))
        sound = sound - tilt * np.pad(sound, (1, 0))[:-1]
    if chance(0.3, 0.7):  # the faint edges lost, and now and then more
        sound = digits.cut(sound, float(10 ** rng.uniform(-1.7, -0.5)))
        if rng.random() < 0.15:
            sound = sound[: int(len(sound) * rng.uniform(0.75, 0.95))]
    if chance(1.0, 0.2):
        sound = np.pad(sound, int(rng.uniform(0.15, 0.4) * RATE)).astype(np.float32)
        if rng.random() < 0.7:
            room = scenes.echo(rng, float(rng.uniform(0.2, 0.7)), float(rng.uniform(3, 12)))
            sound = scenes.echoing(sound, room)[: len(sound) + RATE // 4]
    if in_room:
        noise = noises[int(rng.integers(len(noises)))]
        sound = scenes.at_snr(sound, noise, float(rng.uniform(4, 28)), rng)
    sound = sound * np.float32(0.5 / max(1e-6, float(np.abs(sound).max())))
    hiss = rng.normal(0, 0.5 * 10 ** rng.uniform(-4.5, -2.2), len(sound))
    sound = sound + hiss.astype(np.float32)
    if chance(0.4, 0.8):
        sound = soxr.resample(soxr.resample(sound, RATE, 8000), 8000, RATE)
    if rng.random() < 0.1:
        sound = np.clip(sound, -0.2, 0.2)
    loudness = 10 ** rng.uniform(-1.3, 0.25) / max(1e-6, float(np.abs(sound).max()))
    return scenes.audio(np.asarray(sound * loudness, np.float32))


def _noises(spoken: Sequence[Spoken], rng: np.random.Generator) -> list[Signal]:
    chosen = [spoken[int(n)].sound for n in rng.integers(len(spoken), size=40)]
    talk = [np.concatenate(chosen[n : n + 5]) for n in range(0, 40, 5)]
    hiss = np.asarray(rng.normal(0, 0.2, int(_SECONDS * RATE)), np.float32)
    return [
        scenes.babble(talk, _SECONDS, rng),
        scenes.corridor(_SECONDS, rng),
        scenes.corridor(_SECONDS, rng),
        hiss,
        scenes.music(_SECONDS, rng),
    ]


def _piece(noises: Sequence[Signal], rng: np.random.Generator) -> Signal:
    """Of a noise; half of them come and go."""
    noise = noises[int(rng.integers(len(noises)))]
    length = int(rng.uniform(0.15, 0.7) * RATE)
    first = int(rng.integers(len(noise) - length))
    piece = noise[first : first + length]
    return piece * np.hanning(length).astype(np.float32) if rng.random() < 0.5 else piece


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
    values: Values, answers: NDArray[np.int64], kind: str, rng: np.random.Generator
) -> digits.Network:
    """By Adam (Kingma and Ba 2015), with half of the hidden layer dropped out."""
    mean, scale = values.mean(axis=0), values.std(axis=0) + 1e-4
    inputs = (values - mean) / scale
    kinds, size, hidden_size = NONE + 1, inputs.shape[1], HIDDEN[kind]
    wanted = np.full((len(answers), kinds), _SMOOTHING / kinds, np.float32)
    wanted[np.arange(len(answers)), answers] += 1 - _SMOOTHING
    layers = [
        rng.normal(0, (2 / size) ** 0.5, (size, hidden_size)).astype(np.float32),
        np.zeros(hidden_size, np.float32),
        rng.normal(0, (2 / hidden_size) ** 0.5, (hidden_size, kinds)).astype(np.float32),
        np.zeros(kinds, np.float32),
    ]
    first, second = ([np.zeros_like(layer) for layer in layers] for _ in range(2))
    for step, (batch, rate) in enumerate(_batches(len(inputs), EPOCHS[kind], rng), 1):
        hidden = np.maximum(0, inputs[batch] @ layers[0] + layers[1])
        keep = 2 * (rng.random(hidden.shape) < 0.5).astype(np.float32)
        hidden *= keep
        scores = hidden @ layers[2] + layers[3]
        error = np.exp(scores - scores.max(axis=1, keepdims=True))
        error = (error / error.sum(axis=1, keepdims=True) - wanted[batch]) / len(batch)
        back = (error @ layers[2].T) * (hidden > 0) * keep
        slopes = [inputs[batch].T @ back, back.sum(0), hidden.T @ error, error.sum(0)]
        for n, slope in enumerate(slopes):
            slope = slope + 1e-4 * layers[n]
            first[n] = 0.9 * first[n] + 0.1 * slope
            second[n] = 0.999 * second[n] + 0.001 * slope**2
            size_now = np.sqrt(second[n] / (1 - 0.999**step)) + 1e-8
            layers[n] -= (rate * first[n] / (1 - 0.9**step) / size_now).astype(np.float32)
    return digits.Network(*(np.asarray(each, float) for each in (mean, scale, *layers)))


def _batches(
    count: int, epochs: int, rng: np.random.Generator, size: int = 128
) -> Iterator[tuple[NDArray[np.int64], float]]:
    """Which to learn from, and how fast: slower towards the end."""
    steps = epochs * (count // size)
    for step in range(steps):
        if step % (count // size) == 0:
            order = rng.permutation(count)
        at = step % (count // size) * size
        yield order[at : at + size], 0.001 * (1 + float(np.cos(np.pi * step / steps)))


def _written(networks: Mapping[str, digits.Network]) -> dict[str, NDArray[np.float16]]:
    return {
        f"{kind}_{name}": np.asarray(value, np.float16)
        for kind, network in networks.items()
        for name, value in vars(network).items()
    }


def main() -> None:
    for language in sys.argv[1:]:
        written = _written(train(language))
        with digits.weights(language).open("wb") as file:
            np.savez_compressed(file, **written)  # type: ignore[arg-type]


if __name__ == "__main__":
    main()
