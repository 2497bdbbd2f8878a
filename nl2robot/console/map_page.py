"""The page `/map`: the live floor map over the whole width."""

from __future__ import annotations

from nicegui import ui

from nl2robot.console.frame import frame
from nl2robot.console.part import Backstage


def pages(backstage: Backstage) -> None:
    """Register the page."""

    @ui.page("/map")
    def map_page() -> None:
        with frame(backstage, "map") as visit:
            visit.hand_over({})  # the map fetches its texts with the floor
            ui.add_head_html(
                '<link rel="stylesheet" href="/static/floor/floor.css">'
                '<script type="module" src="/static/floor/page.js"></script>'
            )
            ui.html('<div id="map"></div>', sanitize=False).classes("map-page")
