"""A bad day of a fleet: cables cut, silent, deaf one way, a network in two halves, robots killed in
mid-run, clocks apart, two of one name, and somebody without the key who plays all again.

    pytest --soak -s tests/fleet/test_soak.py        ten whole `nl2robot serve`; tells its figures

Without `--soak` it is a short day of three robots.
"""

from __future__ import annotations

import json
import os
import random
import threading
import time
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest
import zenoh

from nl2robot.fleet.messages import Order, packed
from nl2robot.fleet.network import BEFORE
from nl2robot.fleet.roll import UNKNOWN_AFTER
from nl2robot.fleet.sealing import Sealer
from nl2robot.fleet.trust import Station, trust
from nl2robot.review.review import digest
from robot_api.errors import RobotError
from tests.fleet.wards import NAMES, OPEN, Ward

UNAPPROVED = 'robot.say("Nobody approved this.")\n'


class Outsider:
    """Somebody in the network without the key: plays all again, changed, too, and makes it up."""

    def __init__(self, ports: Iterable[int], chance: random.Random) -> None:
        self._chance = chance
        self.heard: list[tuple[str, bytes]] = []
        self._hears = threading.Event()
        config = zenoh.Config()
        where = [f"tcp/127.0.0.1:{port}" for port in ports]
        for key, value in {**BEFORE, "mode": "peer", "connect/endpoints": where}.items():
            config.insert_json5(key, json.dumps(value))
        self._session = zenoh.open(config)
        self._ear = self._session.declare_subscriber("nl2robot/*/all/*", self._hear)
        self._more = self._session.declare_subscriber("nl2robot/*/to/*", self._hear)
        assert self._hears.wait(60.0)

    def _hear(self, sample: Any) -> None:
        self.heard.append((str(sample.key_expr), sample.payload.to_bytes()))
        self._hears.set()

    def talks(self, robots: list[str]) -> None:
        heard = list(self.heard)
        for where, raw in self._chance.sample(heard, min(200, len(heard))):
            changed = bytearray(raw)
            changed[self._chance.randrange(len(raw))] ^= 1
            for words in (raw, bytes(changed)):
                self._session.put(where, words)
        fleet = heard[0][0].split("/")[1]
        sealer = Sealer(b"a key that somebody has guessed wrong", self._chance.choice(robots))
        about = {"program": UNAPPROVED, "sha256": digest(UNAPPROVED), "by": "Nurse Kim"}
        for robot in robots:
            offer = f"{self._chance.getrandbits(64):016x}"
            for order in (Order(offer=offer, what="offer", **about), Order(offer=offer, what="go")):
                raw = sealer.seal("order", packed(order), robot)
                self._session.put(f"nl2robot/{fleet}/to/{robot}", raw)

    def close(self) -> None:
        self._session.close()  # type: ignore[no-untyped-call]


class Day:
    """What happens to a ward, and what is noted of it."""

    def __init__(self, ward: Ward, names: tuple[str, ...], chance: random.Random) -> None:
        self.ward, self.names, self.chance = ward, names, chance
        self.dead: set[str] = set()
        self.errands: list[tuple[str, str, str]] = []
        """At whose station, its id, its program."""
        self.happened: Counter[str] = Counter()
        self.ids: dict[str, str] = {}
        self.called = {name: name for name in names} | {names[-1]: names[-2]}
        self.stranger = names[1]
        """Whose station no other robot trusts."""
        self.unknown: list[float] = []
        self.stops: list[float] = []
        self.outsider: Outsider | None = None

    def begins(self) -> None:
        homes = {name: self.ward.folder / name for name in self.names}
        for name, home in homes.items():
            for each in set(self.names) - {name, self.stranger}:
                trust(home, each, Station(homes[each]).public)
            self._starts(name)
        for name in self.names:
            found = self.ward.until(name, self._all_known)
            self.ids[name] = next(each["id"] for each in found["members"] if each["here"])
            assert sum(each["twin"] for each in found["members"]) == 2

    def _starts(self, name: str) -> None:
        ahead = self.chance.choice((0.0, 60.0, 600.0)) * self.chance.choice((-1, 1))
        self.ward.starts(name, called=self.called[name], ahead=ahead)

    def _all_known(self, found: dict[str, Any]) -> bool:
        return sum(each["known"] for each in found["members"]) == len(self.names)

    @property
    def alive(self) -> list[str]:
        return [each for each in self.names if each not in self.dead]

    def is_given_something(self) -> None:
        at = self.chance.choice(self.alive)
        some = len(self.errands) % 4 == 3 and at != self.stranger
        wanted = {"robot": self.ids[self.chance.choice(self.names)]} if some else {}
        try:
            self._given(at, **wanted)
        except RobotError as error:  # one that has just begun has heard of nobody
            assert "There is no robot" in str(error), error

    def _given(self, at: str, lasts: int = 20, **wanted: str) -> str:
        place, number = self.chance.choice(("ward a", "ward b", "corridor")), len(self.errands)
        program = f'robot.goto("{place}")\nrobot.say("{number}")\nrobot.wait({lasts})\n'
        id = self.ward.run(at, program, **wanted)
        self.errands.append((at, id, program))
        return id

    def happens(self, what: str) -> None:
        self.happened[what] += 1
        match what:
            case "mended":
                for link in self.ward.links.values():
                    link.mend()
                for name in sorted(self.dead):
                    self._starts(name)
                self.dead.clear()
            case "cut" | "silent" | "deaf" | "dumb":
                whom = self.chance.choice(self.names)
                links = self.ward.links_of(whom)
                self._spoiled(what, self.chance.sample(links, self.chance.randint(1, len(links))))
            case "halves":
                half = set(self.names[: len(self.names) // 2])
                ends = self.ward.links.items()
                between = [link for (one, other), link in ends if (one in half) != (other in half)]
                self._spoiled(self.chance.choice(("cut", "silent")), between)
                self._say_what_they_do_not_know(half)
            case "killed" if len(self.alive) > 2:
                name = self._busy()
                if name is not None:
                    self.happened["killed in mid-run"] += 1
                name = name or self.chance.choice(self.alive)
                self.ward.killed(name)
                self.dead.add(name)
            case "alone":
                name = self._busy()
                if name is not None:
                    self._is_alone(name)

    def _spoiled(self, how: str, links: list[Any]) -> None:
        for link in links:
            match how:
                case "cut":
                    link.cut()
                case "silent":
                    link.silence()
                case "deaf":
                    link.silence("back")
                case "dumb":
                    link.silence("out")

    def _say_what_they_do_not_know(self, half: set[str]) -> None:
        """A console on one side of a cut knows of nobody on the other."""
        name = self.chance.choice(self.alive)
        others = {self.ids[each] for each in self.names if (each in half) != (name in half)}
        began = time.monotonic()
        self.ward.until(
            name, lambda found: not others & {m["id"] for m in found["members"] if m["known"]}
        )
        self.unknown.append(time.monotonic() - began)

    def _busy(self) -> str | None:
        """One that does something now, which was just given to the fleet."""
        at = self.chance.choice([each for each in self.alive if each != self.stranger])
        id = self._given(at, lasts=150)
        found, ends = {"state": "looking"}, time.monotonic() + 30.0
        while found["state"] in OPEN and time.monotonic() < ends:
            found = self.ward.ask(at, "wait", errand=id, timeout=0.3)
            if found["state"] == "begun":
                return next(name for name in self.alive if self.ids[name] == found["robot"])
        return None

    def _is_alone(self, name: str) -> None:
        """A robot loses all its cables in mid-run: it goes on by itself, or stands when somebody
        at its own station says so; the others say that they do not know how it stands."""
        self.happened["alone in mid-run"] += 1
        self._spoiled(self.chance.choice(("cut", "silent")), self.ward.links_of(name))
        began = time.monotonic()
        with self.ward.robot(name) as robot:
            run = robot.request("program.state", {})["run"]
            if self.chance.random() < 0.5:
                asked = time.monotonic()
                robot.stop()  # raises if it has not confirmed that it stands
                self.stops.append(time.monotonic() - asked)
            others = [each for each in self.alive if each != name]
            if others:
                other = self.chance.choice(others)
                self.ward.until(other, lambda found: not self._knows(found, name))
                self.unknown.append(time.monotonic() - began)
            if run is not None:
                robot.request("program.wait", {"run": run})

    def _knows(self, found: dict[str, Any], name: str) -> bool:
        return any(each["known"] for each in found["members"] if each["id"] == self.ids[name])

    def ends(self) -> list[dict[str, Any]]:
        """All is well again; how each errand ended."""
        self.happens("mended")
        for name in self.names:
            self.ward.until(name, self._all_known)
        return [self.ward.over(at, id) for at, id, _ in self.errands]

    def is_judged(self, ended: list[dict[str, Any]]) -> None:
        approved = {
            digest(program): f"Nurse Kim (fleet, from {self.called[at]})"
            for at, _, program in self.errands
        }
        begun: Counter[str] = Counter()
        of_the_stranger = {digest(each) for at, _, each in self.errands if at == self.stranger}
        where: dict[tuple[str, int], str] = {}
        for name, run in self.ward.runs():
            assert run.sha256 in approved, (name, run)  # nothing runs that nobody approved
            assert run.approved_by == approved[run.sha256]
            assert run.sha256 not in of_the_stranger or name == self.stranger, (name, run)
            begun[run.sha256] += 1
            where[self.ids[name], run.id] = run.sha256
        assert all(times == 1 for times in begun.values()), begun  # nothing is begun twice
        for each in ended:
            assert each["state"] not in OPEN, each
            assert begun[each["sha256"]] == (each["run"] is not None), each
            if each["run"] is not None:  # and what is told of it is what was done
                assert where[each["robot"], each["run"]] == each["sha256"], each
        assert any(each["state"] == "done" for each in ended)
        for name in self.names:
            said = self.ward.errors(name).read_text("utf-8", "replace")
            assert "Traceback" not in said, (name, said[-3000:])


@pytest.fixture
def day(tmp_path: Path, soak: bool) -> Iterator[Day]:
    seed = int(os.environ.get("FLEET_SEED", random.randrange(10**6) if soak else 7))
    print(f"seed {seed}")
    names = NAMES if soak else NAMES[:3]
    hubs = (names[0], names[len(names) // 2])
    ward = Ward(tmp_path, hubs, serves=soak, soon=300.0 if soak else 60.0)
    day = Day(ward, names, random.Random(seed))
    yield day
    if day.outsider is not None:
        day.outsider.close()
    ward.close()


SHORT = ("wait", "cut", "mended", "killed", "mended", "alone")
ALL = ("wait", "cut", "silent", "deaf", "dumb", "halves", "killed", "alone", "outsider", "mended")


@pytest.mark.timeout(3600)
def test_on_a_bad_day_nothing_is_done_twice_and_nothing_that_nobody_approved(
    day: Day, soak: bool
) -> None:
    began = time.monotonic()
    day.begins()
    up = time.monotonic()
    outsider = day.outsider = Outsider(day.ward.ports.values(), day.chance)
    for number in range(60 if soak else len(SHORT)):
        day.is_given_something()
        at, errand, _ = day.errands[-1]
        if at in day.alive:
            day.ward.ask(at, "wait", errand=errand, timeout=day.chance.uniform(0.0, 3.0))
        what = day.chance.choice(ALL) if soak else SHORT[number]
        if what == "outsider" or not soak:
            outsider.talks(list(day.ids.values()))
        day.happens(what)
    spoiled = time.monotonic()
    ended = day.ends()
    over = time.monotonic()
    day.is_judged(ended)
    assert day.happened["alone in mid-run"] > 0 and day.unknown
    assert day.happened["killed in mid-run"] > 0
    assert max(day.unknown) < 60.0 + UNKNOWN_AFTER
    print(
        f"up in {up - began:.0f} s, spoiled for {spoiled - up:.0f} s, all over"
        f" {over - spoiled:.0f} s later; {len(ended)} errands: "
        f"{dict(Counter(each['state'] for each in ended))}; {dict(day.happened)};"
        f" recorded {len(outsider.heard)} messages;"
        f" stops alone {[round(each, 2) for each in day.stops]} s;"
        f" not known after {[round(each, 1) for each in day.unknown]} s"
    )
