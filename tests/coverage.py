"""How much of each module tests run: `make coverage`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Final

ENOUGH: Final = 70
"""Percent, of lines and branches."""
EXPLAINED: Final[dict[str, str]] = {}
"""Modules of which less is run, each with the reason."""


def main() -> int:
    found = json.loads(Path(sys.argv[1]).read_text("utf-8"))
    shares = {name: file["summary"]["percent_covered"] for name, file in found["files"].items()}
    low = {name: share for name, share in shares.items() if share < ENOUGH}
    for name, share in sorted(low.items(), key=lambda each: each[1]):
        print(f"{share:4.0f} %  {name}: {EXPLAINED.get(name, 'nobody has said why')}")
    print(f"{found['totals']['percent_covered']:4.1f} %  of all {len(shares)} modules")
    past = EXPLAINED.keys() - low.keys()
    for name in sorted(past):
        print(f"{name} needs no reason any more.")
    return 1 if low.keys() - EXPLAINED.keys() or past else 0


if __name__ == "__main__":
    sys.exit(main())
