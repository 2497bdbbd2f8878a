"""How fast everything is on this machine. Figures are printed beside the aim, never asserted."""

from __future__ import annotations

import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path

import robot_api.benchmark
import sandbox.benchmark
import sim.benchmark
from grammar.sampler import random_sentence
from grammar.samples import samples
from nl2robot.bench import hotword, recognition
from nl2robot.bench.figures import Figure, megabytes, percentile
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.models.catalogue import find
from nl2robot.translate.translation import translate
from robot_api.client import Robot
from robot_api.errors import Stopped
from sim.world.loading import load_world


def measure(part: str) -> Iterator[Figure]:
    """The figures of one of `PARTS`, as they come."""
    return PARTS[part]()


# --- understanding -------------------------------------------------------------------------------


def _translate() -> Iterator[Figure]:
    knowledge = Knowledge(load_world(DEFAULT_WORLD))
    lexicon = knowledge.lexicon("en")
    sentences = [sentence for topic in samples(lexicon).values() for sentence in topic]
    sentences += [random_sentence(lexicon, seed=seed) for seed in range(300)]
    for sentence in sentences[:20]:  # reads the grammar
        translate(sentence, knowledge)
    times = [translate(sentence, knowledge).ms for sentence in sentences]
    what = f"{len(sentences)} sentences"
    yield Figure("translate", f"median of {what}", statistics.median(times), "ms", "5")
    yield Figure("translate", f"p99 of {what}", percentile(times, 99), "ms", "50")
    long_sentence = _of_words(60, sentences)
    times = [translate(long_sentence, knowledge).ms for _ in range(9)]
    yield Figure("translate", "a command of 60 words", statistics.median(times), "ms", "50")
    yield Figure(
        "translate", "a text of 500 words", translate("the " * 500, knowledge).ms, "ms", ""
    )
    times = [_cold_start() for _ in range(9)]
    yield Figure("translate", "cold start of the command", statistics.median(times), "s", "0.5")


def _of_words(count: int, sentences: Sequence[str]) -> str:
    words: list[str] = []
    for sentence in sentences:
        clause = [*(["then"] if words else []), *sentence.rstrip(".!?").split()]
        if len(words) + len(clause) <= count:
            words += clause
    return " ".join(words)


def _cold_start() -> float:
    began = time.perf_counter()
    command = [sys.executable, "-m", "nl2robot.cli.main", "translate", "go to the pharmacy"]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


# --- the parts -----------------------------------------------------------------------------------


def _wire() -> Iterator[Figure]:
    figures = robot_api.benchmark.measure()
    yield Figure("wire", "calls, one after the other", figures["calls_per_second"], "/s", "3,000")
    yield Figure("wire", "calls, eight threads", figures["calls_per_second_pipelined"], "/s")
    yield Figure("wire", "round trip, median", figures["round_trip_ms"], "ms")
    yield Figure("wire", "round trip, p99", figures["round_trip_p99_ms"], "ms")
    yield Figure("wire", "stop with 63 calls in flight, median", figures["stop_ms"], "ms", "50")
    yield Figure("wire", "the same, p99", figures["stop_p99_ms"], "ms", "50")


def _simulator() -> Iterator[Figure]:
    figures = sim.benchmark.measure()
    what = f"{figures['people']:.0f} people, {figures['rays']:.0f}-ray lidar, 60 Hz"
    yield Figure("simulator", what, figures["times_real_time"], "x real time", "100")
    yield Figure("simulator", "copy for a dry run", figures["copy_seconds"] * 1000, "ms")


def _sandbox() -> Iterator[Figure]:
    figures = sandbox.benchmark.measure()
    yield Figure("sandbox", "overhead of a robot call", figures["call_us"], "µs")
    yield Figure("sandbox", "check of a program", figures["check_ms"], "ms")
    yield Figure("sandbox", "start and end of a run", figures["start_and_end_ms"], "ms")
    yield Figure(
        "sandbox", "stop while computing, worst", figures["stop_computing_worst_ms"], "ms", "50"
    )
    yield Figure("sandbox", "stop in a call, worst", figures["stop_in_a_call_worst_ms"], "ms", "50")


def _voice() -> Iterator[Figure]:
    if find("en") is None:
        return
    for what, value in recognition.measure().items():
        yield Figure("voice", what, value, "")


def _hotword() -> Iterator[Figure]:
    for what, value, unit, aim in hotword.measure():
        yield Figure("hotword", what, value, unit, aim)


# --- the whole -----------------------------------------------------------------------------------


def _serve() -> Iterator[Figure]:
    """A server of its own process: its memory, and stop from the request to zero speed."""
    with served() as (process, address):
        delays = [_stop_delay(address) for _ in range(10)]
        yield Figure("serve", "stop to zero speed, median", statistics.median(delays), "ms", "50")
        yield Figure("serve", "stop to zero speed, worst of 10", max(delays), "ms", "50")
        yield Figure("serve", "memory after that", megabytes(process), "MB")


@contextlib.contextmanager
def served(*options: str) -> Iterator[tuple[int, str]]:
    """`nl2robot serve` with these options in a process of its own: its number, and its "host:port".
    Raises `ChildProcessError` if it does not come up, with what it says."""
    command = [sys.executable, "-m", "nl2robot.cli.main", "serve", "--port", "0", *options]
    with tempfile.TemporaryDirectory() as home, tempfile.TemporaryFile("w+") as complaints:
        server = subprocess.Popen(
            command,
            stdout=subprocess.PIPE,
            stderr=complaints,
            text=True,
            env=_environment(Path(home)),
        )
        try:
            assert server.stdout is not None
            line = server.stdout.readline()
            if "ws://" not in line:
                server.wait()
                complaints.seek(0)
                raise ChildProcessError(line + complaints.read())
            yield server.pid, line.split("ws://")[1].split()[0]
        finally:
            server.terminate()
            server.wait()


def _stop_delay(address: str) -> float:
    """Milliseconds from a stop's request to the news that the robot stands; it is driving then."""
    driving, standing = threading.Event(), threading.Event()

    def on_pose(kind: str, data: Mapping[str, object]) -> None:
        speed = float(str(data["speed"]))
        if speed > 0.1:
            driving.set()
        elif speed == 0:
            standing.set()

    def drive() -> None:
        with contextlib.suppress(Stopped):
            robot.drive(0.5, 0, 30)

    with Robot(address) as robot:
        robot.subscribe("pose", on_pose)
        driver = threading.Thread(target=drive)
        driver.start()
        driving.wait(10)
        standing.clear()
        began = time.perf_counter()
        robot.stop()
        standing.wait(10)
        delay = time.perf_counter() - began
        driver.join(10)
        robot.localize("lobby")
    return delay * 1000


def _environment(home: Path) -> dict[str, str]:
    return {**os.environ, "NL2ROBOT_HOME": str(home)}


PARTS: dict[str, Callable[[], Iterator[Figure]]] = {
    "translate": _translate,
    "wire": _wire,
    "simulator": _simulator,
    "sandbox": _sandbox,
    "serve": _serve,
    "voice": _voice,
    "hotword": _hotword,
}
