"""A station: one robot with its server and its runner, on one port.

`nl2robot serve` is a station that stays; `nl2robot run` opens one for itself when it is not given
the address of another.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext, suppress
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nl2robot.building.broker import PREFIX, BrokerAddress
from nl2robot.building.joining import House
from nl2robot.errors import ExitStatus, UserError
from nl2robot.fleet.address import FleetAddress
from nl2robot.fleet.joining import Fleet
from nl2robot.fleet.wire import EVENTS as FLEET_EVENTS
from nl2robot.fleet.wire import fleet_services
from nl2robot.knowledge import Knowledge
from nl2robot.proposals import proposals as proposing
from nl2robot.proposals.proposals import Proposals
from nl2robot.proposals.wire import proposal_services
from nl2robot.review.apart import think
from nl2robot.review.review import review, review_apart
from nl2robot.run import present
from nl2robot.run.runlog import LogError, RunLog
from nl2robot.run.runner import Runner
from nl2robot.run.state import GOING, Charging, Reviewing, State, on_wire
from nl2robot.schedule import service as schedule_service
from nl2robot.schedule.service import Timekeeper, Timing, schedule_of
from nl2robot.schedule.wire import schedule_services
from nl2robot.station.by_hand import BUSY, ByHand
from nl2robot.station.clients import client_of
from nl2robot.station.harmless import ONLY_LOOKS
from nl2robot.station.local_clock import now_in
from nl2robot.station.part import STOP, Backstage
from nl2robot.station.pictures import draw
from nl2robot.station.services import EVENTS, reviewer, services
from nl2robot.translate.routines import open_routines
from nl2robot.translate.talks import Talks
from nl2robot.voice.attention import Attention
from nl2robot.voice.services import Microphones
from nl2robot.work import here
from robot_api import limits
from robot_api.capabilities.sound import SILENT, Sound
from robot_api.client import Robot
from robot_api.composed import ComposedDriver
from robot_api.driver import Driver, Event, StopFlag
from robot_api.drivers import simulated
from robot_api.errors import NotPossible, RobotError
from robot_api.robots.opening import hold
from robot_api.robots.places import Places
from robot_api.robots.reading import Read
from robot_api.robots.wire import WireDriver
from robot_api.server import CannotListen, Server
from sim.record import Record
from sim.simulation import Simulation
from sim.world.model import World, Zone

if TYPE_CHECKING:
    from nl2robot.console.app import Console
    from nl2robot.speech.speak.wishes import SoundFor
    from nl2robot.station.entrance import Entrance

ANSWERS_WITHIN = 5.0
"""Seconds that a server has to say what it can do."""


class Station:
    """A robot server that also runs programs, here or elsewhere."""

    def __init__(self, address: str, token: str | None = None) -> None:
        self.address = address
        """ "host:port" for clients."""
        self.token = token

    def connect(self) -> Robot:
        """A new client of this station."""
        return Robot(self.address, token=self.token)

    def picture(self, run: int, file: Path) -> bool:
        """Draw a run into a file (.svg, .png, .webp, .gif); False if it was not simulated here."""
        return False


class SimulatedStation(Station):
    """A station on this machine whose robot is simulated: it knows what the runs looked like."""

    def __init__(self, server: Server, simulation: Simulation) -> None:
        super().__init__(server.address, server.token)
        self.server = server
        self.simulation = simulation
        self._spans: dict[int, tuple[float, float]] = {}

    def note(self, run: int, state: str) -> bool:
        """Remember at what simulated time a run began or ended; True if it has just begun."""
        now = self.simulation.time
        new = run not in self._spans
        began = now if new else self._spans[run][0]
        self._spans[run] = (began, math.inf if state in GOING else now)
        return new

    def record(self, run: int) -> Record:
        """The timeline of that run."""
        return self.simulation.record.between(*self._spans[run])

    def picture(self, run: int, file: Path) -> bool:
        draw(self.record(run), self.simulation.world, file)
        return True


@contextmanager
def simulated_station(
    world: World,
    log: RunLog,
    *,
    seed: int = 0,
    speed: float | None = None,
    host: str = "127.0.0.1",
    port: int = 0,
    token: str | None = None,
    entrance: Entrance | None = None,
    pictures: Path | None = None,
    sound: SoundFor | None = None,
    console: Callable[[Backstage], Console] | None = None,
    read: Read | None = None,
    start: datetime | None = None,
    timing: Timing | None = None,
    broker: BrokerAddress | None = None,
    fleet: FleetAddress | None = None,
) -> Iterator[SimulatedStation]:
    """Open a station with a simulated robot.

    `speed`: simulated seconds per second; None: as fast as the machine allows, whenever somebody
    waits for the robot. `pictures`: a folder in which a picture of every run is kept. `sound`: how
    it is heard (see `nl2robot.speech.speak.aloud`); without it, it is only written what is said.
    `console`: makes the web console, `nl2robot.console.app.Console`; once in a process. `read`: the
    robot file that it keeps to. `start`: what its clock shows at the beginning; None: as the
    world's file says, else a Monday morning at eight. `timing`: how it
    keeps time, if appointments are done here.
    """
    simulation = Simulation(world, seed=seed, speed=speed, start=start)
    heard = sound(lambda: simulation.time) if sound else SILENT
    driver = simulated(simulation, heard)
    if read is not None:
        hold(driver, read)

    def on_program(data: Mapping[str, Any]) -> None:
        if data["what"] != "state":
            return
        run, state = data["run"], data["state"]
        if station.note(run, state):
            driver.begin()
            _note_start(station, log, run)
        if pictures is not None and state not in GOING:
            _keep_picture(station, log, run, pictures / f"run-{run}.svg")

    with _open(
        driver,
        world,
        log,
        lambda world: simulation.copy(),
        on_program,
        give_way=heard.give_way,
        seed=seed,
        host=host,
        port=port,
        token=token,
        entrance=entrance,
        simulation=simulation,
        console=console,
        timing=timing,
        broker=broker,
        fleet=fleet,
    ) as server:
        station = SimulatedStation(server, simulation)
        yield station


def _note_start(station: SimulatedStation, log: RunLog, run: int) -> None:
    robot = station.simulation.robot
    with suppress(LogError):  # the first call will find the disk full, too, and stop the run
        log.starts_at(run, robot.x, robot.y, robot.theta, station.simulation.clock())


def _keep_picture(station: SimulatedStation, log: RunLog, run: int, file: Path) -> None:
    try:
        station.picture(run, file)
        log.picture(run, str(file))
    except (UserError, LogError):
        # A full disk: the run itself is over and logged, only its picture is missing.
        return


@contextmanager
def remote_station(
    address: str, world: World, log: RunLog, *, token: str | None = None
) -> Iterator[Station]:
    """The station at the address of a server. A robot server that runs no programs gets a runner
    here; dry runs then are simulated in `world`."""
    with client_of(address, token) as robot:
        methods = _methods_of(robot)
        if "program.run" in methods:
            yield Station(address, token)
            return
        if "robot.capabilities" not in methods:
            raise UserError(
                f"There is a server at {address}, but it is no robot's. Check the address.",
                ExitStatus.NO_ROBOT,
            )
    with robot_station(WireDriver(address, token), world, log) as (station, _):
        yield station


@contextmanager
def robot_station(
    driver: Driver,
    world: World,
    log: RunLog,
    *,
    zones: Callable[[], Sequence[Zone]] = tuple,
    places: Places | None = None,
    sound: Sound = SILENT,
    host: str = "127.0.0.1",
    port: int = 0,
    token: str | None = None,
    entrance: Entrance | None = None,
    console: Callable[[Backstage], Console] | None = None,
    timing: Timing | None = None,
    broker: BrokerAddress | None = None,
    fleet: FleetAddress | None = None,
) -> Iterator[tuple[Station, Server]]:
    """A station with a robot that is not simulated. Its places are those of `world`, in which dry
    runs are simulated, with the keep-out zones as they are then. `places` are what the driver is
    sent by: it is told there of what is named and drawn on the map. `sound` is what the driver
    speaks and hears with, if it does so on this machine."""

    def stage(world: World) -> Simulation:
        simulation = Simulation(world, start=now_in(world))
        simulation.limit_pace(**limits.pace(driver.capabilities()))
        drawn = tuple(zones())
        if drawn:
            simulation.set_zones(drawn)
        return simulation

    with _open(
        driver,
        world,
        log,
        stage,
        _at_each_beginning(driver),
        places=places,
        give_way=sound.give_way,
        host=host,
        port=port,
        token=token,
        entrance=entrance,
        console=console,
        timing=timing,
        broker=broker,
        fleet=fleet,
    ) as server:
        yield Station(server.address, server.token), server


def _at_each_beginning(driver: Driver) -> Callable[[Mapping[str, Any]], None]:
    """Tells the driver of each program that begins, if that is anything to it."""
    begun: set[int] = set()

    def on_program(data: Mapping[str, Any]) -> None:
        if data["what"] == "state" and data["run"] not in begun:
            begun.add(data["run"])
            if isinstance(driver, ComposedDriver):
                driver.begin()

    return on_program


def _methods_of(robot: Robot) -> set[str]:
    """What the server can do; nothing if it does not say so in time, as no robot's server might."""
    patience = threading.Timer(ANSWERS_WITHIN, robot.close)
    patience.daemon = True
    patience.start()
    try:
        return {method["name"] for method in robot.request("rpc.discover", {})["methods"]}
    except (RobotError, TypeError, KeyError):
        return set()
    finally:
        patience.cancel()


@contextmanager
def _open(
    driver: Driver,
    world: World,
    log: RunLog,
    stage: Callable[[World], Simulation],
    on_program: Callable[[Mapping[str, Any]], None],
    *,
    places: Places | None = None,
    give_way: Callable[[], None] = SILENT.give_way,
    seed: int | None = None,
    host: str = "127.0.0.1",
    port: int = 0,
    token: str | None = None,
    entrance: Entrance | None = None,
    simulation: Simulation | None = None,
    console: Callable[[Backstage], Console] | None = None,
    timing: Timing | None = None,
    broker: BrokerAddress | None = None,
    fleet: FleetAddress | None = None,
) -> Iterator[Server]:
    """A server with a runner on it. `on_program` is told of the runs' events before others are,
    `give_way` ends what the robot says when a client speaks to it."""

    def publish(kind: str, data: Mapping[str, Any], to: str | None = None) -> None:
        if kind == "program":
            on_program(data)
        if kind in ("program", "notice", proposing.KIND):
            backstage.tell(kind, data)
        server.publish(kind, data, to)

    def tell(state: State) -> None:
        runner.note_state(state)
        publish(present.KIND, on_wire(state))
        backstage.tell(present.KIND, on_wire(state))

    def connect() -> Robot:
        return Robot(server.address, token=server.own_token)

    runner = Runner(
        knowledge=Knowledge(world, driver.capabilities(), open_routines()),
        connect=connect,
        log=log,
        publish=publish,
        stage=(lambda: stage(runner.knowledge.world)) if world.has_geometry else None,
        seed=seed,
        present=present.Present(tell),
        # A console is there for several people, of whom one may want to stop meanwhile.
        think=think if console else here,
        review=review_apart if console else review,
    )

    schedule = schedule_of(runner, timing, broker.prefix if broker is not None else None)

    def ask(method: str, arguments: dict[str, Any]) -> Any:
        """What the robot sees or how it is, at no program's and nobody's behest."""
        return driver.call(method, arguments, StopFlag())

    def listen(topics: frozenset[str]) -> None:
        if house is not None:
            house.listen_to(topics)

    keeper = (
        Timekeeper(schedule, runner, timing, publish, ask, listen) if timing is not None else None
    )
    house: House | None = None
    hand = ByHand(log)

    def before_call(who: str | None, method: str, arguments: Mapping[str, Any]) -> None:
        """Only its program has a robot act while one runs: that was approved, this was not."""
        if runner.present.state.state in GOING and method not in ONLY_LOOKS:
            raise NotPossible(BUSY)
        hand.note(who, method, arguments)

    talks = Talks()
    proposals = Proposals(runner, publish)
    company = Fleet(fleet, runner, connect, schedule.trouble) if fleet else None
    if company is not None:
        schedule.company = company.keeping
    attention = Attention()
    microphones = Microphones(
        lambda: runner.knowledge, talks.of, give_way, publish, runner.think, schedule
    )
    backstage = Backstage(
        driver=driver,
        runner=runner,
        talks=talks,
        proposals=proposals,
        simulation=simulation,
        entrance=entrance,
        places=places,
        schedule=schedule,
        fleet=company,
        camera=driver.camera if isinstance(driver, ComposedDriver) else None,
        publish=publish,
        wanted=lambda kind: server.wanted(kind),
        stop=lambda because: server.stop(because),
    )

    def on_event(kind: str, data: Event) -> None:
        runner.present.on_event(kind, data)
        if kind == "pose":
            runner.note_pose(data)
        elif kind == "searched":
            runner.note_search(data)
        elif kind == "language":
            runner.note_language(data["code"])
        elif kind == STOP:
            runner.stop(str(data.get("because", "The robot was stopped.")))
            microphones.give_up()
        elif kind == "link":
            runner.note_link(data)
        if keeper is not None:
            keeper.note(kind, data)

    backstage.subscribe(on_event)
    if broker is not None:
        # Every simulated robot is called the same; the house may have several.
        alike = simulation is not None and broker.prefix != PREFIX
        name = broker.prefix.rpartition("/")[2] if alike else driver.capabilities().name

        def stands() -> Iterator[tuple[str, Mapping[str, Any]]]:
            with suppress(RobotError):
                charging = runner.present.state.charging
                yield "battery", {"percent": ask("battery", {}), "charging": charging}
            with suppress(RobotError):
                yield "pose", {"place": ask("location", {}).place}

        def said_in_house(topic: str, text: str) -> None:
            if keeper is not None:
                keeper.note("message", {"topic": topic, "text": text})

        house = House(broker, name, backstage, said_in_house, stands, schedule.trouble)
    if company is not None:
        company.watch(backstage)
    added = console(backstage) if console else None

    def on_left(connection: str) -> None:
        microphones.give_up(connection)
        runner.left(connection)
        runner.present.happened(Reviewing(reviewer(connection), False))
        attention.left(connection)
        if added:
            added.left(connection)

    server = Server(
        driver,
        host=host,
        port=port,
        token=token,
        services={
            **services(runner, talks, microphones, schedule),
            **schedule_services(schedule, keeper, runner.log),
            **proposal_services(proposals),
            **attention.services(),
            **(fleet_services(company, runner) if company else {}),
            **(added.services if added else {}),
        },
        events={
            **EVENTS,
            **present.EVENTS,
            **schedule_service.EVENTS,
            **proposing.EVENTS,
            **(FLEET_EVENTS if company else {}),
            **(added.events if added else {}),
        },
        remembered=(present.KIND,),
        pages=added.pages() if added else None,
        on_left=on_left,
        encryption=entrance.certificate.context if entrance and entrance.certificate else None,
        doors=added.doors if added else None,
        before_call=before_call,
    )
    if entrance:
        entrance.accounts.on_change(server.check_guests)
    unsubscribe = driver.subscribe(backstage.tell)
    if simulation is not None:
        runner.present.happened(Charging(simulation.robot.charging))
    try:
        with server:
            runner.present.begin()
            try:
                with house or nullcontext(), company or nullcontext(), keeper or nullcontext():
                    yield server
            finally:
                runner.close()
                schedule.close()
    except CannotListen as error:
        raise UserError(str(error)) from error
    finally:
        unsubscribe()
        if added:
            added.close()
        driver.close()
