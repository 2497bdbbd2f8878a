"""How much of each module tests run: `make coverage`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Final

ENOUGH: Final = 70
"""Percent, of lines and branches."""
EXPLAINED: Final[dict[str, str]] = {
    "nl2robot/training/": "learns for hours, with libraries that only learning needs; what it made"
    " is tested instead",
    "nl2robot/bench/": "measures, for minutes each: make bench",
    "nl2robot/cli/commands/bench.py": "runs what measures",
    "nl2robot/deliberation/sufficing.py": "half of it is asked of drafts of a language model of"
    " 1.1 GB, which is fetched by make run alone",
    "nl2robot/speech/speak/voice_worker.py": "in a process that is killed when nobody needs it, so"
    " it counts no lines",
    "robot_api/conformance/killing.py": "in a process that is killed, so it counts no lines",
}
"""Modules, or folders of them (/), of which less is run, each with the reason."""


def main() -> int:
    found = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    shares = {name: file["summary"]["percent_covered"] for name, file in found["files"].items()}
    low = {name: share for name, share in shares.items() if share < ENOUGH}
    for name, share in sorted(low.items(), key=lambda each: each[1]):
        print(f"{share:4.0f} %  {name}: {EXPLAINED.get(named(name), 'nobody has said why')}")
    print(f"{found['totals']['percent_covered']:4.1f} %  of all {len(shares)} modules")
    known = {named(name) for name in low}
    past = EXPLAINED.keys() - known
    for name in sorted(past):
        print(f"{name} needs no reason any more.")
    return 1 if known - EXPLAINED.keys() or past else 0


def named(module: str) -> str:
    """How a module is explained: by itself, or by the folder that it is in."""
    return next((name for name in EXPLAINED if module.startswith(name)), module)


if __name__ == "__main__":
    sys.exit(main())
