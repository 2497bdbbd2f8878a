"""`nl2robot listen`: recordings in, programs or answers out; never moves anything."""

from __future__ import annotations

import argparse

from nl2robot.commands.options import add_language, add_planner, add_world


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--wav", nargs="+", required=True, metavar="FILE", help="recordings (wav, flac, ogg, mp3)"
    )
    parser.add_argument(
        "--expect",
        metavar="WHAT",
        help='digits, yes-no, or options as "a,b,c": what is said is the answer to a question',
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a file")
    add_world(parser)
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    raise NotImplementedError
