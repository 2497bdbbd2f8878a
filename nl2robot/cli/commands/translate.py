"""`nl2robot translate`: words in, a program out; never moves anything."""

from __future__ import annotations

import argparse
import sys
from functools import partial

from grammar.planning.planner import Watch
from nl2robot.cli.options.sentence import add_language, add_planner, add_words
from nl2robot.cli.options.world import add_world, names_of
from nl2robot.cli.waiting import thought_aloud
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from nl2robot.translate.other_language import hint, language_of
from nl2robot.translate.outcome import Translation
from nl2robot.translate.routines import open_routines
from nl2robot.translate.translation import translate


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_words(parser, "the sentence, or - to read one from each line of the input")
    parser.add_argument("--json", action="store_true", help="one JSON object per sentence")
    parser.epilog = (
        "The exit status is 0 if there is an answer to every sentence, and 3 if one was not"
        " understood or has to be asked about; with --json it is 0: the object has the status."
    )
    add_world(parser)
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    knowledge = Knowledge(names_of(options), routines=open_routines())
    lines = (
        (line.rstrip("\n") for line in sys.stdin) if options.words == "-" else iter([options.words])
    )
    status = ExitStatus.OK
    for line in lines:
        translation = thought_aloud(partial(_translated, line, knowledge, options), options.lang)
        print(
            translation.to_json() if options.json else translation.readable(options.lang),
            flush=True,
        )
        if translation.status != "ok" and not options.json:
            status = ExitStatus.NOT_UNDERSTOOD
            _show_other_language(line, options.lang)
    return status


def _show_other_language(line: str, language: str) -> None:
    code = language_of(line, language)
    if code is not None:
        print(hint(code, language), file=sys.stderr)


def _translated(
    line: str, knowledge: Knowledge, options: argparse.Namespace, watch: Watch
) -> Translation:
    return translate(line, knowledge, options.lang, options.planner, watch=watch)
