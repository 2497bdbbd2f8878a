"""What the console is put together from: parts, each with its services, events and pages.

A package adds one by an entry point of the group `nl2robot.pages` that names its
`part(backstage) -> Part`:

    [project.entry-points."nl2robot.pages"]
    visits = "ward_visits:part"

All that it adds is called as the entry point is: its services and events `visits.…`, its addresses
`/visits` and below. Everything of the console is a part like it (`nl2robot.console.app.PARTS`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from starlette.routing import BaseRoute

from nl2robot.run.stops import Stops
from robot_api.driver import Driver, Event
from robot_api.server import Publish, Service

if TYPE_CHECKING:
    from nl2robot.fleet.joining import Fleet
    from nl2robot.proposals.proposals import Proposals
    from nl2robot.run.runner import Runner
    from nl2robot.schedule.schedule import Schedule
    from nl2robot.station.entrance import Entrance
    from nl2robot.translate.talks import Talks
    from robot_api.capabilities.camera import Camera
    from robot_api.robots.places import Places
    from sim.simulation import Simulation

Listener = Callable[[str, Event], None]

STOP: Final = "stop"
"""What a part is told once for each stop, as soon as it begins, beside the robot's own events
`stopping`, `stopped` and `stop_not_confirmed`."""


@dataclass(frozen=True, kw_only=True)
class Link:
    """A page of somebody else's that the frame of every page leads to."""

    name: str
    """As `nl2robot.console.frame.frame` is told."""
    address: str
    """ "/visits"."""
    icon: str
    """The line of its icon, in a square of 24: "M4 12h16"."""
    texts: Path
    """Its texts, written as those of `console/texts/`: by name, then by language. "title" is what
    the link says."""


@dataclass(frozen=True)
class Backstage:
    """What a part may use of the station that it belongs to."""

    driver: Driver
    runner: Runner
    talks: Talks
    """The conversations, typed and spoken."""
    proposals: Proposals
    """Programs that assistants propose."""
    simulation: Simulation | None
    """None where the robot is a real one."""
    publish: Publish
    """`robot_api.server.Server.publish`."""
    wanted: Callable[[str], bool]
    """Whether somebody subscribed to this kind of event."""
    stop: Callable[[str], None]
    """Stop the robot and its program, saying why; returns when the robot has confirmed that it
    stands. Raises `StopNotConfirmed`."""
    entrance: Entrance | None = None
    """How others come in; None where nobody but this program does."""
    places: Places | None = None
    """What the driver of a real robot is sent by, if it is: told of places as people name them."""
    camera: Camera | None = None
    """The robot's, if people may look through it."""
    schedule: Schedule | None = None
    """The appointments, and the clock that they go by; None where there are none."""
    fleet: Fleet | None = None
    """The robot's fleet, if it has joined one."""
    links: list[Link] = field(default_factory=list)
    """To the pages that other packages add; complete before the first page is built."""
    _listeners: list[Listener] = field(default_factory=list)
    _stops: Stops = field(default_factory=Stops)

    def subscribe(self, listener: Listener) -> Callable[[], None]:
        """Be told of the robot's events, the runner's, and `STOP`, from any thread; returns what
        ends it."""
        self._listeners.append(listener)
        return lambda: self._listeners.remove(listener)

    def tell(self, kind: str, data: Event) -> None:
        """Tell those who subscribed here."""
        if self._stops.begins(kind):
            self.tell(STOP, data)
        for listener in tuple(self._listeners):
            listener(kind, data)


def _nothing() -> None:
    pass


def _nobody(name: str) -> None:
    pass


@dataclass(frozen=True)
class Part:
    """A part of the console."""

    services: Mapping[str, Service] = field(default_factory=dict)
    events: Mapping[str, str] = field(default_factory=dict)
    """The kinds of events that it publishes, each with what its data says."""
    routes: Sequence[BaseRoute] = ()
    """Plain pages and files of its own."""
    links: Sequence[Link] = ()
    """To its pages, if they are none of the console's own."""
    pages: Callable[[], None] = _nothing
    """Registers its NiceGUI pages."""
    left: Callable[[str], None] = _nobody
    """Told the name of each connection that is gone; in the server's loop, so it may not wait."""
    close: Callable[[], None] = _nothing
