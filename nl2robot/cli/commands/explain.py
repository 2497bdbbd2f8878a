"""`nl2robot explain`: how a sentence is read, word by word, or what a program does, line by line;
never moves anything."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict
from typing import TYPE_CHECKING

import msgspec

from grammar.language import load_language
from grammar.trace import Read
from grammar.understand import understand
from grammar.understanding import Understanding
from nl2robot.cli.options.sentence import add_language, add_words
from nl2robot.cli.options.values import read_program
from nl2robot.cli.options.world import add_world, names_of
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from nl2robot.plain import visible
from nl2robot.review.review import review
from nl2robot.translate.outcome import Translation
from nl2robot.translate.routines import open_routines
from nl2robot.translate.translation import translate
from nl2robot.words import decimal, words_in
from robot_api.methods import METHODS

if TYPE_CHECKING:
    from rich.text import Text
    from rich.tree import Tree

STYLES = {"ok": "green", "clarify": "yellow", "rejected": "red"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add_words(parser, "the sentence, or the file of a program (program.py)")
    parser.add_argument(
        "--json",
        action="store_true",
        help='one JSON object: that of translate, with "parts" and "unclear"',
    )
    add_world(parser)
    add_language(parser)


def run(options: argparse.Namespace) -> int:
    knowledge = Knowledge(names_of(options), routines=open_routines())
    if _is_file(options.words):
        return _show_program(read_program(options.words), knowledge, options)
    understood = understand(options.words, knowledge.lexicon(options.lang), options.lang)
    translation = translate(options.words, knowledge, options.lang)
    if options.json:
        data = msgspec.to_builtins(translation)
        data["parts"] = [asdict(part) for part in understood.parts]
        data["unclear"] = understood.unclear
        print(json.dumps(data, ensure_ascii=False))
    else:
        _show(translation, understood, options.lang)
    return ExitStatus.OK if translation.status == "ok" else ExitStatus.NOT_UNDERSTOOD


def _is_file(words: str) -> bool:
    return words.endswith(".py") and not any(sign.isspace() for sign in words)


def _show_program(program: str, knowledge: Knowledge, options: argparse.Namespace) -> int:
    """What it does in plain words, and what is wrong with it; it is not tried."""
    made = review(program, knowledge, language=options.lang)
    if options.json:
        print(msgspec.json.encode(made).decode())
    else:
        Terminal(language=options.lang).show_review(made)
    return ExitStatus.OK if made.acceptable else ExitStatus.FAILED


def _show(translation: Translation, understood: Understanding, language: str) -> None:
    terminal = Terminal(language=language)
    console, plain, words = terminal.console, terminal.plain, terminal.words["explained"]
    if understood.utterance != translation.utterance:
        console.print(f"{plain(translation.utterance)}\n[dim]{words['in_other_words']}[/]")
    console.print(_marked(understood), end="\n\n")
    if understood.parts:
        console.print(_tree(understood, language), end="\n\n")
    style, verdict = STYLES[translation.status], words[translation.status]
    sure = f", {words['sure'].format(share=round(100 * translation.confidence))}"
    took = words["took"].format(time=decimal(round(translation.ms, 1), language))
    console.print(f"[{style}]{verdict}[/]{sure if translation.status == 'ok' else ''}, {took}")
    if translation.program is None:
        console.print(plain(translation.message or ""))
        for phrase in translation.suggestions:
            console.print(f"  [bold]{plain(phrase)}[/]")
        return
    console.print(f"[bold]{terminal.words['in_words']}[/] {plain(translation.explanation)}")
    terminal.show_program(translation.program)


def _marked(understood: Understanding) -> Text:
    """The sentence, with what stands for something and what was not understood marked."""
    from rich.text import Text

    marked = Text()
    text, at = understood.utterance, 0
    for start, end, style in sorted(_spans(understood)):
        if start >= at:
            marked.append(visible(text[at:start]))
            marked.append(visible(text[start:end]), style)
            at = end
    marked.append(visible(text[at:]))
    return marked


def _spans(understood: Understanding) -> list[tuple[int, int, str]]:
    spans = [
        (part.start, part.start + len(part.words), "bold cyan")
        for part in understood.parts
        if part.value is not None and part.words
    ]
    unclear = understood.unclear
    at = understood.utterance.rfind(unclear) if unclear else -1
    if at >= 0:
        mark = (at, at + len(unclear), f"bold {STYLES[understood.status]} underline")
        spans = [each for each in spans if each[1] <= at or each[0] >= mark[1]] + [mark]
    return spans


def _tree(understood: Understanding, language: str) -> Tree:
    """The parts of the sentence as a tree, without those that only hand on another."""
    from rich.text import Text
    from rich.tree import Tree

    words = words_in(language)["explained"]
    root = Tree(Text(words["read_as"], "dim"), guide_style="dim")
    branches = [(-1, root)]
    parts = understood.parts
    for number, part in enumerate(parts):
        while branches[-1][0] >= part.depth:
            branches.pop()
        if _hands_on(parts, number, language):
            continue
        line = Text()
        line.append(visible(part.words) or words["left_out"], "bold" if part.depth == 0 else "")
        line.append("  ")
        line.append(part.meaning.replace("_", " "), "magenta")
        if part.value is not None:
            line.append(": ")
            line.append(visible(part.value), "cyan")
        branches.append((part.depth, branches[-1][1].add(line)))
    return root


def _hands_on(parts: list[Read], number: int, language: str) -> bool:
    """Whether a part is only another one with an article or the like around it."""
    part = parts[number]
    children = []
    for other in parts[number + 1 :]:
        if other.depth <= part.depth:
            break
        if other.depth == part.depth + 1:
            children.append(other)
    if part.depth == 0 or part.meaning in METHODS or len(children) != 1:
        return False
    pack = load_language(language)
    around = set(pack.tokens_of(part.words)) - set(pack.tokens_of(children[0].words))
    return around <= pack.closed
