#!/usr/bin/env python3
"""Does a wheel do the main job by itself? `python -m docs.deploy.try_wheel dist/*.whl`

It is installed into an empty environment, with what locks/run.txt names, and used in an empty
folder with an empty home: a sentence is translated, run in the simulated hospital, and its picture
is there. Then all tutorials are followed, word by word.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

from tests.played import play

ROOT = Path(__file__).parents[2]
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
    return 0


if __name__ == "__main__":
    sys.exit(main())
