"""A robot that has joined a fleet: the threads around `nl2robot.fleet.hub`."""

from __future__ import annotations

import hashlib
import logging
import queue
import threading
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import partial
from pathlib import Path
from typing import Any, Final, Protocol

import msgspec

from nl2robot import __version__
from nl2robot.errors import UserError
from nl2robot.fleet.address import FleetAddress
from nl2robot.fleet.book import FILE, Errand, FleetBook
from nl2robot.fleet.choosing import called
from nl2robot.fleet.drawing import Drawing
from nl2robot.fleet.hub import Deeds, Hub
from nl2robot.fleet.inbox import Inbox
from nl2robot.fleet.keeping import Keeping, check_for_all
from nl2robot.fleet.key import fingerprint, fleet_key
from nl2robot.fleet.messages import About, Order, Standing, Stop, Stopped
from nl2robot.fleet.network import Network
from nl2robot.fleet.own_robot import OwnRobot
from nl2robot.fleet.performing import Performer
from nl2robot.fleet.trouble import Trouble
from nl2robot.fleet.trust import Station
from nl2robot.run.runner import Runner
from nl2robot.schedule.clerk import Waits
from nl2robot.schedule.service import RESTS_AFTER_STOP, waits_for
from nl2robot.schedule.telling import trouble
from robot_api.client import Robot
from robot_api.errors import RobotError
from sim.world.model import World

TICKS: Final = 0.1
"""Seconds between two looks at what is to be said."""
LOOKS_EVERY: Final = 1.0
"""Seconds between two looks at whether the fleet is reached."""
TOLD_EVERY: Final = 0.2
"""Seconds between two events `fleet`."""
STOP: Final = "stop"
"""What is told once for each stop of the robot (`nl2robot.station.part.STOP`)."""
FORGETS_EVERY: Final = 3600.0
STOPS_KEPT: Final = 100
TWINS: Final = (
    "Another robot of the fleet is called “{name}”, too. Give one of them another name (--fleet);"
    " until then this one is told apart as {id}."
)
_log = logging.getLogger(__name__)


class Stage(Protocol):
    """What is needed of a station, `nl2robot.station.part.Backstage`."""

    @property
    def stop(self) -> Callable[[str], None]: ...

    @property
    def publish(self) -> Callable[..., None]: ...

    @property
    def wanted(self) -> Callable[[str], bool]: ...

    def subscribe(
        self, listener: Callable[[str, Mapping[str, Any]], None]
    ) -> Callable[[], None]: ...


def hash_of(world: World) -> str:
    """The same for robots that share a map: what its floor and walls are. People, things and what
    was named or drawn on it count for nothing."""
    floor = world.map
    about: list[Any] = [world.name, world.units, world.drawn_walls, world.doors, world.furniture]
    if floor is not None:
        about += [floor.resolution, floor.origin, floor.size]
        with suppress(OSError):
            about.append(hashlib.sha256(Path(floor.image).read_bytes()).hexdigest())
    return hashlib.sha256(msgspec.json.encode(about)).hexdigest()[:16]


class Fleet:
    """Belongs to a fleet while it is entered."""

    def __init__(
        self,
        address: FleetAddress,
        runner: Runner,
        connect: Callable[[], Robot],
        notice: Callable[[str], Mapping[str, Any]] = trouble,
    ) -> None:
        """`connect` opens a client to this robot's own station; `notice` makes an event `notice` of
        a sentence. Raises `UserError` without a key, or if the book cannot be used."""
        self.address = address
        self._runner = runner
        self._connect = connect
        self._notice = notice
        key = address.key or fleet_key()
        log = runner.log.path
        folder = Path(log).parent if str(log) != ":memory:" else None
        self.book = FleetBook(folder / FILE if folder is not None else ":memory:")
        self._stopped_before = self.book.last_stop()
        self._station = Station(folder)
        self._lock = threading.RLock()
        self._heard = Inbox()
        self._orders: queue.SimpleQueue[tuple[str, Order] | None] = queue.SimpleQueue()
        self._pose: Mapping[str, Any] = {}
        self._battery: float | None = None
        self._stage: Stage | None = None
        self._unsubscribe: Callable[[], None] | None = None
        self._stopping: dict[str, Stopped | None] = {}
        self._changed = threading.Condition(self._lock)
        self._told_at = float("-inf")
        self._forgot_at = float("-inf")
        self._twins: set[str] = set()
        self.network: Network
        self.hub = Hub(
            book=self.book,
            key=key,
            about=self._about(),
            standing=self._standing,
            where=self._where,
            send=lambda to, raw, *, urgent: self.network.send(to, raw, urgent=urgent),
            deeds=Deeds(
                ordered=lambda sender, order: self._orders.put((sender, order)),
                stopped=self._stop_for,
                zoned=lambda entries: self._drawing.put(entries),
                changed=lambda errand: self._changed.notify_all(),
                planned=self._planned,
            ),
            sign=lambda robot, order: self._station.signed(self.book.robot, robot, order),
        )
        self.keeping = Keeping(
            self.hub,
            self._lock,
            partial(check_for_all, runner),
            address.name,
            self.add,
            time.monotonic,
        )
        """For the appointments that are kept here."""
        self.network = Network(
            address,
            fingerprint(key),
            self.hub.me,
            self.hub.sealer.session,
            lambda raw, urgent: self._heard.put(
                lambda came: self.hub.hear(raw, came), urgent=urgent
            ),
            lambda robot, session: self._heard.put(lambda now: self.hub.gone(robot, session)),
            self._notify,
        )
        self.trouble = Trouble(address.connects, fingerprint(key))
        self._looked_at = float("-inf")
        self._drawing = Drawing(self.hub, self._lock)
        own_robot = OwnRobot(runner, self.book, self._station, self._waits)
        self._performer = Performer(self.book, self.hub.sealer.session, own_robot, time.monotonic)
        self._threads = [
            threading.Thread(target=target, name=f"fleet {name}", daemon=True)
            for name, target in (
                ("hub", self._listen),
                ("orders", self._perform),
                ("zones", self._share),
            )
        ]

    def watch(self, stage: Stage) -> None:
        """Belong to this station."""
        self._stage = stage
        self._unsubscribe = stage.subscribe(self._on_event)

    def __enter__(self) -> Fleet:
        self.network.open()
        for thread in self._threads:
            thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._heard.put(None)
        self._orders.put(None)
        self._drawing.put(None)
        self.network.close()
        for thread in self._threads:
            thread.join()
        if self._unsubscribe is not None:
            self._unsubscribe()
        self.book.close()

    @property
    def name(self) -> str:
        return self.address.name

    # --- for those who are at this station

    def members(self) -> list[dict[str, Any]]:
        """The robots of the fleet as this one has heard of them, this one first."""
        with self._lock:
            now = time.monotonic()
            self.hub.note_self(now)
            twins = {id for ids in self.hub.roll.twins().values() for id in ids}
            members = sorted(
                self.hub.roll.members.values(),
                key=lambda each: (each.id != self.hub.me, each.name, each.id),
            )
            return [
                {
                    "id": each.id,
                    "name": each.name,
                    "here": each.id == self.hub.me,
                    "known": each.known(now),
                    "heard": round(max(0.0, now - each.heard), 1),
                    "left": each.left,
                    "twin": each.id in twins,
                    "same_map": each.about is not None and each.about.map == self.hub.about.map,
                    "about": msgspec.to_builtins(each.about),
                    "standing": msgspec.to_builtins(each.standing),
                }
                for each in members
            ]

    def errands(self, last: int = 20) -> list[Errand]:
        return self.book.errands(last)

    def trouble_told(self) -> dict[str, str] | None:
        """Why the fleet is not reached, by language; None if nothing is known against it."""
        said = self.trouble.said
        return trouble(said)["told"] if said is not None else None

    def add(self, errand: Errand) -> Errand:
        """Have it done by the best robot. Raises `UserError` if too much is to be done already."""
        with self._lock:
            if self.hub.dispatcher.full:
                raise UserError(
                    "The fleet has a hundred things to do already. Wait until some are done."
                )
            self.hub.note_self(time.monotonic())
            return self.hub.dispatcher.add(errand, time.monotonic())

    def call_off(self, id: str) -> Errand | None:
        with self._lock:
            return self.hub.dispatcher.call_off(id)

    def one(self, name: str) -> str:
        """The id of the robot of that name or id. Raises `UserError`."""
        with self._lock:
            self.hub.note_self(time.monotonic())
            found = self.hub.roll.called(name)
        if not found:
            raise UserError(
                f"There is no robot “{name}” in the fleet. `nl2robot fleet` lists those there are."
            )
        if len(found) > 1:
            ids = ", ".join(sorted(each.id for each in found))
            raise UserError(
                f"Several robots are called “{name}” ({ids}). Name one by its id, and give one of"
                " them another name."
            )
        return found[0].id

    def fit(self, name: str, program: str) -> str:
        """The id of the robot of that name or id, if it could ever do this program. Raises
        `UserError`."""
        id = self.one(name)
        with self._lock:
            about, floor = self.hub.roll.members[id].about, self.hub.about.map
        if about is None:  # it has not said what it is
            return id
        if about.map != floor:
            raise UserError(
                f"{about.name} has another floor than this robot, so the program means nothing"
                " there. Choose another robot."
            )
        try:
            lacks = sorted(called(program) - set(about.methods))
        except (SyntaxError, ValueError, RecursionError):  # which its review says in words
            return id
        if lacks:
            raise UserError(
                f"{about.name} cannot do that: it lacks {', '.join(lacks)}. Choose another robot."
            )
        return id

    def wait(self, id: str, timeout: float, given_up: Callable[[], bool]) -> Errand:
        """Until an errand is over, or the time is up. Raises `UserError` if there is none."""
        ends = time.monotonic() + timeout
        with self._changed:
            while True:
                found = next((each for each in self.book.errands() if each.id == id), None)
                if found is None:
                    raise UserError(
                        f"The fleet knows nothing of {id} (any more)."
                        " `nl2robot fleet` lists what it has to do."
                    )
                left = ends - time.monotonic()
                if not found.open or left <= 0 or given_up():
                    return found
                self._changed.wait(min(left, 0.5))

    def stop(self, robots: list[str] | None, because: str) -> list[dict[str, Any]]:
        """Stop these, or all; what each says to that, within some seconds."""
        with self._lock:
            self.hub.note_self(time.monotonic())
            known = dict(self.hub.roll.members)
            told = [each for each in known if robots is None or each in robots]
            made = self.hub.stops.begin(told, because, time.monotonic(), everyone=robots is None)
        made.over.wait(10.0)
        with self._lock:
            results = dict(made.results)
        return [
            {
                "id": each,
                "name": known[each].name,
                "confirmed": each in results and results[each].confirmed,
                "answered": each in results,
                "because": results[each].because if each in results else "",
            }
            for each in told
        ]

    # --- inside

    def _about(self) -> About:
        knowledge = self._runner.knowledge
        has = knowledge.capabilities
        return About(
            name=self.address.name,
            kind=has.kind if has is not None else "",
            methods=has.methods if has is not None else (),
            world=knowledge.world.name,
            map=hash_of(knowledge.world),
            version=__version__,
        )

    def _standing(self) -> Standing:
        state, pose = self._runner.present.state, self._pose
        waits = self._waits()
        # Some time after a stop it is free again, though nothing has happened since.
        over = state.state == "stopped" and waits is None
        rests = "charging" if state.charging else "idle"
        known = all(isinstance(pose.get(each), int | float) for each in ("x", "y", "theta"))
        return Standing(
            state=rests if over else state.state,
            x=round(pose["x"], 2) if known else None,
            y=round(pose["y"], 2) if known else None,
            theta=round(pose["theta"], 0) if known else None,
            place=pose.get("place"),
            battery=round(self._battery) if self._battery is not None else None,
            charging=state.charging,
            run=state.run,
            because=None if over else state.because,
            driven_by=state.driven_by,
            waits=waits,
        )

    def _waits(self) -> Waits | None:
        """Why the robot begins nothing now; it rests after a stop though it was started anew."""
        now = time.time()
        waits = waits_for(self._runner.present.state, now, self._battery)
        return waits or ("stopped" if now - self._stopped_before < RESTS_AFTER_STOP else None)

    def _where(self, place: str) -> tuple[float, float] | None:
        found = self._runner.knowledge.world.place(place)
        return (found.pose.x, found.pose.y) if found is not None and found.pose else None

    def _planned(self) -> None:
        if self._stage is not None:
            self._stage.publish("fleet.plans", {})

    def _on_event(self, kind: str, data: Mapping[str, Any]) -> None:
        if kind == "pose":
            self._pose = data
        elif kind == STOP:
            self._heard.put(lambda came: self.book.note_stop(time.time()))
        elif kind == "battery" and isinstance(data.get("percent"), int | float):
            self._battery = float(data["percent"])

    def _listen(self) -> None:
        """All that the hub hears and says, in one thread."""
        ticked = float("-inf")
        while True:
            try:
                came, heard = self._heard.get(max(0.0, ticked + TICKS - time.monotonic()))
                if heard is None:
                    return
            except queue.Empty:
                came, heard = 0.0, None
            now = time.monotonic()
            try:
                with self._lock:
                    if heard is not None:
                        heard(came)
                    if now - ticked >= TICKS:
                        ticked = now
                        self.hub.tick(now)
                if now == ticked:
                    self._tell(now)
                    self._look_around(now)
                if now - self._forgot_at >= FORGETS_EVERY:
                    self._forgot_at = now
                    self.book.forget()
            except UserError as error:  # a full disk: what is not in the book is not done
                _log.warning("%s", error)
            except Exception:  # noqa: BLE001 - the others are still listened to
                _log.exception("the fleet is not looked after")

    def _tell(self, now: float) -> None:
        """Those who look on, and the people here where two robots have one name."""
        stage = self._stage
        if stage is None or now - self._told_at < TOLD_EVERY:
            return
        self._told_at = now
        with self._lock:
            twins = set(self.hub.roll.twins().get(self.name, ()))
        if twins - self._twins:
            self._notify(TWINS.format(name=self.name, id=self.hub.me))
        self._twins = twins
        if stage.wanted("fleet"):
            told = {
                "members": self.members(),
                "errands": msgspec.to_builtins(self.errands()),
                "trouble": self.trouble_told(),
            }
            stage.publish("fleet", told)

    def _look_around(self, now: float) -> None:
        """Whether the fleet is reached, told here where it is not."""
        if self._stage is None or now - self._looked_at < LOOKS_EVERY:
            return
        self._looked_at = now
        with self._lock:
            others = any(
                each.about is not None
                for each in self.hub.roll.members.values()
                if each.id != self.hub.me
            )
        network = self.network
        said = self.trouble.look(now, network.reached, others, network.strangers)
        if said is not None:
            self._notify(said)

    def _notify(self, sentence: str) -> None:
        """A notice on every page of the console."""
        _log.warning("%s", sentence)
        if self._stage is None:
            return
        self._stage.publish("notice", self._notice(sentence))

    def _perform(self) -> None:
        """Orders, one after the other: a review takes its time."""
        while True:
            given = self._orders.get()
            if given is None:
                return
            sender, order = given
            try:
                answer = self._performer.answer(sender, order)
            except UserError as error:
                _log.warning("%s", error)
                continue
            except Exception:  # noqa: BLE001 - the next order is answered
                _log.exception("an order is not answered")
                continue
            if answer is not None:
                with self._lock:
                    self.hub.say("answer", answer, sender)

    def _stop_for(self, sender: str, stop: Stop) -> None:
        """Once for each stop, however often it is said; each time it is answered how it stands."""
        if stop.stop in self._stopping:
            answer = self._stopping[stop.stop]
            if answer is not None:
                self.hub.say("stopped", answer, sender)
            return
        self._stopping[stop.stop] = None
        if stop.everyone:
            self.hub.dispatcher.call_off_all()
        while len(self._stopping) > STOPS_KEPT:
            del self._stopping[next(iter(self._stopping))]

        def work() -> None:
            assert self._stage is not None
            try:
                self._stage.stop(stop.because)
                answer = Stopped(stop.stop, True)
            except RobotError as error:
                answer = Stopped(stop.stop, False, str(error))
            with self._lock:
                self._stopping[stop.stop] = answer
                self.hub.say("stopped", answer, sender)

        threading.Thread(target=work, name="fleet stop", daemon=True).start()

    def _share(self) -> None:
        """Keep-out zones."""
        try:
            robot = self._connect()
        except RobotError:
            return
        with robot:
            self._ask_how_it_is(robot)
            self._drawing.keep(robot)

    def _ask_how_it_is(self, robot: Robot) -> None:
        """A robot that stands still since before we came has told nothing."""
        with suppress(RobotError):
            where = robot.location()
            pose = {"x": where.x, "y": where.y, "theta": where.theta, "place": where.place}
            self._pose = self._pose or pose
        with suppress(RobotError):
            percent = robot.battery()
            self._battery = self._battery if self._battery is not None else percent
