"""A console with three pages that fail: one while it is built, one while it looks something up, one
that is never ready. `python failing_console.py [what nl2robot serve takes]`.
"""

from __future__ import annotations

import sys
import threading

from starlette.requests import Request

from nl2robot.cli.main import main
from nl2robot.console import app
from nl2robot.station.part import Backstage, Part

SECRET = "of which nobody should read on a page"


def part(backstage: Backstage) -> Part:
    return Part(pages=lambda: _pages(backstage))


def _pages(backstage: Backstage) -> None:
    from nicegui import ui

    from nl2robot.console import slow_pages
    from nl2robot.console.frame import frame

    def fail() -> str:
        raise ZeroDivisionError(SECRET)

    @ui.page("/fails")
    def fails() -> None:
        with frame(backstage, "runs"):
            ui.label("half of it")
            fail()

    def show(html: str) -> None:
        with frame(backstage, "runs"):
            ui.html(html, sanitize=False)

    @slow_pages.page("/fails/{number:int}", show)
    def fails_later(request: Request, number: int) -> str:
        return fail()

    @slow_pages.page("/never", show, within=0.5)
    def never(request: Request) -> str:
        threading.Event().wait(5)
        return "late"


if __name__ == "__main__":
    sys.modules["nl2robot.console.failing"] = sys.modules["__main__"]
    app.PARTS += ("failing",)  # type: ignore[misc]
    sys.exit(main(["serve", *sys.argv[1:]]))
