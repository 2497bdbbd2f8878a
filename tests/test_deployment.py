"""What robots are served by without a laptop: the systemd unit, the container image and the check
of wheels are as docs/deployment.md says."""

from __future__ import annotations

import importlib.util
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from dockerfile_parse import DockerfileParser

from nl2robot.errors import ExitStatus
from robot_api.client import DEFAULT_PORT
from robot_api.serving.guard import OPEN_TO_ALL

ROOT = Path(__file__).parents[1]
DEPLOY = ROOT / "docs" / "deploy"
UNIT = DEPLOY / "nl2robot.service"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]


# --- systemd -------------------------------------------------------------------------------------


def settings() -> dict[str, str]:
    """What the unit says, last words first."""
    lines = UNIT.read_text("utf-8").splitlines()
    return dict(line.split("=", 1) for line in lines if line and line[0].isupper())


@pytest.fixture
def analyse(tmp_path: Path) -> Any:
    """`systemd-analyze` on the unit, with a server where the unit looks for one."""
    program = shutil.which("systemd-analyze")
    if program is None:
        hint = "There is no systemd-analyze. `apt-get install systemd` gets it; `make test` does."
        can_be_installed = shutil.which("apt-get") is not None and os.geteuid() == 0
        if os.environ.get("CI") and can_be_installed:
            pytest.fail(hint)
        pytest.skip(hint)
    there = tmp_path / UNIT.name
    server = settings()["ExecStart"].split()[0]
    there.write_text(UNIT.read_text("utf-8").replace(server, shutil.which("true") or ""))

    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [program, *arguments, str(there)]
        return subprocess.run(command, capture_output=True, text=True)

    return run


def test_systemd_has_nothing_against_the_unit(analyse: Any) -> None:
    done = analyse("verify")
    complaints = [line for line in done.stderr.splitlines() if UNIT.name in line]
    assert (done.returncode, complaints) == (0, [])


def test_systemd_calls_the_unit_well_hardened(analyse: Any) -> None:
    done = analyse("security", "--offline=yes", "--threshold=25", "--no-pager")
    if "unrecognized option" in done.stderr:
        pytest.skip("This systemd is older than its check of units that are not installed.")
    assert done.returncode == 0, done.stdout[-300:]  # an exposure of 2.5 of 10 at most


def test_the_unit_runs_serve_as_a_user_of_its_own_and_starts_it_again() -> None:
    unit = settings()
    command = unit["ExecStart"].split()
    assert Path(command[0]).name in PROJECT["scripts"]
    assert command[1] == "serve"
    options = [word for word in command if word.startswith("--")]
    usage = subprocess.run(
        [sys.executable, "-m", "nl2robot.cli.main", "serve", "--help"],
        capture_output=True,
        text=True,
    ).stdout
    assert all(re.search(rf"{option}\b", usage) for option in options)
    assert unit["User"] not in ("", "root")
    assert unit["Restart"] == "on-failure"
    assert int(unit["RestartPreventExitStatus"]) == ExitStatus.BAD_INPUT
    assert "WatchdogSec" not in unit  # nobody tells systemd that the server is well
    for wanted in ("NoNewPrivileges", "ProtectHome", "PrivateTmp", "DynamicUser"):
        assert unit[wanted] == "yes"
    assert unit["ProtectSystem"] == "strict"
    assert unit["CapabilityBoundingSet"] == ""


# --- the container -------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def image() -> list[dict[str, str]]:
    """The Dockerfile's instructions."""
    with (DEPLOY / "Dockerfile").open("rb") as file:
        parser = DockerfileParser(fileobj=file)
        return [
            {"do": each["instruction"], "with": each["value"]}
            for each in parser.structure
            if each["instruction"] != "COMMENT"
        ]


def of(image: list[dict[str, str]], instruction: str) -> list[str]:
    return [each["with"] for each in image if each["do"] == instruction]


def last_stage(image: list[dict[str, str]]) -> list[dict[str, str]]:
    begins = max(number for number, each in enumerate(image) if each["do"] == "FROM")
    return image[begins:]


def test_whatever_the_image_copies_is_there_and_is_let_in(image: list[dict[str, str]]) -> None:
    let_in = (DEPLOY / "Dockerfile.dockerignore").read_text("utf-8").split()
    copied = [words.split()[:-1] for words in of(image, "COPY") if "--from" not in words]
    sources = {source for words in copied for source in words}
    assert sources == {line[1:] for line in let_in if line.startswith("!")}
    for source in sources:
        assert (ROOT / source).exists(), source
    found = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    packages = found["tool"]["setuptools"]["packages"]["find"]["include"]
    assert {package.removesuffix("*") for package in packages} <= sources


def test_the_image_runs_serve_as_somebody_else_than_root(image: list[dict[str, str]]) -> None:
    stage = last_stage(image)
    [user] = of(stage, "USER")
    assert user not in ("root", "0")
    assert stage.index({"do": "USER", "with": user}) < len(stage) - 1
    [entry], [command] = of(stage, "ENTRYPOINT"), of(stage, "CMD")
    assert json.loads(entry)[0] in PROJECT["scripts"]
    assert json.loads(command)[0] == "serve"
    assert of(stage, "EXPOSE") == [str(DEFAULT_PORT)]


def test_the_image_holds_no_build_tools(image: list[dict[str, str]]) -> None:
    stage = last_stage(image)
    assert not any(
        word in ran for ran in of(stage, "RUN") for word in ("apt", "pip", "gcc", "build-essential")
    )
    assert {base.split()[0] for base in of(image, "FROM")} == {"${PYTHON}"}
    [base] = of(image, "ARG")
    python = base.removeprefix("PYTHON=python:")
    assert python.endswith("-slim")
    assert tuple(map(int, python.removesuffix("-slim").split("."))) >= (3, 11)


def test_the_image_asks_the_server_whether_it_is_well(image: list[dict[str, str]]) -> None:
    [health] = of(last_stage(image), "HEALTHCHECK")
    assert f"127.0.0.1:{DEFAULT_PORT}{OPEN_TO_ALL}" in health
    call = re.search(r"CMD (\[.*\])", health)
    assert call is not None
    program, flag, code = json.loads(call[1])
    assert (program, flag) == ("python", "-c")
    compile(code, "HEALTHCHECK", "exec")


def test_the_image_installs_what_is_locked_and_nothing_else(image: list[dict[str, str]]) -> None:
    commands = [each for ran in of(image, "RUN") for each in ran.split("&&") if "install" in each]
    *of_others, ours = commands
    assert "--no-deps" in ours and "--no-build-isolation" in ours
    for command in of_others:
        assert "--require-hashes" in command
        files = re.findall(r"-r (\S+)", command)
        assert files and all((ROOT / file).is_file() for file in files)


# --- wheels --------------------------------------------------------------------------------------


@pytest.fixture(scope="module")
def wheels() -> ModuleType:
    spec = importlib.util.spec_from_file_location("wheels", DEPLOY / "wheels.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # where dataclasses look for it
    spec.loader.exec_module(module)
    return module


class Index:
    """An index of packages: some are ready for a robot's computer, some only elsewhere."""

    def __init__(self, unresolved: type[Exception], **packages: str) -> None:
        self.unresolved = unresolved
        self.packages = packages
        """Each with what there is of it: "any", "arm", "elsewhere" or "source"."""

    def resolve(self, arguments: Sequence[str], given: str | None) -> str:
        if given is not None:
            name = given.partition("==")[0]
            if self.packages[name] == "source":
                raise self.unresolved(f"Because {name}==1.0 has no usable wheels and so on")
            return given
        allowed = {arguments[i + 1] for i, word in enumerate(arguments) if word == "--no-binary"}
        lock = ""
        for name, there_is in self.packages.items():
            lock += f'[[packages]]\nname = "{name}"\nversion = "1.0"\n'
            if there_is in ("any", "arm"):
                tag = "any" if there_is == "any" else "manylinux_2_17_aarch64.manylinux2014_aarch64"
                url = f"https://example.org/{name}-1.0-py3-none-{tag}.whl"
                lock += f'wheels = [{{ url = "{url}" }}]\n'
            elif name not in allowed:
                raise self.unresolved(
                    f"error: No solution found when resolving dependencies cause: Because all"
                    f" versions of {name} have no usable wheels and robot>=1 depends on {name}"
                )
        return lock


def test_what_has_no_wheel_for_the_robots_computer_is_found(
    wheels: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    index = Index(wheels.Unresolved, numpy="arm", rich="any", srt="source", miniaudio="elsewhere")
    assert wheels.main([], index.resolve) == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].split() == ["package", "Python", "3.11", "Python", "3.12", "Python", "3.13"]
    assert lines[1].split() == ["miniaudio", *["NONE", "1.0"] * 3]
    assert lines[2].split() == ["srt", *["source", "1.0"] * 3]
    assert lines[3].split() == ["numpy", *["1.0", "manylinux_2_17_aarch64"] * 3]
    assert lines[-1] == "No wheel for aarch64-manylinux_2_28: miniaudio. Leave it out there."


def test_all_is_well_when_nothing_has_to_be_compiled(
    wheels: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    index = Index(wheels.Unresolved, numpy="arm", srt="source")
    assert wheels.main([], index.resolve) == 0
    assert "Only source, for every computer: srt." in capsys.readouterr().out


def test_what_cannot_be_resolved_is_said(
    wheels: ModuleType, capsys: pytest.CaptureFixture[str]
) -> None:
    def resolve(arguments: Sequence[str], given: str | None) -> str:
        raise wheels.Unresolved("Because there is no version of robot")

    assert wheels.main([], resolve) == 2
    assert "no version of robot" in capsys.readouterr().err


def test_a_computer_without_a_sound_card_library_says_what_to_do(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from nl2robot.speech.audio import AudioError
    from nl2robot.speech.hear.microphone import devices

    monkeypatch.setitem(sys.modules, "miniaudio", None)  # as where it is not installed
    with pytest.raises(AudioError, match="pip install miniaudio"):
        devices()
