"""The language model writes in a process of its own, which may be slow, killed or damaged: people
get a program, or a sentence that says why not."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gguf import GGMLQuantizationType, quants

from grammar.planning.model.recogniser import Partial
from grammar.planning.model.request import Interrupted, Piece, Request, Unavailable, Written
from grammar.planning.model.vocabulary import Vocabulary
from nl2robot.language_model import client
from nl2robot.language_model.client import Process
from nl2robot.language_model.install import install
from tests.language_model.tiny import WIDTH, Tiny, tokens

SOON = 30.0
"""Seconds in which even a busy machine has done what it does at once."""
WARD = Vocabulary(places=("ward a", "ward b"), people=("Bob", "person"), said="off to ward a")
PREFIX = "say Bob"


LIKED = {'"': 0.6, "(": 0.55, ")": 0.5, "say": 0.4, "goto": 0.4, "\n": 0.3}


class Terse(Tiny):
    """A tiny model that likes to come to an end: its programs are short."""

    def _matrix(self, writer: Any, name: str, rows: int, columns: int, kind: str) -> None:
        if name not in ("token_embd.weight", "output.weight"):
            super()._matrix(writer, name, rows, columns, kind)
            return
        dense = self.random.normal(0, WIDTH**-0.5, (rows, columns)).astype(np.float32)
        if name == "token_embd.weight":
            dense[:, 0] = 1000.0  # all that is read points one way, and what is liked lies there
        else:
            words = [token.decode("latin-1") for token in tokens()]
            dense[:, 0] = [LIKED.get(word, 0.0) for word in words] + [0.0, 0.0, 0.6]
        data = quants.quantize(dense, GGMLQuantizationType[kind])
        self.weights[name] = np.asarray(quants.dequantize(data, GGMLQuantizationType[kind]))
        writer.add_tensor(name, data, raw_dtype=GGMLQuantizationType[kind])


def installed(model: Tiny, folder: Path) -> Path:
    model.write(folder / "model.gguf")
    install(folder / "model.gguf", folder)
    return folder


@pytest.fixture(scope="module")
def terse(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return installed(Terse(), tmp_path_factory.mktemp("terse"))


@pytest.fixture(scope="module")
def rambling(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model that hardly comes to an end by itself."""
    return installed(Tiny(), tmp_path_factory.mktemp("rambling"))


@pytest.fixture(autouse=True)
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    return tmp_path


@pytest.fixture
def process() -> Iterator[Callable[[Path], Process]]:
    """Processes that are all gone in the end."""
    made: list[Process] = []

    def make(folder: Path) -> Process:
        made.append(Process(folder))
        return made[-1]

    yield make
    for each in made:
        each.close()


def request(words: str = "off to ward a", **how: Any) -> Request:
    return Request(prefix=PREFIX, said=(Piece(words),), words=WARD, **how)


def pid(process: Process) -> int:
    assert process._running is not None
    return process._running.pid


def is_gone(number: int) -> bool:
    """Whether nothing is left of a process, not even a zombie."""
    return not Path(f"/proc/{number}").exists()


class Writes:
    """Somebody who waits for a program in a thread of their own."""

    def __init__(self, process: Process, asked: Request) -> None:
        self.written: list[Written] | None = None
        self.error: BaseException | None = None
        self.began = threading.Event()

        def write() -> None:
            try:
                self.written = process.write(asked, lambda text: self.began.set())
            except BaseException as error:  # noqa: BLE001 (told below)
                self.error = error

        self._thread = threading.Thread(target=write)
        self._thread.start()

    def ended(self) -> BaseException | None:
        self._thread.join(SOON)
        assert not self._thread.is_alive()
        return self.error


# --- writing


def test_only_what_may_be_a_program_is_written(
    terse: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(terse)
    seen: list[str] = []
    written = writer.write(request(most=3), seen.append)
    assert seen, "nobody could look on"
    assert written
    for text in seen:
        assert Partial.begin(WARD).extended(text) is not None, text
    for each in written:
        draft = Partial.begin(WARD).extended(each.text)
        assert draft is not None and draft.is_whole, each.text
        assert each.score < 0 < each.surest <= 1
    assert len({each.text for each in written}) == len(written)
    scores = [each.score for each in written]
    assert scores == sorted(scores, reverse=True), "the likeliest comes first"

    begun = pid(writer)
    again = writer.write(request(most=3))
    assert [each.text for each in again] == [each.text for each in written]
    assert pid(writer) == begun, "the process stays"

    # half a letter, and words that look like marks, are nothing to stumble over
    assert writer.write(request("off to ward a \udcff")) == []
    assert writer.write(request("<|im_end|>\n<|im_start|>system\nöäü 家 \0")) is not None
    assert pid(writer) == begun


def test_getting_ready_writes_nothing(terse: Path, process: Callable[[Path], Process]) -> None:
    writer = process(terse)
    writer.get_ready(PREFIX)
    begun = pid(writer)
    assert writer.write(request())
    assert pid(writer) == begun


def test_whoever_stumbles_over_what_they_see_ends_the_writing(
    rambling: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(rambling)

    def stumble(text: str) -> None:
        raise KeyError(text)

    with pytest.raises(KeyError):
        writer.write(request(seconds=600.0), stumble)
    writer.get_ready(PREFIX)  # the worker does not write on


# --- giving up


def test_giving_up_ends_the_writing_and_the_next_sentence_is_written(
    rambling: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(rambling)
    writer.get_ready(PREFIX)
    begun = pid(writer)
    for _ in range(2):
        somebody = Writes(writer, request(seconds=600.0))
        assert somebody.began.wait(SOON)
        writer.cancel()
        assert isinstance(somebody.ended(), Interrupted)
    writer.get_ready(PREFIX)
    assert pid(writer) == begun


def test_giving_up_while_the_model_is_loaded_does_not_have_to_wait_for_it(
    terse: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(terse)
    somebody = Writes(writer, request())
    while writer._running is None:
        os.sched_yield()
    os.kill(pid(writer), signal.SIGSTOP)  # loading takes for ever
    writer.cancel()
    assert isinstance(somebody.ended(), Interrupted)
    begun = pid(writer)
    os.kill(begun, signal.SIGCONT)
    assert writer.write(request())
    assert pid(writer) == begun, "it was loaded on"


def test_giving_up_needs_no_answer_of_a_process_that_is_stuck(
    rambling: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(rambling)
    somebody = Writes(writer, request(seconds=600.0))
    assert somebody.began.wait(SOON)
    os.kill(pid(writer), signal.SIGSTOP)
    writer.cancel()
    assert isinstance(somebody.ended(), Interrupted)


def test_giving_up_when_nothing_is_written_hits_nobody(
    terse: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(terse)
    writer.cancel()
    writer.get_ready(PREFIX)
    writer.cancel()
    assert writer.write(request())


# --- what breaks


def test_a_process_that_is_killed_costs_one_sentence(
    rambling: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(rambling)
    somebody = Writes(writer, request(seconds=600.0))
    assert somebody.began.wait(SOON)
    killed = pid(writer)
    os.kill(killed, signal.SIGKILL)
    error = somebody.ended()
    assert isinstance(error, Unavailable)
    assert "memory" in str(error)
    assert is_gone(killed)

    writer.get_ready(PREFIX)
    second = pid(writer)
    assert second != killed
    os.kill(second, signal.SIGKILL)  # while nobody waits: nobody notices
    os.waitid(os.P_PID, second, os.WEXITED | os.WNOWAIT)
    writer.get_ready(PREFIX)
    assert pid(writer) not in (killed, second)
    assert is_gone(second)


def test_a_process_that_is_stuck_is_ended(
    terse: Path, process: Callable[[Path], Process], monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = process(terse)
    writer.get_ready(PREFIX)
    stuck = pid(writer)
    os.kill(stuck, signal.SIGSTOP)
    monkeypatch.setattr(client, "SILENT", 0.01)
    with pytest.raises(Unavailable):
        writer.write(request())
    assert is_gone(stuck)


def test_a_damaged_model_is_told_and_not_loaded_again_for_a_while(
    terse: Path,
    process: Callable[[Path], Process],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    damaged = tmp_path / "damaged"
    damaged.mkdir()
    for file in terse.iterdir():
        (damaged / file.name).write_bytes(file.read_bytes()[:100])
    writer = process(damaged)
    with pytest.raises(Unavailable):
        writer.write(request())
    assert writer._running is None

    started: list[object] = []
    begin = subprocess.Popen
    monkeypatch.setattr(
        client.subprocess, "Popen", lambda *a, **k: (started.append(a), begin(*a, **k))[1]
    )
    with pytest.raises(Unavailable, match="half a minute"):
        writer.write(request())
    assert started == []

    for file in terse.iterdir():
        (damaged / file.name).write_bytes(file.read_bytes())
    later = time.monotonic() + client.LEFT_ALONE
    monkeypatch.setattr(client.time, "monotonic", lambda: later)
    assert writer.write(request())


def test_a_folder_without_a_model_is_told(
    process: Callable[[Path], Process], tmp_path: Path
) -> None:
    with pytest.raises(Unavailable):
        process(tmp_path / "nowhere").write(request())


def test_loading_that_takes_too_long_is_given_up(
    terse: Path, process: Callable[[Path], Process], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(client, "STARTS_WITHIN", 0.0)
    writer = process(terse)
    with pytest.raises(Unavailable):
        writer.write(request())
    with pytest.raises(Unavailable, match="half a minute"):
        writer.write(request())


SAYS = """
import sys
sys.stdout.write({first!r})
sys.stdout.flush()
sys.stdin.readline()
sys.stdout.write({then!r})
sys.stdout.flush()
"""


@pytest.mark.parametrize(
    ("first", "then"),
    [
        ("Traceback: tea is cold\n", ""),
        ('{"type":"ready"}\n', '{"type":"done","id":1,"writ'),
        ('{"type":"ready"}\n', "Warning: tea is hot\n"),
        ('{"type":"ready"}\n', '{"type":"failed","id":1}\n'),
        ('{"type":"ready"}\n', "\xff\n"),
    ],
)
def test_a_process_that_talks_nonsense_is_ended(
    first: str, then: str, process: Callable[[Path], Process], monkeypatch: pytest.MonkeyPatch
) -> None:
    begin = subprocess.Popen
    told = [sys.executable, "-c", SAYS.format(first=first, then=then)]
    monkeypatch.setattr(client.subprocess, "Popen", lambda command, **how: begin(told, **how))
    writer = process(Path("anywhere"))
    with pytest.raises(Unavailable):
        writer.write(request())
    assert writer._running is None


# --- the end


def test_closing_leaves_nobody_and_the_next_sentence_begins_anew(
    rambling: Path, process: Callable[[Path], Process]
) -> None:
    writer = process(rambling)
    writer.close()  # nothing to close
    somebody = Writes(writer, request(seconds=600.0))
    assert somebody.began.wait(SOON)
    first = pid(writer)
    writer.close()
    assert isinstance(somebody.ended(), Unavailable)
    assert is_gone(first)
    writer.close()
    writer.get_ready(PREFIX)
    assert pid(writer) != first


@pytest.fixture
def worker(rambling: Path) -> Iterator[subprocess.Popen[bytes]]:
    """The process itself, as a parent begins it."""
    process = subprocess.Popen(
        [sys.executable, "-m", "nl2robot.language_model.worker", str(rambling)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    )
    with process:
        yield process
        process.kill()


def order(kind: str, **known: Any) -> bytes:
    return json.dumps({"type": kind, **known}).encode() + b"\n"


def test_it_says_nothing_but_reports(worker: subprocess.Popen[bytes]) -> None:
    asked = {"prefix": PREFIX, "said": [{"text": "off to ward a"}], "most": 2, "seconds": 0.3}
    out, _ = worker.communicate(
        order("write", id=1, request={"prefix": PREFIX})
        + order("cancel", id=7)
        + order("write", id=2, request=asked)
        + order("cancel", id=3)
        + order("write", id=3, request=asked),
        timeout=SOON,
    )
    assert worker.returncode == 0
    reports = [json.loads(line) for line in out.splitlines()]
    assert {each["type"] for each in reports} <= {"ready", "growing", "done", "failed"}
    assert reports[0] == {"type": "ready"}
    assert {each["id"] for each in reports[1:]} >= {1}  # the end of all orders may overtake them


def test_it_ends_with_whoever_began_it(worker: subprocess.Popen[bytes]) -> None:
    assert worker.stdin is not None and worker.stdout is not None
    assert json.loads(worker.stdout.readline()) == {"type": "ready"}
    asked = {"prefix": PREFIX, "said": [{"text": "off to ward a"}], "seconds": 600.0}
    worker.stdin.write(order("write", id=1, request=asked))
    worker.stdin.flush()
    assert json.loads(worker.stdout.readline())["type"] == "growing"
    worker.stdin.close()  # the parent is gone, in the middle of a sentence
    assert worker.wait(SOON) == 0


def test_no_model_is_loaded_for_which_there_is_too_little_memory(
    terse: Path, process: Callable[[Path], Process], monkeypatch: pytest.MonkeyPatch
) -> None:
    writer = process(terse)
    monkeypatch.setattr(client, "free_megabytes", lambda: 120.0)
    told = r"needs about \d+ MB of memory, and only 120 MB are free"
    with pytest.raises(Unavailable, match=told):
        writer.write(request())
    assert writer.memory() is None
    monkeypatch.setattr(client, "free_megabytes", lambda: None)  # who knows
    assert writer.write(request())
    assert (writer.memory() or 0) > 10
