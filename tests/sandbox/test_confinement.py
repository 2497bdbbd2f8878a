"""The second wall: what somebody cannot do who has got out of the interpreter.

A shell stands for an interpreter with a hole. It is started as the interpreter is, answers as it
does, and when the program arrives it does what no program may. Each deed is done with each layer
alone that shall prevent it, and without any, where it has to come off.
"""

from __future__ import annotations

import errno
import fcntl
import functools
import mmap
import os
import platform
import re
import socket
import struct
import subprocess
import sys
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import pytest

from sandbox import confinement, worker
from sandbox.confinement import LAYERS, confined, kernel, landlock, rlimits, seccomp
from sandbox.confinement.calls import NUMBERS
from sandbox.execution import Execution
from sandbox.interpreter import Interpreter, Killed, LimitReached
from sandbox.limits import Limits
from tests.sandbox.ward import Ward

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the wall is made of Linux")

SMALL = Limits(memory=5_000_000)
SECRET = "the patient's name\n"


@functools.cache
def here() -> frozenset[str]:
    return worker.layers()


def needs(*layers: str) -> None:
    missing = {*layers} - here()
    if missing:
        pytest.skip(f"this system has no {', '.join(sorted(missing))}")


# --- a process with a hole -----------------------------------------------------------------------

SHELL = """\
#!/bin/sh
printf '\\002\\000\\000\\000R\\000'
while read -r line; do
    case "$line" in *"class Location"*) break ;; esac
done
exec 2>&-
{deed}
exit 3
"""

DEEDS = {
    "write a file": "true > {folder}/new && exit 0",
    "write more to a file": "true >> {folder}/notes && exit 0",
    "read the log": "read -r line < {folder}/notes && exit 0",
    "read who has an account here": "read -r line < /etc/passwd && exit 0",
    "start a process": "(true) && exit 0",
    "start a program": "exec /bin/true",
    "tell the host to end": "kill -0 $PPID && exit 0",
    "set its own limits": "ulimit -s 100 && exit 0",
    "take much memory": "x=0123456789; while [ ${{#x}} -lt 100000000 ]; do x=$x$x; done; exit 0",
}

PREVENTED_BY = [
    ("write a file", "limits"),
    ("write a file", "landlock"),
    ("write a file", "seccomp"),
    ("write more to a file", "limits"),
    ("write more to a file", "landlock"),
    ("write more to a file", "seccomp"),
    ("read the log", "limits"),
    ("read the log", "landlock"),
    ("read who has an account here", "limits"),
    ("read who has an account here", "landlock"),
    ("start a process", "processes"),
    ("start a program", "processes"),
    ("start a program", "landlock"),
    ("tell the host to end", "seccomp"),
    ("set its own limits", "seccomp"),
    ("take much memory", "limits"),
]


@pytest.fixture
def does(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., bool]:
    """Whether a deed comes off behind a wall of these layers alone."""
    here()
    (tmp_path / "notes").write_text(SECRET)
    shell = tmp_path / "shell"
    monkeypatch.setenv("MONTY_BIN", str(shell))
    loaders = [*landlock.loaders(), "/bin/sh"]
    monkeypatch.setattr(landlock, "loaders", lambda: loaders)
    monkeypatch.setattr(rlimits, "_OVERHEAD", 30_000_000)

    def done(deed: str, layers: frozenset[str]) -> bool:
        shell.write_text(SHELL.format(deed=DEEDS[deed].format(folder=tmp_path)))
        shell.chmod(0o755)
        monkeypatch.setattr(confinement, "LAYERS", layers)
        if "limits" not in layers:
            monkeypatch.setattr(confinement, "limit", lambda *_: False)
        with Interpreter(SMALL, print) as inside:
            assert inside.layers == layers
            with pytest.raises((Killed, LimitReached)) as told:
                inside.start("robot.wait(1)")
        status = re.search(r"exit status: (\d+)", str(told.value))
        return status is not None and status[1] == "0"

    return done


@pytest.mark.parametrize("deed", DEEDS)
def test_without_a_wall_it_is_done(deed: str, does: Callable[..., bool]) -> None:
    assert does(deed, frozenset())


@pytest.mark.parametrize(("deed", "layer"), PREVENTED_BY)
def test_a_layer_alone_prevents_it(deed: str, layer: str, does: Callable[..., bool]) -> None:
    layers = {layer, "seccomp"} if layer == "processes" else {layer}
    needs(*layers)
    assert not does(deed, frozenset(layers))


@pytest.mark.parametrize("deed", DEEDS)
def test_all_layers_together_prevent_it(
    deed: str, does: Callable[..., bool], tmp_path: Path
) -> None:
    needs(*LAYERS)
    assert not does(deed, LAYERS)
    assert (tmp_path / "notes").read_text() == SECRET
    assert not (tmp_path / "new").exists()


# --- what a thread gives up ----------------------------------------------------------------------


def refusal(deed: Callable[[], object], layer: str) -> str | None:
    """The system's name for why it does not do this behind one layer of the wall."""
    needs(layer)

    def tried() -> str | None:
        try:
            deed()
        except OSError as error:
            return errno.errorcode[error.errno or 0]
        return None

    why, held = confined(tried, (), frozenset({layer}))
    assert held == {layer}
    return why


CALLS = {
    "ptrace": ((101, 117), -1, 0, 0, 0),
    "mount": ((165, 40), None, None, None, 0, None),
    "io_uring_setup": ((425, 425), 0, None),
    "bpf": ((321, 280), -1, None, 0),
    "unshare": ((272, 97), 0),
    "setns": ((308, 268), -1, 0),
    "process_vm_writev": ((311, 271), -1, None, 0, None, 0, 0),
    "perf_event_open": ((298, 241), None, 0, -1, -1, 0),
    "userfaultfd": ((323, 282), 0),
    "memfd_create": ((319, 279), None, 0),
    "execveat": ((322, 281), -1, None, None, None, 0),
    "clone3": ((435, 435), None, 0),
    "openat2": ((437, 437), -1, None, None, 0),
    "one that is not invented yet": ((4000, 4000),),
}


@pytest.mark.parametrize("name", CALLS)
def test_calls_that_are_no_computing_do_not_exist(name: str) -> None:
    numbers, *arguments = CALLS[name]
    number = numbers[0 if platform.machine() == "x86_64" else 1]
    assert refusal(lambda: kernel.system_call(number, *arguments), "seccomp") == "ENOSYS"


def test_no_socket_is_opened() -> None:
    for family in (socket.AF_INET, socket.AF_INET6, socket.AF_UNIX, socket.AF_NETLINK):
        assert refusal(lambda family=family: socket.socket(family), "seccomp") == "ENOSYS"


def test_nobody_is_called_or_waited_for_on_a_socket_that_was_left_open() -> None:
    if landlock.version() < 4:
        pytest.skip("this system's Landlock knows no TCP")
    with socket.create_server(("127.0.0.1", 0)) as robot, socket.socket() as caller:
        assert refusal(lambda: caller.connect(robot.getsockname()), "landlock") == "EACCES"
        assert refusal(lambda: caller.bind(("127.0.0.1", 0)), "landlock") == "EACCES"
        caller.connect(robot.getsockname())


def test_files_are_neither_found_nor_changed(tmp_path: Path) -> None:
    log = tmp_path / "log"
    log.write_text(SECRET)
    new = tmp_path / "new"
    for deed in (log.read_bytes, log.unlink, new.mkdir, new.touch):
        assert refusal(deed, "landlock") == "EACCES"
    assert refusal(lambda: list(tmp_path.iterdir()), "landlock") == "EACCES"
    assert refusal(lambda: os.truncate(log, 0), "landlock") == (
        "EACCES" if landlock.version() >= 3 else None
    )
    for deed in (log.unlink, new.mkdir, lambda: os.truncate(log, 0), lambda: log.chmod(0o777)):
        assert refusal(deed, "seccomp") == "ENOSYS"
    for flags in (os.O_WRONLY, os.O_RDWR, os.O_CREAT, os.O_TRUNC, os.O_TMPFILE):
        assert refusal(lambda flags=flags: os.open(log, flags), "seccomp") == "EPERM"


def test_others_are_sent_no_signals() -> None:
    deeds = [lambda: os.kill(os.getppid(), 0), lambda: os.kill(os.getpid(), 0)]
    for deed in deeds:
        assert refusal(deed, "seccomp") == "ENOSYS"
    with Path(os.devnull).open() as file:  # by a file that tells when it can be read
        mine = os.getpid()
        setting = lambda: fcntl.fcntl(file, fcntl.F_SETOWN, mine)  # noqa: E731
        assert refusal(setting, "seccomp") == "EPERM"
    if landlock.version() >= 6:
        assert refusal(deeds[0], "landlock") == "EPERM"


def test_nothing_is_typed_into_the_terminal_that_started_us() -> None:
    typing = 0x5412  # TIOCSTI
    assert refusal(lambda: fcntl.ioctl(0, typing, b"x"), "seccomp") == "EPERM"


def test_no_code_is_made() -> None:
    everything = mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC
    assert refusal(lambda: mmap.mmap(-1, 4096, prot=everything), "seccomp") == "EPERM"
    readable = mmap.PROT_READ | mmap.PROT_EXEC
    assert refusal(lambda: mmap.mmap(-1, 4096, prot=readable), "seccomp") == "EPERM"
    assert refusal(lambda: mmap.mmap(-1, 4096).close(), "seccomp") is None


def test_root_is_nobody() -> None:
    needs("privileges")
    told, _ = confined(lambda: kernel.status("thread-self"), (), frozenset({"privileges"}))
    assert told["NoNewPrivs"] == "1"
    assert int(told["CapEff"], 16) == int(told["CapPrm"], 16) == 0
    if os.geteuid() == 0:
        assert refusal(lambda: os.chroot("/"), "privileges") == "EPERM"


# --- the list of calls, on machines that we are not on -------------------------------------------


def answer(kind: str, name: str, *arguments: int, other: bool = False) -> int:
    """What the filter of a kind of machine says to a call."""
    machine = seccomp._MACHINES[kind]
    number = NUMBERS[name][machine.column]
    assert number is not None
    audit = 0x40000003 if other else machine.audit
    told = struct.pack("=IIQ6Q", number, audit, 0, *arguments, *[0] * (6 - len(arguments)))
    lines = list(struct.iter_unpack("=HBBI", seccomp._filter(machine, True)))
    assert len(lines) < 4096  # more are no filter for Linux
    at = loaded = 0
    while True:
        code, met, unmet, value = lines[at]
        at += 1
        match code:
            case 0x20:
                (loaded,) = struct.unpack_from("=I", told, value)
            case 0x15:
                at += met if loaded == value else unmet
            case 0x45:
                at += met if loaded & value else unmet
            case 0x06:
                return int(value)


ALLOWED, ASKED, ABSENT, FORBIDDEN = 0x7FFF0000, 0x7FC00000, 0x50000 | 38, 0x50000 | 1


@pytest.mark.parametrize("kind", ["x86_64", "aarch64"])
def test_each_kind_of_machine_has_the_same_wall(kind: str) -> None:
    thread, new_process = 0x3D0F00, 0x4111
    assert answer(kind, "read", 0) == answer(kind, "clone", thread) == ALLOWED
    assert answer(kind, "clone", new_process) == answer(kind, "execve") == ASKED
    assert answer(kind, "openat", 0, 0, os.O_RDONLY | os.O_CLOEXEC) == ALLOWED
    assert answer(kind, "openat", 0, 0, os.O_WRONLY) == FORBIDDEN
    assert answer(kind, "mmap", 0, 4096, 5, 2) == ALLOWED  # code out of a library
    assert answer(kind, "mmap", 0, 4096, 5, 0x22) == FORBIDDEN
    assert answer(kind, "mmap", 0, 4096, 3, 0x22) == ALLOWED
    assert answer(kind, "mprotect", 0, 4096, 3) == ALLOWED
    assert answer(kind, "mprotect", 0, 4096, 7) == FORBIDDEN
    assert answer(kind, "prlimit64", 0, 7, 0) == ALLOWED
    assert answer(kind, "prlimit64", 0, 7, 1 << 40) == FORBIDDEN
    assert answer(kind, "fcntl", 0, 8) == answer(kind, "ioctl", 0, 0x5412) == FORBIDDEN
    assert answer(kind, "read", other=True) == ABSENT


# --- the real interpreter ------------------------------------------------------------------------


def test_the_interpreter_stands_behind_all_that_this_system_has() -> None:
    with Interpreter(Limits(), print) as inside:
        assert inside._worker is not None
        process = inside._worker.process
        told = kernel.status(process)
        limited = Path(f"/proc/{process}/limits").read_text()
        opened = {each.name for each in Path(f"/proc/{process}/fd").iterdir()}
    held = inside.layers
    assert "limits" in held
    for name in ("open files", "processes", "file size", "core file size", "locked memory"):
        assert re.search(rf"^Max {name} +0 +0 ", limited, re.MULTILINE), limited
    assert re.search(r"^Max cpu time +173 +178 ", limited, re.MULTILINE), limited
    assert opened == {"0", "1", "2"}
    if "privileges" in held:
        assert told["NoNewPrivs"] == "1"
        assert int(told["CapEff"], 16) == 0
    if "seccomp" in held:
        assert told["Seccomp"] == "2"


def test_what_whoever_started_us_left_open_is_not_handed_on(tmp_path: Path) -> None:
    with (tmp_path / "log").open("w") as log:
        os.set_inheritable(log.fileno(), True)
        with Interpreter(Limits(), print) as inside:
            assert inside._worker is not None
            opened = Path(f"/proc/{inside._worker.process}/fd").iterdir()
            assert tmp_path / "log" not in [each.readlink() for each in opened]


def test_this_process_keeps_its_rights(tmp_path: Path) -> None:
    before = rights()
    assert Ward().run("robot.say('hello')").status == "done"
    assert set(rights().values()) == set(before.values())
    (tmp_path / "log").write_text("written")
    socket.create_server(("127.0.0.1", 0)).close()


def rights() -> dict[str, tuple[str, ...]]:
    """Of each thread, of those that Monty keeps as well."""
    names = ("NoNewPrivs", "Seccomp", "CapEff")
    found = {}
    for task in Path("/proc/self/task").iterdir():
        with suppress(OSError):  # it has ended meanwhile
            told = kernel.status(f"self/task/{task.name}")
            found[task.name] = tuple(told[name] for name in names)
    return found


# --- limits are outcomes -------------------------------------------------------------------------


def test_a_process_that_gets_no_more_memory_is_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rlimits, "_FOR_EACH", 0)
    ward = Ward()
    growing = "x = []\nfor i in range(1000):\n    x.append('a' * 1000000)\n    robot.say(str(i))"
    outcome = ward.run(growing, limits=Limits(memory=10**10))
    assert (outcome.status, outcome.error) == ("limit", "memory")
    assert outcome.message.startswith("The program needs more memory than it may use.")
    assert 20 < len(ward.said) < 200


def test_a_process_that_computes_for_too_long_is_a_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(rlimits, "_seconds", lambda limits: 1)
    outcome = Execution("while True:\n    pass", Ward(), limits=Limits(computing=20)).run()
    assert (outcome.status, outcome.error) == ("limit", "computing")


def test_limits_leave_room_for_what_a_program_may_use() -> None:
    program = "x = []\nfor i in range(220000):\n    x.append('a' * 100)\nrobot.say(str(len(x)))"
    ward = Ward()
    assert ward.run(program, limits=Limits(computing=20)).status == "done"
    assert ward.said == ["220000"]


# --- systems without -----------------------------------------------------------------------------


def test_a_system_that_has_none_of_it_runs_programs(monkeypatch: pytest.MonkeyPatch) -> None:
    def absent(*_: object) -> int:
        raise OSError(errno.ENOSYS, os.strerror(errno.ENOSYS))

    for name in ("system_call", "no_new_privileges", "set_capabilities"):
        monkeypatch.setattr(kernel, name, absent)
    assert worker.layers() == {"limits"}
    assert Ward().run("robot.say('hello')").status == "done"


def test_a_kernel_that_cannot_ask_has_the_other_layers(monkeypatch: pytest.MonkeyPatch) -> None:
    needs("seccomp")
    real = seccomp._install

    def old(of: object, asking: bool) -> int:
        if asking:
            raise OSError(errno.EINVAL, os.strerror(errno.EINVAL))
        return real(of, asking)

    monkeypatch.setattr(seccomp, "_install", old)
    held = worker.layers()
    assert "seccomp" in held
    assert "processes" not in held


def test_where_the_interpreter_does_not_start_behind_the_wall_it_starts_without(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On a system that keeps its libraries where nobody thought of."""
    needs("landlock")
    real = landlock.restrict
    monkeypatch.setattr(landlock, "restrict", lambda programs: real(programs, readable=()))
    assert worker.layers() == {"limits"}
    assert Ward().run("robot.say('hello')").status == "done"


KILLING = """
import ctypes, os, struct, subprocess, sys
{settings}
lines = [(0x20, 0, 0, 0), (0x35, 0, 2, 444), (0x35, 1, 0, 447), (0x06, 0, 0, 0x80000000),
         (0x15, 0, 1, {seccomp}), (0x06, 0, 0, 0x80000000), (0x06, 0, 0, 0x7FFF0000)]
code = ctypes.create_string_buffer(b"".join(struct.pack("=HBBI", *line) for line in lines))
program = struct.pack("HxxxxxxQ", len(lines), ctypes.addressof(code))
kernel.no_new_privileges()
kernel.system_call({seccomp}, 1, 0, program)
print(*sorted(worker.layers()))
"""


def test_a_service_manager_that_kills_for_such_calls_is_not_provoked() -> None:
    """As systemd 252 does with the unit file that we had."""
    needs("landlock", "seccomp", "privileges")
    machine = seccomp.machine()
    assert machine is not None
    host = KILLING.format(
        settings="from sandbox import worker\nfrom sandbox.confinement import kernel",
        seccomp=machine.seccomp,
    )
    folder = Path(__file__).parents[2]
    done = subprocess.run(
        [sys.executable, "-c", host], capture_output=True, text=True, cwd=folder, check=True
    )
    assert done.stdout.split() == ["limits", "privileges"]


def test_an_interpreter_that_was_replaced_is_behind_no_wall() -> None:
    needs("privileges", "seccomp")
    assert confinement.holding(os.getpid(), LAYERS) == frozenset()
    assert confinement.holding(os.getppid(), LAYERS) == frozenset()
