"""The console as one application: its parts, its files, NiceGUI."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from starlette.requests import Request
from starlette.responses import Response
from starlette.staticfiles import StaticFiles

from nl2robot.console.door import Doors
from nl2robot.console.others import others
from nl2robot.console.plain import Caught, failed, missing
from nl2robot.paths import data_folder
from nl2robot.station.part import Backstage, Part
from robot_api.server import Service

if TYPE_CHECKING:
    from fastapi import FastAPI

STATIC: Final = Path(__file__).parent / "static"
PARTS: Final = (
    *("desk.page", "floor.scene", "floor.zones", "floor.places", "floor.goals"),
    *("floor.localising", "drive.services", "face.codes", "face.camera", "drive.page"),
    *("face.page", "runs.page", "routines.page", "schedule.page", "fleet.page", "door", "devices"),
)
"""The modules of our parts; each has `part(backstage) -> Part`."""


async def _missing(request: Request, error: Exception) -> Response:
    return missing(request)


async def _failed(request: Request, error: Exception) -> Response:
    return failed(request)


class _Files(StaticFiles):
    """Files that a browser asks after each time, so that a new version is seen at once."""

    def file_response(self, *arguments: Any, **more: Any) -> Any:
        response = super().file_response(*arguments, **more)
        response.headers["Cache-Control"] = "no-cache"
        return response


class Console:
    """All that the console adds to a server."""

    def __init__(self, backstage: Backstage) -> None:
        self.parts: list[Part] = [
            import_module(f"nl2robot.console.{name}").part(backstage) for name in PARTS
        ]
        self.others = others(backstage, self.parts)
        self.parts += self.others.parts.values()
        backstage.links.extend(link for part in self.parts for link in part.links)
        self.doors = Doors(backstage.entrance) if backstage.entrance else None
        self.services: dict[str, Service] = {}
        self.events: dict[str, str] = {}
        for part in self.parts:
            self.services |= part.services
            self.events |= part.events

    def pages(self) -> FastAPI:
        """The application with its pages; once in a process, for NiceGUI has but one."""
        # NiceGUI makes this folder where it is started, unless it is told of another.
        os.environ.setdefault("NICEGUI_STORAGE_PATH", str(data_folder() / "console"))
        from fastapi import FastAPI
        from nicegui import app as nicegui_app
        from nicegui import ui

        app = FastAPI(openapi_url=None, docs_url=None, redoc_url=None)
        app.add_middleware(Caught)
        for each in (app, nicegui_app):
            each.add_exception_handler(404, _missing)
            each.add_exception_handler(Exception, _failed)
        app.mount("/static", _Files(directory=STATIC))
        for part in self.parts:
            app.router.routes.extend(part.routes)
            part.pages()
        # Tailwind would write styles in the browser, at each change of a page; ours are written.
        ui.run_with(
            app, title="nl2robot", show_welcome_message=False, reconnect_timeout=10, tailwind=False
        )
        return app

    def left(self, name: str) -> None:
        """A connection is gone."""
        for part in self.parts:
            part.left(name)

    def close(self) -> None:
        for part in self.parts:
            part.close()
