"""What `make` installs is what the files of `locks/` name, byte for byte, and they name all that
pyproject.toml asks for. After a change there: `make lock`."""

from __future__ import annotations

import re
import shutil
import subprocess
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from packaging.markers import Marker
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

ROOT = Path(__file__).parents[1]
LOCKS = ROOT / "locks"
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
EXTRAS = PROJECT["optional-dependencies"]
UNDER_THE_GPL = {"piper-tts", "espeakng-loader"}
EVERYTHING = [*PROJECT["dependencies"], *(each for name in EXTRAS for each in EXTRAS[name])]
BUILDS = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["build-system"]["requires"]
HOLDS = {
    "build": BUILDS,
    "run": [each for each in EVERYTHING if each not in (*EXTRAS["voices"], *EXTRAS["dev"])],
    "voices": EXTRAS["voices"],
    "dev": EVERYTHING,
}
"""What is asked for of each file."""
MACHINES = [
    {"sys_platform": system, "platform_machine": machine, "platform_system": name}
    for system, name, machine in (
        ("linux", "Linux", "x86_64"),
        ("linux", "Linux", "aarch64"),
        ("darwin", "Darwin", "arm64"),
        ("win32", "Windows", "AMD64"),
    )
]
PYTHONS = ("3.11.2", "3.11.14", "3.12.12", "3.13.9", "3.14.1")


@dataclass(frozen=True)
class Locked:
    name: str
    version: str
    marker: Marker | None
    hashes: tuple[str, ...]

    def is_for(self, environment: dict[str, str]) -> bool:
        return self.marker is None or self.marker.evaluate(environment)


def text(name: str) -> str:
    return (LOCKS / f"{name}.txt").read_text("utf-8")


def locked(name: str) -> Iterator[Locked]:
    whole = re.sub(r"\\\n", " ", text(name))
    for line in whole.splitlines():
        if line.strip() and not line.lstrip().startswith("#"):
            wanted, *hashes = line.split("--hash=")
            requirement = Requirement(wanted.strip())
            [pinned] = requirement.specifier
            assert pinned.operator == "==" and not requirement.extras, line
            yield Locked(
                canonicalize_name(requirement.name),
                pinned.version,
                requirement.marker,
                tuple(each.strip() for each in hashes),
            )


def environments() -> Iterator[dict[str, str]]:
    for machine in MACHINES:
        for python in PYTHONS:
            short = python.rpartition(".")[0]
            yield {**machine, "python_full_version": python, "python_version": short, "extra": ""}


@pytest.mark.parametrize("name", HOLDS)
def test_whatever_pyproject_asks_for_is_locked_on_every_machine(name: str) -> None:
    there = list(locked(name))
    for wanted in map(Requirement, HOLDS[name]):
        if wanted.name == PROJECT["name"]:
            continue  # extras of our own, which are asked for one by one
        for environment in environments():
            if wanted.marker is not None and not wanted.marker.evaluate(environment):
                continue
            pins = [
                each.version
                for each in there
                if each.name == canonicalize_name(wanted.name) and each.is_for(environment)
            ]
            assert len(pins) == 1 and wanted.specifier.contains(pins[0]), (
                f"locks/{name}.txt has {pins or 'nothing'} for {wanted} with {environment}."
                " Run `make lock`."
            )


def test_what_is_not_asked_for_any_more_is_not_locked_on_its_own_account() -> None:
    asked, name = set(), ""
    for line in text("dev").splitlines():
        if "==" in line:
            name = line.partition("==")[0]
        elif "(pyproject.toml)" in line:
            asked.add(canonicalize_name(name))
    wanted = {canonicalize_name(Requirement(each).name) for each in HOLDS["dev"]}
    assert asked == wanted - {PROJECT["name"]}, "Run `make lock`."


@pytest.mark.parametrize("name", HOLDS)
def test_every_package_has_its_hashes_and_nobody_says_where_it_was_found(name: str) -> None:
    for each in locked(name):
        assert each.hashes, each.name
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", one) for one in each.hashes), each.name
    assert not re.search(r"://|--index|--extra-index|--find-links|--trusted| @ |/home/", text(name))


def test_one_version_of_a_package_in_all_files() -> None:
    """So `make run`, `make voices` and `make test` may follow each other in any order."""
    everything = set(locked("dev"))
    assert set(locked("run")) | set(locked("voices")) <= everything


def test_nothing_under_the_gpl_is_installed_unasked() -> None:
    assert not UNDER_THE_GPL & {each.name for each in locked("run")}
    assert {each.name for each in locked("voices")} >= UNDER_THE_GPL


@pytest.mark.parametrize(
    ("target", "files"),
    [
        ("run", ["locks/build.txt", "locks/run.txt"]),
        ("voices", ["locks/build.txt", "locks/run.txt", "locks/voices.txt"]),
        ("lint", ["locks/build.txt", "locks/dev.txt"]),
    ],
)
def test_make_installs_nothing_else(target: str, files: list[str]) -> None:
    make = shutil.which("make")
    if make is None:
        pytest.skip("There is no make.")
    done = subprocess.run(
        [make, "--dry-run", "--always-make", target],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    installs = [line.split() for line in done.stdout.splitlines() if "pip install" in line]
    ours = [words for words in installs if words[-3:] == ["--no-deps", "-e", "."]]
    others = [words for words in installs if words not in ours]
    assert len(ours) == 1
    assert all("--require-hashes" in words for words in others)
    assert [words[words.index("-r") + 1] for words in others] == files
