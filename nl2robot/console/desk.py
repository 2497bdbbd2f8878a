"""The operator's page."""

from __future__ import annotations

from nl2robot.console.part import Backstage, Part


def part(backstage: Backstage) -> Part:
    def pages() -> None:
        from nicegui import ui

        from nl2robot.console.frame import frame

        @ui.page("/")
        def desk() -> None:
            with frame(backstage, "desk") as visit:
                ui.label(visit.words["title"])

    return Part(pages=pages)
