"""`nl2robot phrases`: what can be said here, by topic."""

from __future__ import annotations

import argparse
import json

from grammar.samples import samples
from nl2robot.cli.options.sentence import add_language
from nl2robot.cli.options.values import words
from nl2robot.cli.options.world import add_world, names_of
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.routines import open_routines
from nl2robot.translate.teaching import topic_of
from nl2robot.words import words_in


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("topic", nargs="?", type=words, help="only what is about this")
    parser.add_argument("--json", action="store_true", help="one JSON object: phrases by topic")
    add_world(parser)
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    knowledge = Knowledge(names_of(options), routines=open_routines())
    topics = samples(knowledge.lexicon(options.lang), options.lang)
    if options.topic:
        found = topic_of(options.topic, list(topics))
        if found is None:
            told = words_in(options.lang)["no_topic"]
            raise UserError(told.format(topic=options.topic, topics=", ".join(topics)))
        topics = {found: topics[found]}
    if options.json:
        print(json.dumps(topics, ensure_ascii=False))
    else:
        Terminal().show_phrases(topics)
    return ExitStatus.OK
