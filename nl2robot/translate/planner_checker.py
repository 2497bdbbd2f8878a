"""Whether a planner keeps to what is promised (`grammar.planning.planner.Planner`).

    for trouble in check_planner(planner("mine"), knowledge):
        print(trouble)

How well it plans is for `nl2robot bench planner` and the errands of the tests to say.
"""

from __future__ import annotations

import contextlib
import io
import threading
import time
from collections.abc import Iterator
from typing import Final

from grammar.checking.checked import check
from grammar.language import languages, load_language
from grammar.planning.planner import (
    Answer,
    Drafts,
    Interrupted,
    Planner,
    Question,
    Refusal,
    Service,
    Watch,
)
from grammar.planning.turn import Turn
from grammar.program import write_program
from grammar.samples import samples
from grammar.understanding import Context
from nl2robot.knowledge import Knowledge
from robot_api.errors import cause

ANSWERS_WITHIN: Final = 60.0
"""Seconds: a language model on a slow machine takes half a minute."""
ENDS_WITHIN: Final = 2.0
"""Seconds from a cancellation to the end of the work."""
COMMON: Final = 3
"""Topics of the help of which it gets a sentence in each language."""
ODD: Final = ("?", "🙂 🙂", "asdf qwertz", "a\x00b", '"', "((((", "go " * 60, "ﷺ", "1/0", "return")
"""What people type by accident, and no planner may stumble over."""


def check_planner(planner: Planner, knowledge: Knowledge) -> list[str]:
    """A sentence for each thing that is wrong with a planner."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
        found = [trouble for turn in _turns(knowledge) for trouble in _of_turn(planner, turn)]
        found += _of_cancelling(planner, _turn(knowledge, "go to the kitchen", "en"))
    if not isinstance(getattr(planner, "name", None), str):
        found.append("It has no name.")
    if printed.getvalue():
        found.append(f"It prints: {printed.getvalue().splitlines()[0]!r}.")
    return found


def _turns(knowledge: Knowledge) -> Iterator[Turn]:
    for code in languages():
        topics = list(samples(knowledge.lexicon(code), code).values())
        for sentences in topics[:COMMON]:
            yield _turn(knowledge, sentences[0], code)
    for text in ODD:
        yield _turn(knowledge, text, "en")


def _turn(knowledge: Knowledge, text: str, code: str) -> Turn:
    return Turn(text, knowledge.lexicon(code), load_language(code), Context())


def _of_turn(planner: Planner, turn: Turn) -> Iterator[str]:
    said = f"“{turn.text[:40]}”"
    began = time.monotonic()
    try:
        answer = planner.plan(turn, Watch())
    except Exception as error:  # noqa: BLE001 - others' code may do anything
        yield f"It raises at {said} ({type(error).__name__}: {cause(error)})."
        return
    if (took := time.monotonic() - began) > ANSWERS_WITHIN:
        yield f"It takes {took:.0f} s for {said}; {ANSWERS_WITHIN:.0f} s are the most."
    yield from (f"At {said} {trouble}" for trouble in _of_answer(answer, turn))


def _of_answer(answer: Answer, turn: Turn) -> Iterator[str]:
    match answer:
        case Drafts(drafts):
            if not drafts:
                yield "there is no draft among its drafts."
            sure = [draft.probability for draft in drafts]
            if sure != sorted(sure, reverse=True) or not all(0 <= each <= 1 for each in sure):
                yield f"its drafts are not sorted by probability, from 1 to 0: {sure}."
            for draft in drafts:
                try:
                    write_program(draft.plan)
                    check(turn, draft.plan, exact=draft.exact)
                except Exception as error:  # noqa: BLE001 - a plan of others may hold anything
                    yield f"a draft is no whole plan ({type(error).__name__}: {cause(error)})."
        case Question(message) | Refusal(message):
            if not message.strip():
                yield "it says nothing to the person who spoke."
        case Service():
            pass
        case _:
            yield f"it answers {type(answer).__name__}, which is no answer of a planner."


def _of_cancelling(planner: Planner, turn: Turn) -> Iterator[str]:
    """Given up before it begins, and while it is at work."""
    for delay in (0.0, 0.05):
        watch = Watch()
        ended = threading.Event()
        thread = threading.Thread(target=_plan, args=(planner, turn, watch, ended), daemon=True)
        if not delay:
            watch.cancel()
        thread.start()
        ended.wait(delay)
        watch.cancel()
        if not ended.wait(ENDS_WITHIN):
            yield f"It goes on for more than {ENDS_WITHIN:g} s after it was cancelled."
            return


def _plan(planner: Planner, turn: Turn, watch: Watch, ended: threading.Event) -> None:
    with contextlib.suppress(Interrupted, Exception):  # what it raises is told at the sentences
        planner.plan(turn, watch)
    ended.set()
