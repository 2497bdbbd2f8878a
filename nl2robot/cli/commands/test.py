"""`nl2robot test`: canned utterances, checked offline; the exit status is a test runner's."""

from __future__ import annotations

import argparse
import json
import textwrap
import time
from pathlib import Path

import msgspec

from nl2robot.checks import baseline, canned
from nl2robot.errors import ExitStatus
from sim.world.loading import load_world


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", metavar="FILE", help="YAML, or one sentence a line")
    parser.add_argument("--world", metavar="W", help="instead of the world that the file names")
    parser.add_argument("--json", action="store_true", help="one JSON object a sentence")
    parser.add_argument(
        "--baseline",
        type=Path,
        metavar="JSON",
        help="tell what changed since this was written; it is written if it is not there",
    )
    parser.add_argument("--update", action="store_true", help="write the baseline anew")


def run(options: argparse.Namespace) -> int:
    world = load_world(options.world) if options.world else None
    before = None
    if options.baseline is not None and options.baseline.exists():
        before = baseline.read(options.baseline)
    began = time.perf_counter()
    results: list[tuple[str, canned.Result]] = []
    for name in options.files:
        for result in canned.check(canned.load(Path(name)), world):
            results.append((name, result))
            if options.json:
                print(json.dumps({"file": name, **msgspec.to_builtins(result)}))
            elif result.failures:
                print(f"{name}:{result.test.line}: {result.test.say}")
                for failure in result.failures:
                    print(textwrap.indent(failure, "  "))
    failed = sum(bool(result.failures) for _, result in results)
    now = baseline.kept(results)
    if not options.json:
        changed = list(baseline.changes(before, now)) if before is not None else []
        for change in changed:
            print(change)
        seconds = time.perf_counter() - began
        since = f", {len(changed)} changed" if before is not None else ""
        print(f"{len(results) - failed} passed, {failed} failed{since} in {seconds:.1f} s")
    if options.baseline is not None and (before is None or options.update):
        baseline.write(options.baseline, now)
    return ExitStatus.FAILED if failed else ExitStatus.OK
