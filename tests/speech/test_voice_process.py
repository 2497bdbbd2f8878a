"""What stands under the GPL speaks in a process of its own; whatever becomes of that is borne."""

from __future__ import annotations

import importlib.util
import json
import os
import select
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from nl2robot.speech.hear.sounding_like import respelled
from nl2robot.speech.speak import voice_process, voices
from nl2robot.speech.speak.voice_process import CannotSpeak, VoiceProcess
from nl2robot.speech.speak.voices import VoiceError, espeak, joined, never, phonemes, voice

LONG = "The night service is in the emergency room until six in the morning. " * 25
GREETING = {"do": "speak", "voice": "en", "text": "Good morning.", "speed": 1.0, "pitch": 1.0}
SOON = 30.0
has_pidfd = pytest.mark.skipif(not hasattr(os, "pidfd_open"), reason="only Linux tells of an end")


def speaking() -> int:
    """The number of the process that espeak-ng speaks in."""
    joined(espeak("en").speak("Hello."))
    pid = voices._ESPEAK.pid
    assert pid is not None
    return pid


def kill(pid: int) -> None:
    os.kill(pid, signal.SIGKILL)


def in_a_process_of_its_own(program: str, cwd: Path | None = None) -> str:
    # From 3.12 on Python warns of a copy of a process with threads.
    python = [sys.executable, "-W", "ignore::DeprecationWarning"]
    done = subprocess.run(
        [*python, "-c", program], capture_output=True, text=True, cwd=cwd, timeout=SOON
    )
    assert (done.returncode, done.stderr) == (0, ""), done.stderr
    return done.stdout


# --- what is in which process --------------------------------------------------------------------

SPEAKS = """
import sys
from pathlib import Path
from nl2robot.speech.speak.voices import joined, phonemes, voice

for kind in ("piper", "espeak"):
    assert joined(voice("en", kind).speak("Good morning.")).seconds > 0.4
assert phonemes("robot", "en-us")
maps = Path("/proc/self/maps")
loaded = {line.split()[-1] for line in maps.open()} if maps.exists() else set()
names = {each.partition(".")[0] for each in sys.modules} | loaded
print(sorted(each for each in names if "piper" in each or "espeak" in each))
"""


def test_neither_piper_nor_espeak_is_ever_in_this_process() -> None:
    assert in_a_process_of_its_own(SPEAKS).strip() == "[]"


def test_what_lies_where_somebody_works_is_not_taken_for_it(tmp_path: Path) -> None:
    for name in ("piper", "espeakng_loader", "onnxruntime"):
        (tmp_path / f"{name}.py").write_text(f"open({name!r} + '.ran', 'w')\n")
    in_a_process_of_its_own(SPEAKS, cwd=tmp_path)
    assert not list(tmp_path.glob("*.ran"))


def test_without_it_nobody_knows_how_a_name_sounds(monkeypatch: pytest.MonkeyPatch) -> None:
    """As after `make run`: what was heard stays as it is, and nothing breaks."""
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(VoiceError, match="espeak-ng is not installed"):
        phonemes("xylophone", "en")
    assert not list(respelled("take the xylofone", ["xylophone"], "en"))
    monkeypatch.undo()  # and once it is installed, they do
    assert next(respelled("take the xylofone", ["xylophone"], "en")) == "take the xylophone"


def test_half_a_letter_is_passed_over() -> None:
    assert phonemes("\ud800robot", "en-us") == phonemes("robot", "en-us")


# --- whatever becomes of it ----------------------------------------------------------------------


def test_one_that_was_killed_is_begun_anew() -> None:
    first = speaking()
    kill(first)
    assert speaking() != first


def test_one_that_is_killed_in_the_middle_says_the_whole_of_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(voices, "pieces", lambda text: [text])
    whole = joined(espeak("en").speak(LONG)).seconds
    victim = speaking()
    asked = 0

    def looks_on() -> bool:
        nonlocal asked
        asked += 1
        if asked == 3:  # once before it begins to speak, once when it is asked
            kill(victim)
        return False

    again = joined(espeak("en").speak(LONG, stopped=looks_on)).seconds
    assert voices._ESPEAK.pid != victim
    assert again == pytest.approx(whole, rel=0.02)  # espeak-ng lets a voice waver a little


def test_a_stop_waits_for_no_neural_voice(monkeypatch: pytest.MonkeyPatch) -> None:
    neural = voice("en", "piper")
    joined(neural.speak("Hello."))  # loads it
    monkeypatch.setattr(voices, "pieces", lambda text: [text])
    asked = 0

    def is_stopped() -> bool:
        nonlocal asked
        asked += 1
        return asked >= 3  # while it speaks

    assert list(neural.speak(LONG, stopped=is_stopped)) == []
    worker = voices._PIPER._worker
    assert worker is not None and worker.answers.empty()  # it is still at it
    assert 0.4 < joined(neural.speak("Good morning.")).seconds < 3  # and not what was left of that


ENDS = """
import sys
from nl2robot.speech.speak import voices
from nl2robot.speech.speak.voices import espeak, joined

joined(espeak("en").speak("Hello."))
voices.pieces = lambda text: [text]
def told() -> bool:
    print(voices._ESPEAK.pid, flush=True)
    return False
joined(espeak("en").speak({text!r}, stopped=told))
sys.stdin.read()
"""


@has_pidfd
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGTERM, signal.SIGINT])
def test_it_ends_with_whoever_began_it_in_the_middle_of_a_word(number: int) -> None:
    with subprocess.Popen(
        [sys.executable, "-c", ENDS.format(text=LONG * 20)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    ) as parent:
        assert parent.stdout is not None
        for _ in range(3):  # before it speaks, when it is asked, and now it does
            parent.stdout.readline()
        handle = os.pidfd_open(int(parent.stdout.readline()))
        parent.send_signal(number)
        assert select.select([handle], [], [], SOON)[0]
        os.close(handle)


FORKS = """
import os
from nl2robot.speech.speak import voices
from nl2robot.speech.speak.voices import phonemes

told = phonemes("robot", "en-us")
ours = voices._ESPEAK.pid
copy = os.fork()
if not copy:
    os._exit(not (phonemes("robot", "en-us") == told and voices._ESPEAK.pid != ours))
print(os.waitstatus_to_exitcode(os.waitpid(copy, 0)[1]))
print(phonemes("robot", "en-us") == told and voices._ESPEAK.pid == ours)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there are no copies of a process here")
def test_a_copy_of_a_process_has_one_of_its_own() -> None:
    assert in_a_process_of_its_own(FORKS).split() == ["0", "True"]


# --- one that is not what it should be -----------------------------------------------------------

BEGINS = """
import json, os, struct, sys

def answer(**head):
    data = json.dumps(head).encode()
    os.write(1, struct.pack(">II", len(data), 0) + data)

def order():
    head, _ = struct.unpack(">II", os.read(0, 8))
    return json.loads(os.read(0, head))

with open({log!r}, "a") as log:
    log.write("begun ")
"""


@pytest.fixture
def process(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Callable[[str], VoiceProcess]]:
    """Makes one that runs this program instead."""
    made: list[VoiceProcess] = []

    def begin(program: str) -> VoiceProcess:
        worker = tmp_path / "worker.py"
        worker.write_text(BEGINS.format(log=str(tmp_path / "log")) + program)
        monkeypatch.setattr(voice_process, "WORKER", worker)
        made.append(VoiceProcess("espeak"))
        return made[-1]

    yield begin
    for each in made:
        each.close()


def begun(tmp_path: Path) -> int:
    return (tmp_path / "log").read_text().split().count("begun")


@pytest.mark.parametrize(
    "program",
    [
        "answer(ready=True); order()",
        "answer(ready=True); order(); os.write(1, b'tea')",
        "answer(ready=True); order(); os.write(1, b'Traceback (most recent call last)')",
        "answer(ready=True); order(); os.write(1, struct.pack('>II', 3, 0) + b'[1]'); order()",
        "answer(ready=True); order(); os.write(1, b'\\xff' * 8); order()",
    ],
)
def test_one_that_dies_of_it_or_talks_nonsense_is_asked_twice(
    program: str, process: Callable[[str], VoiceProcess], tmp_path: Path
) -> None:
    speaks = process(program)
    with pytest.raises(CannotSpeak, match="ended"):
        speaks.ask(GREETING, never)
    assert begun(tmp_path) == 2
    assert speaks.pid is None
    with pytest.raises(CannotSpeak, match="ended"):
        speaks.ask(GREETING, never)  # maybe it was what it should have said
    assert begun(tmp_path) == 4


@pytest.mark.parametrize("program", ["", "answer(ready=False)", "1 / 0", "os.write(1, b'tea')"])
def test_one_that_cannot_be_started_is_left_alone_for_a_while(
    program: str,
    process: Callable[[str], VoiceProcess],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(voice_process, "LEFT_ALONE", 1000.0)
    speaks = process(program)
    for _ in range(5):
        with pytest.raises(CannotSpeak, match="start"):
            speaks.ask(GREETING, never)
    assert begun(tmp_path) == 2
    monkeypatch.setattr(voice_process, "LEFT_ALONE", 0.0)
    speaks._not_before = 0.0  # a while later
    with pytest.raises(CannotSpeak, match="start"):
        speaks.ask(GREETING, never)
    assert begun(tmp_path) == 4


def test_one_that_is_stuck_is_ended(
    process: Callable[[str], VoiceProcess], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(voice_process, "PATIENCE", 0.1)
    speaks = process("answer(ready=True)\nwhile True: order()")
    with pytest.raises(CannotSpeak, match="ended"):
        speaks.ask(GREETING, never)
    assert speaks.pid is None


def test_an_answer_to_somebody_who_stopped_asking_is_nobody_elses(
    process: Callable[[str], VoiceProcess],
) -> None:
    speaks = process(
        "answer(ready=True)\n"
        "first, cancelled, second = order(), order(), order()\n"
        "assert cancelled == {'id': first['id'], 'do': 'cancel'}\n"
        "answer(id=first['id'], text='too late')\n"
        "answer(id=second['id'], text=second['text'])\n"
        "order()\n"
    )
    stops = iter([False, True])
    assert speaks.ask({"do": "tell", "text": "one"}, lambda: next(stops)) is None
    answer = speaks.ask({"do": "tell", "text": "two"}, never)
    assert answer is not None and answer.head["text"] == "two"


@pytest.mark.parametrize(
    ("why", "told"),
    [
        ("voice", r"espeak-ng does not speak 'en'\. Choose"),
        ("start", r"espeak-ng cannot be started\. Install it again: pip install"),
        ("ended", r"has ended unexpectedly, and again .* Close other programs, and try again"),
    ],
)
def test_whatever_is_wrong_is_told_in_a_sentence(
    why: str, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    def cannot(order: object, stopped: object) -> None:
        raise CannotSpeak(why)

    monkeypatch.setattr(voices._ESPEAK, "ask", cannot)
    with pytest.raises(VoiceError, match=told):
        joined(espeak("en").speak("Hello."))
    monkeypatch.setattr(voices._PIPER, "ask", cannot)
    with pytest.raises(VoiceError):
        joined(voice("en", "piper").speak("Hello."))


def test_who_speaks_when_all_ends_begins_nothing_any_more(
    process: Callable[[str], VoiceProcess], tmp_path: Path
) -> None:
    speaks = process("answer(ready=True); order()")
    speaks.close_for_good()
    assert speaks.ask(GREETING, never) is None
    assert not (tmp_path / "log").exists()


# --- the process itself --------------------------------------------------------------------------


def test_it_says_nothing_but_frames() -> None:
    def frame(**head: object) -> bytes:
        data = json.dumps(head).encode()
        return len(data).to_bytes(4, "big") + bytes(4) + data

    with subprocess.Popen(
        [sys.executable, str(voice_process.WORKER), "espeak"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
    ) as worker:
        assert worker.stdin is not None and worker.stdout is not None
        worker.stdin.write(frame(id=1, **GREETING) + frame(id=2, do="tell", voice="x", text="x"))
        worker.stdin.flush()
        heads = []
        for _ in range(3):
            size, more = (int.from_bytes(worker.stdout.read(4), "big") for _ in range(2))
            heads.append(json.loads(worker.stdout.read(size)))
            worker.stdout.read(more)
        worker.stdin.close()  # whoever began it is gone
        assert worker.wait(SOON) == 0
        assert worker.stdout.read() == b""
        assert worker.stderr is not None and worker.stderr.read() == b""
    assert heads == [{"ready": True}, {"id": 1, "rate": 22050}, {"id": 2, "cannot": "voice"}]
