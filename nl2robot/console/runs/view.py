"""The log of past runs as HTML, made at the server; see `templates/`."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Final

from starlette.requests import Request

from grammar.explain import LineTold, explain_program
from grammar.language import load_language
from grammar.naming import naming
from nl2robot.changes import changes
from nl2robot.console.desk.highlight import highlighted
from nl2robot.console.rendering import rendered
from nl2robot.console.runs.asked import Asked
from nl2robot.console.visitor import texts, visitor_of
from nl2robot.knowledge import Knowledge
from nl2robot.run.answers import answer
from nl2robot.run.archive import STATES, Page, state_of
from nl2robot.run.going_on import unfinished
from nl2robot.run.runlog import LoggedCall, Run, RunLog
from nl2robot.run.state import PAUSED
from nl2robot.run.trouble import call_trouble, told

CALLS_SHOWN: Final = 500
"""Of a run; the newest."""
LONGEST_RESULT: Final = 2000
"""Letters of a result or an argument."""

Words = Mapping[str, str]


@dataclass(frozen=True)
class Reader:
    """Whoever reads the log."""

    language: str
    words: Words
    """Of these pages, in that language."""
    knowledge: Knowledge

    def told(self, message: str | None) -> str:
        """How a run ended, as the log says it."""
        return told(None, message or "", self.language, self.knowledge.lexicon(self.language))


def reader_of(request: Request, knowledge: Knowledge) -> Reader:
    """Whoever asks for a page."""
    language = visitor_of(request).language
    return Reader(language, texts("runs", language), knowledge)


def list_page(asked: Asked, page: Page | None, trouble: str | None, reader: Reader) -> str:
    """The whole list page."""
    return rendered("runs.html", **_found(asked, page, trouble, reader), states=STATES)


def found(asked: Asked, page: Page | None, trouble: str | None, reader: Reader) -> str:
    """What was found; None and what is the trouble if it could not be looked for."""
    return rendered("runs_found.html", **_found(asked, page, trouble, reader))


def _found(asked: Asked, page: Page | None, trouble: str | None, reader: Reader) -> dict[str, Any]:
    words = reader.words
    about: dict[str, Any] = {
        "asked": asked,
        "page": page,
        "trouble": trouble,
        "words": words,
        "told": reader.told,
    }
    if page is not None:
        number = f"{page.found:,}".replace(",", words["thousands"])
        about |= {
            "number_found": words["found_one" if page.found == 1 else "found_many"].format(
                number=number
            ),
            "query": asked.query(),
            "newest": asked.before is not None,
            "older": asked.query(page.runs[-1].id) if page.more else None,
        }
    return about


def run_page(
    run: Run,
    log: RunLog,
    reader: Reader,
    role: str,
    neighbours: tuple[int | None, int | None],
) -> str:
    """The whole page of a run."""
    read = _read(run.program, reader)
    lines = [
        {
            "number": number,
            "code": code,
            "readings": [each for each in read if each.line == number],
        }
        for number, code in enumerate(highlighted(run.program), 1)
    ]
    about = _standing(run, log, reader)
    return rendered(
        "run.html",
        **about,
        lines=lines,
        changes=changes(run.proposed, run.program) if run.proposed is not None else (),
        role=role,
        goes_on=about["continued_by"] is None and unfinished(log, run.id) is not None,
        older=neighbours[0],
        newer=neighbours[1],
    )


def run_parts(run: Run, log: RunLog, reader: Reader) -> dict[str, Any]:
    """What changes of a run's page while it goes on: its parts by name, its state, its line."""
    about = _standing(run, log, reader)
    parts = {name: rendered(f"run_{name}.html", **about) for name in ("head", "watch", "calls")}
    return {**parts, "state": about["state"], "line": about["line"]}


def _standing(run: Run, log: RunLog, reader: Reader) -> dict[str, Any]:
    words = reader.words
    calls = log.calls(run.id)
    state = state_of(run.status, run.process)
    return {
        "run": run,
        "message": reader.told(run.message),
        "state": state,
        "line": calls[-1].line if calls and state == "running" else None,
        "title": run.utterance or run.heard or words["written"],
        "answers": [each.text for each in answer(log, reader.knowledge, run.id, reader.language)],
        "calls": [_call(call, run, reader) for call in calls[-CALLS_SHOWN:]],
        "left_out": max(0, len(calls) - CALLS_SHOWN),
        "printed": "".join(log.output(run.id)),
        "moved": log.movement(run.id) is not None,
        "pictured": run.picture is not None,
        "continued_by": log.continued_by(run.id),
        "words": words,
    }


def _call(call: LoggedCall, run: Run, reader: Reader) -> dict[str, Any]:
    given = {name: value for name, value in json.loads(call.arguments).items() if value is not None}
    written = ", ".join(f"{name}={value!r}" for name, value in given.items())
    [code] = highlighted(f"robot.{call.method}({written[:LONGEST_RESULT]})".replace("\n", " "))
    lexicon = reader.knowledge.lexicon(reader.language)
    trouble = call_trouble(call, reader.language, lexicon)
    result = trouble or ("" if call.result in (None, "null") else _shown(call.result or ""))
    return {
        "at": call.started - run.started,
        "line": call.line,
        "call": code,
        "result": result[:LONGEST_RESULT],
        "trouble": call.error is not None and not call.error.startswith(PAUSED),
        "seconds": call.seconds,
    }


def _shown(result: str) -> str:
    """A result as people write it: a text without quotation marks."""
    value = json.loads(result)
    return value if isinstance(value, str) else json.dumps(value, ensure_ascii=False)


def _read(program: str, reader: Reader) -> list[LineTold]:
    """The program in plain words; nothing of what is none in this version."""
    language = reader.language
    called = naming(reader.knowledge.lexicon(language), load_language(language)).called
    try:
        return explain_program(program, language, called)
    except (SyntaxError, ValueError, RecursionError):
        return []
