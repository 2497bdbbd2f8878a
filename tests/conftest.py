"""What holds for all tests."""

import logging
import os
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import settings

from grammar.planning.model.planner import ModelPlanner
from nl2robot.deliberation import confidence
from nl2robot.language_model.scripted import ScriptedWriter
from nl2robot.translate import planners

# A busy machine with two cores takes its time; how fast things are is measured, not tested.
# In CI the examples are the same every time: what lands does not hang on luck; at home they are new
# ones at every run, and what they find is a mistake.
settings.register_profile("nl2robot", deadline=None, derandomize=bool(os.environ.get("CI")))
settings.load_profile("nl2robot")


# A shell that starts the tests in its background has them, and all that they start, ignore Ctrl-C.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)

# What the rules do is tested without a language model that may be installed; who tests that asks
# for it.
os.environ["NL2ROBOT_LANGUAGE_MODEL"] = "none"


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--soak", action="store_true", help="whole samples, not a part of each")


@pytest.fixture(scope="session")
def soak(pytestconfig: pytest.Config) -> bool:
    """Whether there is all the time in the world (`make soak`)."""
    return bool(pytestconfig.getoption("--soak"))


@pytest.fixture
def scripted(monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., ScriptedWriter]]:
    """Make a language model be there that knows its programs by heart: `scripted({words: [...]})`
    gives the `ScriptedWriter`."""

    def make(programs: Mapping[str, Sequence[str]], **how: Any) -> ScriptedWriter:
        writer = ScriptedWriter(programs, **how)
        planners.planner.cache_clear()
        monkeypatch.setitem(planners.PLANNERS, "model", lambda: ModelPlanner(writer))
        monkeypatch.setattr(planners, "installed_model", lambda: Path("scripted"))
        return writer

    yield make
    planners.planner.cache_clear()


@pytest.fixture
def uncalibrated(monkeypatch: pytest.MonkeyPatch) -> None:
    """Probabilities are shares of votes, whatever the weights say that are in use."""
    monkeypatch.setattr(confidence, "_weights", dict)


class _Stumbled(logging.Handler):
    def emit(self, record: logging.LogRecord) -> None:
        raise AssertionError(record.getMessage()) from (record.exc_info or (None, None))[1]


@pytest.fixture(autouse=True, scope="session")
def _no_meaning_stumbles() -> Iterator[None]:
    """A person gets an answer though a meaning stumbles over their sentence; a test does not."""
    handler = _Stumbled()
    logging.getLogger("grammar.reader").addHandler(handler)
    yield
    logging.getLogger("grammar.reader").removeHandler(handler)
