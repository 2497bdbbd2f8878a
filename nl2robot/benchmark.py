"""How fast everything is on this machine. Figures are printed beside the aim, never asserted."""

from __future__ import annotations

import statistics
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence

import msgspec


class Figure(msgspec.Struct, frozen=True):
    """One thing measured."""

    part: str
    what: str
    value: float
    unit: str
    aim: str = ""

    @property
    def shown(self) -> str:
        return (
            f"{self.value:,.4g} {self.unit}"
            if self.value < 1000
            else f"{self.value:,.0f} {self.unit}"
        )


def measure(part: str) -> Iterator[Figure]:
    """The figures of one of `PARTS`."""
    return PARTS[part]()


def _translate() -> Iterator[Figure]:
    from grammar.samples import samples

    from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
    from nl2robot.translation import translate
    from sim.world import load_world

    knowledge = Knowledge(load_world(DEFAULT_WORLD))
    sentences = [s for topic in samples(knowledge.lexicon("en"), "en").values() for s in topic]
    long_sentence = ", then ".join(sentences[:12])
    translate(sentences[0], knowledge)  # reads the grammar
    times = [
        translate(sentence, knowledge).ms
        for _ in range(5)
        for sentence in (*sentences, long_sentence)
    ]
    yield Figure(
        "translate", f"median of {len(times)} sentences", statistics.median(times), "ms", "5 ms"
    )
    yield Figure("translate", "p99", _percentile(times, 99), "ms", "50 ms")
    words = len(long_sentence.split())
    times = [translate(long_sentence, knowledge).ms for _ in range(5)]
    yield Figure(
        "translate", f"a sentence of {words} words", statistics.median(times), "ms", "50 ms"
    )
    times = [_cold_start() for _ in range(7)]
    yield Figure("translate", "cold start of the command", statistics.median(times), "s", "0.5 s")


def _cold_start() -> float:
    began = time.perf_counter()
    command = [sys.executable, "-m", "nl2robot.cli", "translate", "go to the pharmacy"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def _wire() -> Iterator[Figure]:
    from robot_api.benchmark import measure

    figures = measure()
    yield from _named("wire", figures, {})


def _simulator() -> Iterator[Figure]:
    from sim.benchmark import measure

    yield from _named("simulator", measure(), {})


def _sandbox() -> Iterator[Figure]:
    from sandbox.benchmark import measure

    yield from _named("sandbox", measure(), {})


def _voice() -> Iterator[Figure]:
    from nl2robot.speech.benchmark import measure

    yield from _named("voice", measure(), {})


def _named(part: str, figures: dict[str, float], aims: dict[str, str]) -> Iterator[Figure]:
    for what, value in figures.items():
        yield Figure(part, what, value, "", aims.get(what, ""))


def _percentile(values: Sequence[float], percent: int) -> float:
    return statistics.quantiles(values, n=100)[percent - 1]


PARTS: dict[str, Callable[[], Iterator[Figure]]] = {
    "translate": _translate,
    "wire": _wire,
    "simulator": _simulator,
    "sandbox": _sandbox,
    "voice": _voice,
}
