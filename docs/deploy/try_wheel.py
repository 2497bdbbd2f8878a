#!/usr/bin/env python3
"""Does a wheel do the main job by itself? `python -m docs.deploy.try_wheel dist/*.whl`

It is installed into an empty environment, with what locks/run.txt names, and used in an empty
folder with an empty home: a sentence is translated, run in the simulated hospital, and its picture
is there. Then all tutorials are followed, word by word. At last the doors are tried without the
libraries that they need: each says in a sentence which to install.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from pathlib import Path

from tests.played import play

ROOT = Path(__file__).parents[2]
LIBRARIES = {"assistants": "mcp", "fleet": "eclipse-zenoh"}
"""What doors need that not everybody has, by the extra that installs it."""
SENTENCE = "go to the pharmacy and say good morning"


def main() -> int:
    wheel = Path(sys.argv[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        python = place / "venv" / "bin" / "python"
        subprocess.run([sys.executable, "-m", "venv", place / "venv"], check=True)
        pip = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
        subprocess.run([*pip, "--require-hashes", "-r", ROOT / "locks" / "build.txt"], check=True)
        subprocess.run(
            [*pip, "--require-hashes", "--no-build-isolation", "-r", ROOT / "locks" / "run.txt"],
            check=True,
        )
        subprocess.run([*pip, "--no-deps", wheel], check=True)
        work = place / "work"
        work.mkdir()
        kept = {name: value for name, value in os.environ.items() if name in ("PATH", "LANG")}
        alone = {**kept, "HOME": str(place), "NL2ROBOT_LANGUAGE_MODEL": "none"}

        def nl2robot(*words: str) -> str:
            command = [python.with_name("nl2robot"), *words]
            done = subprocess.run(
                command, cwd=work, env=alone, stdout=subprocess.PIPE, text=True, check=True
            )
            return done.stdout

        program = nl2robot("translate", SENTENCE)
        assert 'robot.goto("pharmacy")' in program, program
        said = nl2robot("run", "-y", SENTENCE, "--picture", "run.png")
        assert "Good morning" in said and (work / "run.png").stat().st_size > 10_000, said
        print(f"{wheel.name} does it alone: {nl2robot('--version').strip()}.")
        for page in sorted(ROOT.glob("docs/tutorials/*.md")):
            (place / page.stem).mkdir()
            count = play(page, place / page.stem, installed=python.parent)
            print(f"{page.stem}: followed, {count} commands.")
        subprocess.run(
            [python, "-m", "pip", "uninstall", "--quiet", "-y", *LIBRARIES.values()], check=True
        )
        try_without_libraries(python.with_name("nl2robot"), alone)
    return 0


def try_without_libraries(nl2robot: Path, environment: Mapping[str, str]) -> None:
    """The command is installed there without `LIBRARIES`."""
    subprocess.run([nl2robot, "fleet", "key"], env=environment, check=True, capture_output=True)
    for extra, words in {
        "assistants": ["mcp"],
        "fleet": ["serve", "--port", "0", "--fleet", "ward/robin"],
    }.items():
        done = subprocess.run(
            [nl2robot, *words], env=environment, capture_output=True, text=True, timeout=120
        )
        lines = done.stderr.strip().splitlines()
        assert done.returncode == 2, (words, done)
        assert f"pip install 'nl2robot[{extra}]'" in lines[-1], lines
        assert not any(line.startswith("Traceback") for line in lines), lines
        print(f"{' '.join(words)}: says without {LIBRARIES[extra]} what to install.")


if __name__ == "__main__":
    sys.exit(main())
