"""The page for direct control, `/drive`: the joystick, what the robot says and shows, its log.

Its inside is JavaScript, under `static/drive`; what it does goes through `services`.
"""

from __future__ import annotations

from nl2robot.console.frame import frame
from nl2robot.station.part import Backstage, Part


def part(backstage: Backstage) -> Part:
    def pages() -> None:
        from nicegui import ui

        @ui.page("/drive")
        def drive() -> None:
            with frame(backstage, "drive") as visit:
                ui.add_head_html(
                    '<link rel="stylesheet" href="/static/drive/drive.css">'
                    '<script type="module" src="/static/drive/drive.js"></script>'
                )
                visit.hand_over({"words": dict(visit.words)})
                ui.html('<div id="drive"></div>', sanitize=False)

    return Part(pages=pages)
