"""Which kinds of robots there are, and how an address finds its kind."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from robot_api.errors import InternalError, NotSupported
from robot_api.robots.address import Address, BadAddress, parse
from robot_api.robots.opening import open_robot
from robot_api.robots.registry import RobotKind, kind_of, known
from tests.robots.packages import install

CAT = """
from robot_api.drivers import emulated
from robot_api.robots.registry import RobotKind

CAT = RobotKind(
    scheme="cat", title="A robot cat", example="cat://HOST", connect=lambda setup: emulated()
)
THIEF = RobotKind(scheme="sim", title="x", example="sim", connect=lambda setup: emulated())
ODD = RobotKind(scheme="no scheme", title="x", example="x", connect=lambda setup: emulated())
NOTHING = 7
"""

Install = Callable[..., None]


@pytest.fixture
def pip_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Install:
    def pip_install(name: str, entry_points: str, **modules: str) -> None:
        monkeypatch.syspath_prepend(str(install(tmp_path / name, name, entry_points, **modules)))

    return pip_install


# --- addresses


@pytest.mark.parametrize(
    ("text", "address"),
    [
        ("sim", Address("sim")),
        (" SIM ", Address("sim")),
        ("ros2://192.168.1.20:9090", Address("ros2", "192.168.1.20", 9090)),
        ("pepper://nao@pepper.local", Address("pepper", "pepper.local", None, "nao")),
        ("localhost:9090", Address("ws", "localhost", 9090)),
        ("ws://[::1]:9090/", Address("ws", "::1", 9090)),
    ],
)
def test_an_address_is_read(text: str, address: Address) -> None:
    assert parse(text) == address
    assert parse(str(address)) == address


@pytest.mark.parametrize(
    "text", ["", "ros2://", "ros2://host:99999", "ws://host/path", "ws://host?x=1", "://", "ws://["]
)
def test_what_is_no_address_is_said(text: str) -> None:
    with pytest.raises(BadAddress, match="is no address of a robot"):
        parse(text)


def test_a_password_stands_in_no_address() -> None:
    with pytest.raises(BadAddress, match="NL2ROBOT_ROBOT_PASSWORD"):
        parse("pepper://nao:secret@host")


# --- kinds


def test_the_kinds_of_the_project_are_there() -> None:
    kinds = known().kinds
    assert {"sim", "emulator", "ws"} <= set(kinds)
    for scheme, kind in kinds.items():
        assert kind.scheme == scheme
        assert kind.example.startswith(scheme)
        assert kind.title[0].isupper()
        assert not kind.title.endswith(".")


def test_a_word_that_is_nearly_a_kind_is_pointed_to_it() -> None:
    with pytest.raises(BadAddress, match=r"no kind of robot called 'emulater'.*mean emulator\?"):
        kind_of(parse("emulater"))
    with pytest.raises(BadAddress, match="There is sim, "):
        kind_of(parse("xyz://host"))


def test_a_package_adds_a_kind(pip_install: Install) -> None:
    pip_install("robot-cat", "cat = robot_cat:CAT", robot_cat=CAT)
    kind = kind_of(parse("cat://host"))
    assert kind.title == "A robot cat"
    driver = open_robot(parse("cat://host"), kind)
    assert "say" in driver.capabilities().methods
    driver.close()


@pytest.mark.parametrize(
    ("entry", "sentence"),
    [
        ("owl = robot_owl:OWL", "cannot be loaded"),  # a module that is not there
        ("owl = robot_cat2:OWL", "cannot be loaded"),  # a name that is not there
        ("owl = robot_cat2:NOTHING", "is no RobotKind"),
        ("owl = robot_cat2:ODD", "no address can begin with"),
        ("owl = robot_cat2:THIEF", "sim:// belongs to another driver"),
        ("owl = robot_ends:OWL", "cannot be loaded (SystemExit: 3)"),
        ("owl = robot_torn:OWL", "cannot be loaded (SyntaxError"),
    ],
)
def test_a_package_that_is_broken_is_a_sentence_and_disturbs_nobody(
    pip_install: Install, entry: str, sentence: str
) -> None:
    modules = {"robot_cat2": CAT, "robot_ends": "raise SystemExit(3)", "robot_torn": "def ("}
    pip_install("robot-owl", entry, **modules)
    there = known()
    assert "sim" in there.kinds
    assert there.kinds["sim"].title == "A robot in a simulated hospital"
    trouble = there.troubles["owl"]
    assert sentence in trouble
    assert "pip uninstall robot-owl" in trouble
    with pytest.raises(BadAddress) as raised:
        kind_of(parse("owl://host"))
    assert str(raised.value) == trouble


# --- what a kind needs


def test_what_is_missing_is_said_with_how_to_get_it() -> None:
    kind = RobotKind(
        scheme="far",
        title="A far robot",
        example="far://HOST",
        connect=lambda setup: pytest.fail("it was connected"),
        modules=("json", "no_such_library", "no_such.inner"),
        extra="far",
    )
    assert kind.missing() == ("no_such_library", "no_such.inner")
    with pytest.raises(NotSupported) as raised:
        open_robot(parse("far://host"), kind)
    assert str(raised.value) == (
        "A far robot needs no_such_library and no_such.inner, which are not installed."
        " Install it: pip install 'nl2robot[far]'."
    )


def test_a_driver_that_stumbles_on_its_way_is_a_sentence() -> None:
    def stumble(setup: object) -> object:
        raise KeyError("session")

    kind = RobotKind(scheme="far", title="Far", example="far://HOST", connect=stumble)  # type: ignore[arg-type]
    with pytest.raises(InternalError, match=r"driver for far:// failed.*KeyError"):
        open_robot(parse("far://host"), kind)
