"""A sentence to the robot: its words, their language, and what turns them into a plan."""

from __future__ import annotations

import argparse
import functools

from grammar.language import languages, load_language
from grammar.naming import joined_up
from grammar.samples import samples
from nl2robot.cli.options.values import words
from nl2robot.cli.options.world import names_of
from nl2robot.knowledge import Knowledge
from nl2robot.translate.completing import completions, named_here
from nl2robot.translate.planners import AUTO, names
from nl2robot.translate.routines import open_routines


def add_words(parser: argparse.ArgumentParser, help: str, nargs: str | None = None) -> None:
    """A sentence to the robot."""
    parser.add_argument("words", nargs=nargs, type=words, help=help).completer = _sentences  # type: ignore[attr-defined]


def _sentences(prefix: str, parsed_args: argparse.Namespace, **_: object) -> list[str]:
    """For the completion by Tab in a shell: what can be said in the world named so far."""
    world, language = names_of(parsed_args), parsed_args.lang
    lexicon = Knowledge(world, routines=open_routines()).lexicon(language)
    said = (each for topic in samples(lexicon, language).values() for each in topic)
    joins = functools.partial(joined_up, language=load_language(language))
    return completions(prefix, said, named_here(world, language), joins)


def add_language(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "--lang",
        "--language",
        default="en",
        choices=languages(),
        help="the language of the words (default: en)",
    )


def add_planner(parser: argparse.ArgumentParser, default: str | None = None) -> None:
    parser.add_argument(
        "--planner",
        default=default or AUTO,
        choices=names(),
        help="what turns words into a plan: rules, a language model, or (auto) the rules for what"
        " they know and the model for the rest (default: %(default)s)",
    )
