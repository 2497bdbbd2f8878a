"""A million inputs that are nearly right, to whoever reads something in this process.

    python -m tests.attacks.fuzz [--seed S] [--inputs N] [NAME ...]
    python -m tests.attacks.fuzz --seed S --only NUMBER NAME      # one of them, with its traceback

Each input is made from the seed and its number alone. Each reader has a process of its own, whose
memory is bounded and which is ended if it does not come back; the smallest input that can be got at
is told of each kind of failure.
"""

from __future__ import annotations

import argparse
import gc
import json
import logging
import mmap
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

from tests.attacks.inputs import Case, Target
from tests.attacks.outcome import Row, report, say
from tests.attacks.served import ROOT, memory, memory_now
from tests.attacks.smaller import smaller

SECONDS: Final = 5.0
"""Of computing that an input may take."""
HANGS: Final = 60.0
"""Seconds after which a process is ended that waits, or does not hear its own alarm."""
GROWTH: Final = 300.0
"""Megabytes that a reader may use beside what it had after its first inputs."""
KEPT: Final = 100.0
"""Megabytes that it may keep of that."""
ADDRESSES: Final = 6 * 1024**3
"""Bytes that its process can have at all: what wants more is a failure, and harms nobody."""
FIRST: Final = 300
"""Inputs after which all is loaded that has to be."""
SHRINKING: Final = 15.0
"""Seconds in which a smaller input is looked for."""
_PROJECT: Final = ("grammar", "nl2robot", "robot_api", "sandbox", "sim")


class TooSlow(BaseException):
    """The time for an input is over; nothing that catches errors may catch this."""


class Complaint(Exception):
    """Something was logged with a traceback."""


@dataclass
class Failure:
    """A kind of failure."""

    number: int
    """Of the first input that did it."""
    why: str
    case: str
    times: int = 1


@dataclass
class Found:
    """What came of a row of inputs."""

    tried: int = 0
    survived: int = 0
    failures: dict[str, Failure] = field(default_factory=dict)
    slowest: float = 0.0
    """Seconds."""


def targets() -> dict[str, Target]:
    """All readers by their names."""
    from tests.attacks.input_files import FILES
    from tests.attacks.input_words import WORDED

    return {each.name: each for each in (*FILES, *WORDED)}


def case_of(target: Target, seed: int, number: int) -> Case:
    return target.make(random.Random(f"{target.name} {seed} {number}"))


def fuzzed(
    target: Target,
    seed: int,
    numbers: range,
    begins: Callable[[int], None] = lambda number: None,
    seconds: float = SECONDS,
    shrinking: float = SHRINKING,
) -> Found:
    """Feed it with these. `begins` is told the number of each before."""
    found = Found()
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)  # which people would read, and not know why
        for number in numbers:
            begins(number)
            case = case_of(target, seed, number)
            began = time.perf_counter()
            harm = _harm(target, case, seconds)
            found.slowest = max(found.slowest, time.perf_counter() - began)
            found.tried += 1
            if harm is None:
                found.survived += 1
                continue
            kind, why = harm
            known = found.failures.get(kind)
            if known is not None:
                known.times += 1
                continue
            least = _smallest(target, case, kind, seconds, shrinking)
            found.failures[kind] = Failure(number, why, str(least))
    return found


def _smallest(target: Target, case: Case, kind: str, seconds: float, shrinking: float) -> Case:
    def harms(other: Case) -> bool:
        harm = _harm(target, other, seconds)
        return harm is not None and harm[0] == kind

    return smaller(case, harms, shrinking)


def _harm(target: Target, case: Case, seconds: float) -> tuple[str, str] | None:
    """What kind of failure, and what it says; None if all is well."""
    try:
        with _alarm(seconds), complaints() as said:
            target.feed(case)
        if said:  # somebody was answered all the same, but not by what was written for that
            raise Complaint(said[0].getMessage()[:300]) from (said[0].exc_info or (None, None))[1]
    except TooSlow as slow:
        return "too slow", f"takes more than {seconds:.0f} s, at {_where(slow)}"
    except (Exception, RecursionError) as error:  # noqa: BLE001 - whatever there is
        where = _where(error)
        return f"{type(error).__name__} {where}", f"{type(error).__name__}: {error} at {where}"[
            :900
        ]
    return None


@contextmanager
def complaints() -> Iterator[list[logging.LogRecord]]:
    """What is logged with a traceback meanwhile."""
    found: list[logging.LogRecord] = []

    class Noted(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            if record.exc_info:
                found.append(record)

    handler = Noted()
    logging.getLogger().addHandler(handler)
    try:
        yield found
    finally:
        logging.getLogger().removeHandler(handler)


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    def over(number: int, frame: Any) -> None:
        raise TooSlow

    before = signal.signal(signal.SIGPROF, over)
    signal.setitimer(signal.ITIMER_PROF, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        signal.signal(signal.SIGPROF, before)


def _where(error: BaseException) -> str:
    """The last line of the project's own that it came through."""
    if isinstance(error, Complaint) and error.__cause__ is not None:
        error = error.__cause__
    for frame in reversed(traceback.extract_tb(error.__traceback__)):
        path = Path(frame.filename)
        if path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in _PROJECT:
            return f"{path.relative_to(ROOT)}:{frame.lineno}"
    return "no line of the project"


# --- in processes of their own -------------------------------------------------------------------


def in_processes(seed: int, inputs: int, names: list[str], side_by_side: int = 2) -> list[Row]:
    """Feed each of them with its share of so many inputs."""
    known = targets()
    whole = sum(known[name].share for name in names)

    def one(name: str) -> Row:
        return in_process(name, seed, max(1, round(inputs * known[name].share / whole)))

    with ThreadPoolExecutor(side_by_side) as pool:
        return list(pool.map(one, names))


def in_process(name: str, seed: int, inputs: int) -> Row:
    """Feed one of them, in a process; if it breaks down, in another one behind what broke it."""
    row, number, began = Row(name), 0, time.monotonic()
    while number < inputs:
        result, died_at, why = _worker(name, seed, number, inputs)
        if result is not None:
            row.tried += result["tried"]
            row.survived += result["survived"]
            row.failures += [_told(name, seed, Failure(**each)) for each in result["failures"]]
            row.used(result["worst"])
            if result["trouble"]:
                row.failures.append(f"{result['trouble']} (seed {seed}, {inputs} inputs)")
            break
        # What it found before is lost with it, so what was before is done again.
        case = str(case_of(targets()[name], seed, died_at))
        row.failures.append(_told(name, seed, Failure(died_at, why, case)))
        row.tried += died_at - number + 1
        row.survived += died_at - number
        number = died_at + 1
    say(f"{name}: {row.tried} inputs, {row.tried / (time.monotonic() - began):.0f} a second")
    return row


def _told(name: str, seed: int, failure: Failure) -> str:
    again = f"python -m tests.attacks.fuzz --seed {seed} --only {failure.number} '{name}'"
    return f"{failure.why}\n  {failure.times} times; first {again}\n  {failure.case}"


def _worker(name: str, seed: int, first: int, last: int) -> tuple[dict[str, Any] | None, int, str]:
    """What a process has found; or the number of the input that it died of, and how."""
    with tempfile.TemporaryDirectory() as folder:
        progress = Path(folder) / "progress"
        progress.write_bytes(first.to_bytes(8, "little"))
        command = [sys.executable, "-m", "tests.attacks.fuzz", "--worker", str(progress)]
        command += ["--seed", str(seed), "--from", str(first), "--inputs", str(last), name]
        with (Path(folder) / "errors").open("w+", encoding="utf-8", errors="replace") as errors:
            process = subprocess.Popen(
                command, cwd=ROOT, stdout=subprocess.PIPE, stderr=errors, text=True
            )
            why = _waited_for(process, progress)
            said = process.stdout.read() if process.stdout else ""
            errors.seek(0)
            told = errors.read()[-800:]
        number = int.from_bytes(progress.read_bytes(), "little")
        if process.returncode == 0 and said:
            result: dict[str, Any] = json.loads(said.splitlines()[-1])
            return result, number, ""
        return None, number, why or f"its process ends with {process.returncode}: {told}"


def _waited_for(process: subprocess.Popen[str], progress: Path) -> str:
    """Until it has ended, or does not come back; says so then."""
    before, since = b"", time.monotonic()
    while True:
        try:
            process.wait(1)
            return ""
        except subprocess.TimeoutExpired:
            now = progress.read_bytes()
        if now != before:
            before, since = now, time.monotonic()
        elif time.monotonic() - since > HANGS:
            process.kill()
            process.wait()
            return f"does not come back within {HANGS:.0f} s"


def _work(name: str, seed: int, first: int, last: int, progress: Path) -> None:
    resource.setrlimit(resource.RLIMIT_AS, (ADDRESSES, ADDRESSES))
    target, own = targets()[name], os.getpid()
    with progress.open("r+b") as file, mmap.mmap(file.fileno(), 8) as shared:

        def begins(number: int) -> None:
            shared[:] = number.to_bytes(8, "little")

        middle = min(first + FIRST, last)
        found = fuzzed(target, seed, range(first, middle), begins)
        gc.collect()
        loaded = memory_now(own)
        rest = fuzzed(target, seed, range(middle, last), begins)
        shared[:] = last.to_bytes(8, "little")
    gc.collect()
    worst, kept = memory(own), memory_now(own) - loaded
    failures = dict(rest.failures)
    for kind, failure in found.failures.items():
        if kind in failures:
            failure.times += failures[kind].times
        failures[kind] = failure
    trouble = ""
    if worst - loaded > GROWTH or kept > KEPT:
        trouble = f"memory grows from {loaded:.0f} MB to {worst:.0f} MB; {kept:.0f} MB are kept"
    result = {
        "tried": found.tried + rest.tried,
        "survived": found.survived + rest.survived,
        "failures": [asdict(each) for each in failures.values()],
        "worst": worst,
        "trouble": trouble,
    }
    print(json.dumps(result), flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--inputs", type=int, default=20_000)
    parser.add_argument("--only", type=int, help="the number of one input")
    parser.add_argument("--from", type=int, default=0, dest="first", help=argparse.SUPPRESS)
    parser.add_argument("--worker", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("names", nargs="*", help=f"of {', '.join(targets())}")
    given = parser.parse_args()
    names = given.names or list(targets())
    if given.worker is not None:
        _work(names[0], given.seed, given.first, given.inputs, given.worker)
        return 0
    if given.only is not None:
        case = case_of(targets()[names[0]], given.seed, given.only)
        print(case)
        targets()[names[0]].feed(case)
        return 0
    return report(in_processes(given.seed, given.inputs, names), f"Inputs, seed {given.seed}")


if __name__ == "__main__":
    sys.exit(main())
