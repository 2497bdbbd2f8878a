"""The operator's page: talk, review, approve, watch.

What is said goes to the `Dialogue` of this browser; whatever changes there is drawn anew here. The
run and the map are drawn by the page's own scripts, from the wire, for operators and observers
alike (`static/desk/`).
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from nl2robot.console.desk.desk import Desk
from nl2robot.console.desk.dialogues import Dialogues
from nl2robot.console.desk.outlook import Outcome, outlook
from nl2robot.console.desk.run_view import RunShown, run_view
from nl2robot.console.floor import page as map_page
from nl2robot.console.frame import frame
from nl2robot.console.visitor import texts
from nl2robot.paths import data_folder
from nl2robot.station.local_clock import moment_in
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import LANGUAGE, service
from sandbox.limits import MAX_PROGRAM


class DeskReview(Outcome):
    """A review as the desk tells it; `reading` is line, depth, text."""

    sha256: str
    acceptable: bool
    came_through: bool
    reading: list[tuple[int, int, str]]


def part(backstage: Backstage) -> Part:
    dialogues = Dialogues(backstage, data_folder() / "console" / "conversations")
    unsubscribe = backstage.subscribe(dialogues.on_event)

    def checked(p: Mapping[str, Any]) -> dict[str, Any]:
        program, language = p["program"], p.get("language", "en")
        words, knowledge = texts("desk", language), backstage.runner.knowledge
        at = moment_in(knowledge.world, p["at"]) if "at" in p else None
        review = backstage.runner.check(program, language, at=at)
        return {
            "sha256": review.sha256,
            "acceptable": review.acceptable,
            "came_through": review.came_through,
            "reading": [[each.line, each.depth, each.text] for each in review.reading],
            **outlook(review, words, language, knowledge).as_told(words),
        }

    def pages() -> None:
        from nicegui import ui

        @ui.page("/")
        def desk() -> None:
            with frame(backstage, "desk") as visit:
                Desk(backstage, dialogues, visit)

        map_page.pages(backstage, dialogues)

    def close() -> None:
        unsubscribe()
        dialogues.close()

    return Part(
        services={
            "desk.check": service(
                checked,
                "Review a program as `program.check` does, told as the desk tells it: the outcome,"
                " whether that is good, facts (a heading with its items), marks on the lines, and"
                " each line in plain words (line, depth, text). With `at`, as if it began then.",
                {
                    "program": {"type": "string", "maxLength": MAX_PROGRAM},
                    "language": LANGUAGE,
                    "at": {"type": "string", "maxLength": 40},
                },
                "program",
                result=DeskReview,
            ),
            "desk.run": service(
                lambda p: run_view(backstage, p.get("language", "en")),
                "Tell how the present or last run stands, with its program and calls.",
                {"language": LANGUAGE},
                observes=True,
                result=RunShown | None,
            ),
        },
        pages=pages,
        close=close,
    )
