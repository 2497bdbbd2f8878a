"""`nl2robot test`: canned utterances, checked offline; the exit status is a test runner's."""

from __future__ import annotations

import argparse
import json
import textwrap
import time
from pathlib import Path

import msgspec

from nl2robot import canned
from nl2robot.errors import ExitStatus


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("files", nargs="+", metavar="FILE", help="YAML, or one sentence a line")
    parser.add_argument("--world", metavar="W", help="instead of the world that the file names")
    parser.add_argument("--json", action="store_true", help="one JSON object a sentence")


def run(options: argparse.Namespace) -> int:
    from sim.world import load_world

    world = load_world(options.world) if options.world else None
    began = time.perf_counter()
    passed = failed = 0
    for name in options.files:
        for result in canned.check(canned.load(Path(name)), world):
            passed, failed = passed + (not result.failures), failed + bool(result.failures)
            if options.json:
                print(json.dumps({"file": name, **msgspec.to_builtins(result)}))
            elif result.failures:
                print(f"{name}:{result.test.line}: {result.test.say}")
                for failure in result.failures:
                    print(textwrap.indent(failure, "  "))
    if not options.json:
        seconds = time.perf_counter() - began
        print(f"{passed} passed, {failed} failed in {seconds:.1f} s")
    return ExitStatus.FAILED if failed else ExitStatus.OK
