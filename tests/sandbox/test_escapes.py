"""What somebody tries who wants out of the sandbox, or wants to hurt the machine that runs it.

Each attempt is run without the check that comes before a run in practice: the sandbox has to hold
by itself. Nothing may be reached but the robot, and nothing may take long.
"""

from __future__ import annotations

import time
from pathlib import Path

import pytest

from robot_api.stub import stub
from sandbox.check import check
from tests.sandbox.ward import Ward, children

SECRET = "the patient's name"

REACHING_OUT = {
    "a file": "robot.say(open('{file}').read())",
    "a file by path": "from pathlib import Path\nrobot.say(Path('{file}').read_text())",
    "writing a file": "open('{file}', 'w').write('gone')",
    "removing a file": "import os\nos.remove('{file}')",
    "listing files": "import os\nrobot.say(str(os.listdir('{folder}')))",
    "the environment": "import os\nrobot.say(os.environ['SECRET'])",
    "the environment, asked kindly": "import os\nrobot.say(os.getenv('SECRET'))",
    "a shell": "import os\nos.system('touch {file}.new')",
    "a process": "import subprocess\nsubprocess.run(['touch', '{file}.new'])",
    "a socket": "import socket\nsocket.create_connection(('localhost', 22))",
    "C": "import ctypes\nctypes.CDLL(None).system(b'touch {file}.new')",
    "import by name": "__import__('os').system('touch {file}.new')",
    "importlib": "import importlib\nimportlib.import_module('os').system('touch {file}.new')",
    "builtins": "import builtins\nbuiltins.open('{file}')",
    "eval": "robot.say(eval(\"open('{file}').read()\"))",
    "exec": "exec(\"robot.say(open('{file}').read())\")",
    "compile": "exec(compile(\"robot.say(open('{file}').read())\", '', 'exec'))",
    "all classes": "for c in ().__class__.__base__.__subclasses__():\n    print(c)",
    "classes of the robot": "robot.say(str(robot.__class__.__mro__[1].__subclasses__()))",
    "what the robot is made of": "robot.say(str(robot.__dict__))",
    "globals of a method": "robot.say(robot.say.__globals__['__builtins__'])",
    "a hidden attribute": "robot.say(str(getattr(robot, '_' + 'call')))",
    "a hidden method": "robot._call('say', 'hidden')",
    "the wrapper": "robot.call_method('say', ('hidden',), {{}})",
    "the class's constructor": "type(robot)().say('hidden')",
    "a method in disguise": "robot.__init__()",
    "format strings": "robot.say('{{0.__init__.__globals__}}'.format(robot))",
    "format_map": "robot.say('{{r.__class__.__mro__}}'.format_map({{'r': robot}}))",
    "a traceback": (
        "try:\n    1 / 0\nexcept Exception as e:\n    robot.say(str(e.__traceback__.tb_frame))"
    ),
    "frames": "import sys\nrobot.say(str(sys._getframe(0).f_back.f_globals))",
    "loaded modules": "import sys\nrobot.say(str(sys.modules['os']))",
    "the garbage collector": "import gc\nrobot.say(str(gc.get_objects()))",
    "a function's code": "def f():\n    pass\nf.__code__ = None\nrobot.say(str(f.__globals__))",
    "signals": "import signal\nsignal.raise_signal(9)",
    "killing": "import os\nos.kill(os.getppid(), 9)",
    "leaving": "import sys\nsys.exit(0)",
    "SystemExit": "raise SystemExit('0')",
    "a debugger": "breakpoint()",
    "asking at the terminal": "robot.say(input('password: '))",
    "pickle": "import pickle\npickle.loads(b\"cos\\nsystem\\n(S'touch {file}.new'\\ntR.\")",
    "threads": "import threading\nthreading.Thread(target=print).start()",
    "super": "class A:\n    def f(self):\n        return super()\nrobot.say(str(A().f()))",
    "a place's class": "robot.say(str(robot.location().__class__.__mro__))",
    "a place's fields": "robot.say(robot.location().__dict__['notes'])",
    "an error's origin": (
        "try:\n    robot.goto('moon')\nexcept Exception as e:\n"
        "    robot.say(str(e.__context__.__traceback__))"
    ),
    "a module's own imports": "import random\nrandom._os.system('touch {file}.new')",
    "a module's loader": "import math\nrobot.say(str(math.__loader__.get_data('{file}')))",
    "a module of a module": "import re._compiler\nrobot.say(str(re._compiler))",
    "letters that look wide": "ｏpen('{file}', 'w')",
    "another robot": "robot = Robot('127.0.0.1:9090')\nrobot.say('hidden')",
}

OVERLOAD = {
    "an endless loop": "while True:\n    pass",
    "a loop that swallows all": (
        "while True:\n    try:\n        while True:\n            pass\n    except:\n        pass"
    ),
    "recursion": "def f():\n    f()\nf()",
    "recursion that swallows all": "def f():\n    try:\n        f()\n    except:\n        f()\nf()",
    "a huge number": "10 ** 10 ** 10",
    "a huge shift": "1 << 10 ** 12",
    "squares": "x = 3\nwhile True:\n    x = x * x",
    "digits": "str(10 ** 1000000)",
    "a huge text": "'x' * 10 ** 12",
    "a growing text": "x = 'x'\nwhile True:\n    x += x",
    "a huge list": "[0] * 10 ** 12",
    "a growing list": "x = []\nwhile True:\n    x.append('a' * 100)",
    "a huge range": "list(range(10 ** 12))",
    "a huge sum": "sum(range(10 ** 15))",
    "a padded number": "f'{{1:>10000000000}}'",
    "a padded percentage": "'%10000000000d' % 1",
    "a slow pattern": "import re\nre.match('(a+)+$', 'a' * 60 + 'b')",
    "a slow pattern, otherwise": "import re\nre.match('(a|aa)+$', 'a' * 90 + 'b')",
    "printing": "while True:\n    print('x' * 1000)",
    "printing slowly": "while True:\n    print('')",
    "a list in itself": "x = []\nx.append(x)\nrobot.do('sit', how=x)",
    "a deep list": "x = []\nfor i in range(100000):\n    x = [x]\nrobot.do('sit', how=x)",
    "a large argument": "robot.say('x' * 15000000)",
    "many calls": "while True:\n    robot.battery()",
    "many failing calls": (
        "while True:\n    try:\n        robot.goto('moon')\n    except:\n        pass"
    ),
    "many unknown names": "while True:\n    try:\n        nothing\n    except:\n        pass",
    "many unknown methods": "while True:\n    try:\n        robot.fly()\n    except:\n        pass",
    "exceptions that hold each other": (
        "def f(n):\n    try:\n        1 / 0\n    except Exception:\n        f(n + 1)\nf(0)"
    ),
    "deep brackets": "x = " + "(" * 5000 + ")" * 5000,
    "deep signs": "x = " + "-" * 20000 + "1",
    "a long sum": "x = " + "1 + " * 15000 + "1",
    "sleeping in small steps": "import time\nwhile True:\n    time.sleep(0)",
    "copies": "x = [1]\nwhile True:\n    x = x + x",
    "a dictionary of texts": "x = {{}}\ni = 0\nwhile True:\n    x[str(i)] = i\n    i += 1",
    "a nested pattern": "import re\nre.compile('(?:(?:a{{1000}}){{1000}}){{1000}}')",
    "factorials": "import math\nmath.factorial(10 ** 8)",
    "combinations": "import math\nmath.comb(10 ** 7, 5 * 10 ** 6)",
    "powers of a huge number": "pow(3, 10 ** 100000, 10 ** 100000)",
    "a nested width": "w = 10 ** 10\nf'{{1:{{w}}}}'",
    "a filled text": "'x'.zfill(10 ** 11)",
    "a text replaced by long ones": "('a' * 10 ** 6).replace('a', 'b' * 10 ** 6)",
    "a matrix": "[[0] * 10 ** 6 for row in range(10 ** 6)]",
    "a deep tuple": "x = ()\nfor i in range(10 ** 5):\n    x = (x,)\nhash(x)",
    "quoted calls": "x = 'robot.location()'\n" * 2500,
    "quoted calls in one line": "x = [" + "'robot.clock()', " * 3500 + "]",
    "calls in a text": "x = f'" + "{{robot.clock()}}" * 3000 + "'",
    "sorting": "while True:\n    sorted(range(100000))",
}


@pytest.mark.parametrize("attempt", REACHING_OUT)
def test_nothing_outside_is_reached(
    attempt: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SECRET", SECRET)
    file = tmp_path / "notes"
    file.write_text(SECRET)
    program = REACHING_OUT[attempt].format(file=file, folder=tmp_path)
    ward = Ward()
    outcome = ward.run(program)
    told = " ".join([*ward.said, *ward.printed, outcome.message])
    assert SECRET not in told
    assert "hidden" not in ward.said
    assert "notes" not in told.replace(str(file), "")
    assert file.read_text() == SECRET
    assert [path.name for path in tmp_path.iterdir()] == ["notes"]
    assert outcome.status == "failed", outcome


@pytest.mark.parametrize("attempt", REACHING_OUT)
def test_whoever_tries_is_told_before_the_run(attempt: str) -> None:
    program = REACHING_OUT[attempt].format(file="/tmp/notes", folder="/tmp")
    # These are exceptions raised as any program may raise its own.
    if attempt not in ("SystemExit",):
        assert any(finding.severity == "error" for finding in check(program, stub()))


@pytest.mark.parametrize("attempt", OVERLOAD)
def test_nothing_takes_long(attempt: str) -> None:
    before = children()
    begun = time.monotonic()
    outcome = Ward().run(OVERLOAD[attempt].format())
    assert time.monotonic() - begun < 5
    assert outcome.status in ("limit", "failed", "done")
    assert children() <= before


@pytest.mark.parametrize("attempt", OVERLOAD)
def test_a_check_does_not_take_long_either(attempt: str) -> None:
    begun = time.monotonic()
    check(OVERLOAD[attempt].format(), stub())
    assert time.monotonic() - begun < 5
