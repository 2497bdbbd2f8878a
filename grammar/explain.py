"""From a plan to plain words that a nurse can agree with.

    "I will remember where I am. Then, three times, I will wait for a person, ask “...”, ..."

`explain_steps` gives a line for each step, indented as the steps are nested; `explain` makes
sentences of them. The words come from the language's data file (`grammar.speech`); the order of
things from here. Everything a step does and every text it uses is named, so that what is approved
is what is done.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from grammar import plan as p
from grammar.language import load_language, speech
from grammar.program_parser import read_program
from grammar.speech import Speech
from grammar.telling.layout import Told, listed, sentences
from grammar.telling.steps import Teller


def explain(
    plan: p.Plan,
    language: str = "en",
    called: Callable[[str], str] | None = None,
    *,
    deeds_only: bool = False,
) -> str:
    """The plan in sentences. `called` gives what a name of the plan is called in the language
    (`grammar.naming`); without it, names stand as the world spells them. With `deeds_only`, it is
    not told what the robot notes for itself at first: where it is, that it counts from 0."""
    words = speech(language)
    steps = tell(plan, words, called)
    told = words.joined_up(sentences(_deeds(steps) if deeds_only else steps, words))
    if not plan.background:
        return told
    said = "; ".join(plan.background)
    return f"{told} {load_language(language).phrase('background', said=said)}"


def explain_steps(
    plan: p.Plan,
    language: str = "en",
    called: Callable[[str], str] | None = None,
    *,
    deeds_only: bool = False,
) -> list[tuple[int, str]]:
    """The plan as a list of (depth, text), a line for each thing that is done; `deeds_only` as for
    `explain`."""
    words = speech(language)
    steps = tell(plan, words, called)
    lines = listed(_deeds(steps) if deeds_only else steps, words)
    return [(depth, words.joined_up(text)) for depth, text in lines]


def _deeds(told: tuple[Told, ...]) -> tuple[Told, ...]:
    """The steps without what a robot notes for itself first; if that is all, all of them."""
    return (*itertools.dropwhile(lambda each: _is_note(each.step), told),) or told


def _is_note(step: p.Step | None) -> bool:
    match step:
        case p.Call(method="location", save_as=str()):
            return True
        case p.Remember(value=p.Number(value=0) | p.Items(items=()) | p.Record(entries=())):
            return True
        case _:
            return False


@dataclass(frozen=True)
class LineTold:
    """A line of a program in words."""

    line: int
    depth: int
    text: str


def explain_program(
    source: str, language: str = "en", called: Callable[[str], str] | None = None
) -> list[LineTold]:
    """A program in words, line by line, also one that was written by hand; `called` as for
    `explain`. Raises `SyntaxError` if it is none."""
    reading = read_program(source, language)
    words = speech(language)
    begun: set[int] = set()

    def lines(told: Iterable[Told], depth: int, line: int) -> Iterator[LineTold]:
        for each in told:
            known = reading.lines
            if each.continues and id(each.step) in begun:
                known = reading.otherwise
            line = known.get(id(each.step), line)
            begun.add(id(each.step))
            text = words.joined_up(each.text)
            yield LineTold(line, depth, f"{text}:" if each.is_clause else text)
            yield from lines(each.steps, depth + 1, line)

    return list(lines(tell(reading.plan, words, called), 0, 1))


def tell(
    plan: p.Plan, words: Speech, called: Callable[[str], str] | None = None
) -> tuple[Told, ...]:
    """The steps of a plan in words."""
    return tuple(Teller(words, plan, called or str).told(plan.steps))


__all__ = ["LineTold", "explain", "explain_program", "explain_steps"]
