"""The operator's page: talk, review, approve, watch.

What is said goes to the `Dialogue` of this browser; whatever changes there is drawn anew here. The
run and the map are drawn by the page's own scripts, from the wire, for operators and observers
alike (`static/desk/`).
"""

from __future__ import annotations

from nl2robot.console.desk.desk import Desk
from nl2robot.console.desk.dialogues import Dialogues
from nl2robot.console.desk.run_view import run_view
from nl2robot.console.floor import page as map_page
from nl2robot.console.frame import frame
from nl2robot.paths import data_folder
from nl2robot.station.part import Backstage, Part
from nl2robot.wire import service


def part(backstage: Backstage) -> Part:
    dialogues = Dialogues(backstage, data_folder() / "console" / "conversations")
    unsubscribe = backstage.subscribe(dialogues.on_event)

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
            "desk.run": service(
                lambda p: run_view(backstage, p.get("language", "en")),
                "Tell how the present or last run stands, with its program and calls.",
                {"language": {"type": "string", "pattern": "^[a-z]{2}$"}},
                observes=True,
            )
        },
        pages=pages,
        close=close,
    )
