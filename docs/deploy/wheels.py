#!/usr/bin/env python3
"""Which packages come ready made (as wheels) for a robot's own computer, and which do not.

    python docs/deploy/wheels.py                      # 64-bit Arm, Linux with glibc 2.28 or newer
    python docs/deploy/wheels.py --platform x86_64-manylinux_2_28

Everything that `pyproject.toml` asks for, the extras too, is resolved by uv for each version of
Python as it would be on that computer; nothing is installed. What has no wheel there, but one
elsewhere, needs a compiler on the robot: it should be left out there, by an environment marker. The
exit status is 1 then. What is only published as source, for every computer, is named and passes:
pip builds it, without a compiler if it is Python alone.
"""

from __future__ import annotations

import argparse
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).parents[2]
PYTHONS = ("3.11", "3.12", "3.13")
ARM = "aarch64-manylinux_2_28"
ELSEWHERE = "x86_64-manylinux_2_28"

_WITHOUT_WHEEL = re.compile(
    r"(?:all versions of )?([A-Za-z0-9][A-Za-z0-9._-]*)(?:[<>=!~][^ ]*)?(?: only)? ha(?:s|ve) no"
    r" (?:usable )?wheels"
)

Resolve = Callable[[Sequence[str], str | None], str]
"""Runs uv with these arguments and that input and returns what it prints. Raises `Unresolved`."""


class Unresolved(Exception):
    """What uv says that it cannot find."""


@dataclass
class Wheels:
    """What there is for one version of Python."""

    ready: dict[str, str] = field(default_factory=dict)
    """Packages that come as wheels, each with its version and what the wheel is made for."""
    source: dict[str, str] = field(default_factory=dict)
    """Packages that are source wherever they are installed, each with its version."""
    missing: dict[str, str] = field(default_factory=dict)
    """Packages that have wheels, but none for this computer, each with its version."""


def look_up(project: Path, platform: str, python: str, resolve: Resolve) -> Wheels:
    """What the project needs on that platform. Raises `Unresolved`."""
    without: list[str] = []
    while True:
        allowed = [part for name in without for part in ("--no-binary", name)]
        try:
            lock = resolve(
                [
                    *(str(project), "--all-extras", "--format", "pylock.toml"),
                    *("--python-platform", platform, "--python-version", python),
                    *("--only-binary", ":all:", *allowed),
                ],
                None,
            )
        except Unresolved as error:
            found = _WITHOUT_WHEEL.search(str(error))
            if found is None or found[1] in without:
                raise
            without.append(found[1])
        else:
            return _sorted(tomllib.loads(lock), python, resolve)


def _sorted(lock: Mapping[str, list[dict[str, object]]], python: str, resolve: Resolve) -> Wheels:
    wheels = Wheels()
    for package in lock["packages"]:
        name, version = str(package["name"]), str(package["version"])
        files = package.get("wheels")
        if isinstance(files, list) and files:
            made_for = {str(file["url"]).rpartition("/")[2].split("-")[-1] for file in files}
            wheels.ready[name] = f"{version} {_plain(min(made_for))}"
        elif _is_ready_elsewhere(name, version, python, resolve):
            wheels.missing[name] = version
        else:
            wheels.source[name] = version
    return wheels


def _plain(tag: str) -> str:
    tag = tag.removesuffix(".whl")
    return "any computer" if tag == "any" else tag.split(".")[0]


def _is_ready_elsewhere(name: str, version: str, python: str, resolve: Resolve) -> bool:
    try:
        resolve(
            [
                *("-", "--no-deps", "--only-binary", ":all:"),
                *("--python-platform", ELSEWHERE, "--python-version", python),
            ],
            f"{name}=={version}",
        )
    except Unresolved:
        return False
    return True


def table(found: Mapping[str, Wheels]) -> str:
    """A line for each package with what there is for each Python, those without a wheel first."""
    rows: dict[str, dict[str, str]] = {}
    for python, wheels in found.items():
        for kind, packages in (
            ("NONE ", wheels.missing),
            ("source ", wheels.source),
            ("", wheels.ready),
        ):
            for name, what in packages.items():
                rows.setdefault(name, {})[python] = f"{kind}{what}"

    def order(name: str) -> tuple[bool, bool, str]:
        cells = list(rows[name].values())
        return (
            not any(cell.startswith("NONE ") for cell in cells),
            not any(cell.startswith("source ") for cell in cells),
            name,
        )

    lines = [["package", *(f"Python {python}" for python in found)]]
    for name in sorted(rows, key=order):
        lines.append([name, *(rows[name].get(python, "-") for python in found)])
    widths = [max(len(line[column]) for line in lines) for column in range(len(lines[0]))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(line, widths, strict=True)).rstrip()
        for line in lines
    )


def by_uv(arguments: Sequence[str], given: str | None) -> str:
    done = subprocess.run(
        [sys.executable, "-m", "uv", "pip", "compile", "--quiet", "--no-header", *arguments],
        input=given,
        capture_output=True,
        text=True,
    )
    if done.returncode:
        raise Unresolved(" ".join(done.stderr.split()))
    return done.stdout


def main(arguments: Sequence[str] | None = None, resolve: Resolve = by_uv) -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n\n")[0])
    parser.add_argument("--platform", default=ARM, help=f"as uv calls it (default: {ARM})")
    parser.add_argument("--project", type=Path, default=ROOT / "pyproject.toml")
    options = parser.parse_args(arguments)
    try:
        found = {
            python: look_up(options.project, options.platform, python, resolve)
            for python in PYTHONS
        }
    except Unresolved as error:
        print(f"This cannot be resolved: {error}", file=sys.stderr)
        return 2
    print(table(found))
    missing = sorted({name for wheels in found.values() for name in wheels.missing})
    source = sorted({name for wheels in found.values() for name in wheels.source})
    if source:
        print(f"\nOnly source, for every computer: {', '.join(source)}.")
    if missing:
        print(f"\nNo wheel for {options.platform}: {', '.join(missing)}. Leave it out there.")
        return 1
    print(f"\nNothing has to be compiled for {options.platform}.")
    return 0


if __name__ == "__main__":
    sys.exit(main())
