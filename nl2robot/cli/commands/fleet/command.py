"""The arguments of `nl2robot fleet`, and what each action does."""

from __future__ import annotations

import argparse
import json
from collections.abc import Mapping, Sequence
from typing import Any, Final

import msgspec

from nl2robot.cli.operator import Operator
from nl2robot.cli.options.robot import add_ca, trust
from nl2robot.cli.options.sentence import add_language, add_planner
from nl2robot.cli.options.values import read_program, user_name, words
from nl2robot.cli.terminal import Terminal
from nl2robot.ctrl_c import ctrl_c_later
from nl2robot.errors import ExitStatus, UserError
from nl2robot.fleet.book import Errand
from nl2robot.fleet.keeping import Kept
from nl2robot.fleet.key import fingerprint, fleet_key, make_key
from nl2robot.fleet.trust import Station, distrust, trusted
from nl2robot.fleet.trust import trust as trust_station
from nl2robot.fleet.wire import WAITS, Told
from nl2robot.paths import data_folder
from nl2robot.plain import visible
from nl2robot.schedule.rhythm import local
from nl2robot.station.clients import client_of
from robot_api.client import Robot
from robot_api.errors import InvalidCall
from robot_api.local_time import local_zone
from robot_api.server import DEFAULT_PORT

ENDS_WITHIN: Final = 25.0
"""Seconds that a robot has to say that what it did is over."""
ACTIONS: Final = ("list", "run", "call-off", "stop", "key", "trust", "distrust")
SHORT: Final = 6
"""Letters of an id by which an errand is told apart."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=ACTIONS, nargs="?", default="list")
    parser.add_argument(
        "words",
        nargs="?",
        type=words,
        metavar="WORDS|ID|ROBOT",
        help="run: what one of them should do (Ctrl-C calls it off, or stops the robot that does"
        " it); call-off: what no robot was told to begin yet, by its id in the list; stop: the only"
        " one to be stopped; trust, distrust: the name of a station",
    )
    parser.add_argument("--program", metavar="FILE", help="run: this program instead of words")
    parser.add_argument("--station", metavar="KEY", help="trust: the key of that station")
    parser.add_argument("--on", metavar="ROBOT", help="run: by this one, not by the best")
    parser.add_argument("--json", action="store_true", help="list, stop: as JSON")
    here = f"ws://127.0.0.1:{DEFAULT_PORT}"
    parser.add_argument(
        "--robot",
        default=here,
        metavar="ADDRESS",
        help=f"the server of any robot of the fleet (default: {here})",
    )
    add_ca(parser)
    parser.add_argument("--token", help="the token that the robot server printed at its start")
    add_language(parser)
    add_planner(parser)


def run(options: argparse.Namespace) -> int:
    terminal = Terminal(language=options.lang)
    if options.action == "key":
        return _key(terminal)
    if options.action in ("trust", "distrust"):
        return _trust(options, terminal)
    trust(options)
    with client_of(options.robot, options.token) as robot:
        check_fleet(robot, options.robot)
        if options.action == "run":
            return _run(options, terminal, Operator(robot, user_name()))
        if options.action == "call-off":
            return _call_off(options, terminal, robot)
        if options.action == "stop":
            return _stop(options, terminal, robot)
        _list(options, terminal, robot)
        return ExitStatus.OK


def check_fleet(robot: Robot, address: str) -> None:
    """Raises `UserError` if that robot has joined no fleet."""
    try:
        robot.request("fleet.list", {})
    except InvalidCall as error:  # it knows no such method
        raise UserError(
            f"The robot at {address} has joined no fleet. Serve it with --fleet NAME."
        ) from error


def _key(terminal: Terminal) -> int:
    file = make_key()
    told = terminal.words["fleet_key"].format(file=file, print=fingerprint(fleet_key()))
    terminal.console.print(told, soft_wrap=True, markup=False)
    return ExitStatus.OK


def _trust(options: argparse.Namespace, terminal: Terminal) -> int:
    folder, words = data_folder(), terminal.words
    name, key = options.words, options.station
    if options.action == "distrust":
        distrust(folder, name or "")
    elif name or key:
        trust_station(folder, name or "", key or "")
    show = terminal.console.print
    show(words["fleet_station"].format(key=Station(folder).public), soft_wrap=True, markup=False)
    known = trusted(folder)
    told = words["fleet_trusts_all" if known is None else "fleet_trusts"]
    show(told, soft_wrap=True, markup=False)
    for key, name in (known or {}).items():
        show(visible(f"{key} {name}"), soft_wrap=True, markup=False)
    return ExitStatus.OK


def _list(options: argparse.Namespace, terminal: Terminal, robot: Robot) -> None:
    found = robot.request("fleet.list", {})
    if options.json:
        plans = msgspec.to_builtins(_plans(robot, options.lang))
        print(json.dumps({**found, "plans": plans}, ensure_ascii=False))
        return
    words = terminal.words
    if found.get("trouble"):
        told = found["trouble"].get(options.lang) or found["trouble"]["en"]
        terminal.console.print(visible(told), markup=False, soft_wrap=True)
    table = terminal.table(*words["fleet"])
    for each in found["members"]:
        standing = each["standing"] or {}
        table.add_row(
            visible(_called(each)),
            _state(each, words),
            visible(standing.get("place") or "") if each["known"] else "",
            _percent(standing) if each["known"] else "",
            words["fleet_here"] if each["here"] else f"{each['heard']:.0f} s",
        )
    terminal.console.print(table, markup=False)
    errands = msgspec.convert(found["errands"], list[Errand])
    if errands:
        terminal.console.print()
        table = terminal.table(*words["errands"])
        for errand in errands:
            table.add_row(
                errand.id[:SHORT],
                visible(errand.sentence or errand.program.splitlines()[0]),
                _errand_state(errand, words),
                visible(errand.robot_name or ""),
                visible(errand.by),
            )
        terminal.console.print(table, markup=False)
    _list_plans(options, terminal, robot)


def _list_plans(options: argparse.Namespace, terminal: Terminal, robot: Robot) -> None:
    """The appointments that any robot of the fleet may do."""
    kept = _plans(robot, options.lang)
    if not kept:
        return
    words = terminal.words
    terminal.console.print()
    table = terminal.table(*words["fleet_plans"])
    for each in kept:
        plan = each.planned.plan
        states = words["appointment_states"]
        state = states["asked"] if plan.asked else states["paused"] if plan.paused else ""
        if each.planned.unknown is not None:
            told = words["fleet_plan_unknown"].format(
                robot=each.name, due=_when(each.planned.unknown)
            )
        else:
            told = each.planned.told
        table.add_row(
            visible(each.planned.when),
            state or (_when(each.planned.next[0]) if each.planned.next else ""),
            visible(plan.sentence),
            words["fleet_here"] if each.here else visible(each.name),
            visible(plan.approved_by),
            visible(told),
        )
    terminal.console.print(table, markup=False)


def _plans(robot: Robot, language: str) -> list[Kept]:
    return msgspec.convert(robot.request("fleet.plans", {"language": language}), list[Kept])


def _when(moment: float) -> str:
    return f"{local(moment, local_zone()):%Y-%m-%d %H:%M}"


def _call_off(options: argparse.Namespace, terminal: Terminal, robot: Robot) -> int:
    if not options.words:
        raise UserError("Say by its id what is to be called off; `nl2robot fleet` lists it.")
    errands = msgspec.convert(robot.request("fleet.list", {})["errands"], list[Errand])
    found = [each for each in errands if each.id.startswith(options.words)]
    if len(found) != 1:
        raise UserError(
            f"There is no single errand whose id begins with {options.words!r}. `nl2robot fleet`"
            " lists those there are, with their ids."
        )
    robot.request("fleet.call_off", {"errand": found[0].id})
    terminal.console.print(terminal.words["errand_states"]["called_off"], markup=False)
    return ExitStatus.OK


def _members(robot: Robot) -> list[dict[str, Any]]:
    return list(robot.request("fleet.list", {})["members"])


def _called(member: Mapping[str, Any]) -> str:
    """Two of one name are told apart."""
    return f"{member['name']} ({member['id']})" if member["twin"] else str(member["name"])


def _state(member: Mapping[str, Any], words: Mapping[str, Any]) -> str:
    if not member["known"]:
        return str(words["fleet_unknown"])
    state = member["standing"]["state"]
    return str(words["fleet_states"].get(state, state))


def _percent(standing: Mapping[str, Any]) -> str:
    battery = standing.get("battery")
    return f"{battery:.0f} %" if battery is not None else ""


def _errand_state(errand: Errand, words: Mapping[str, Any]) -> str:
    return str(words["errand_states"].get(errand.state, errand.state))


def _run(options: argparse.Namespace, terminal: Terminal, operator: Operator) -> int:
    words, show = terminal.words, terminal.console.print
    sentence = options.words or ""
    if options.program is not None and sentence:
        raise UserError(
            "Give either words or a --program: the words would stand in the log for another"
            " program."
        )
    if options.program is not None:
        program = read_program(options.program)
    elif sentence:
        translated = operator.translate(sentence, options.lang, options.planner)
        if translated.program is None:
            raise UserError(
                "That could not be turned into a program. `nl2robot explain` shows why.",
                ExitStatus.NOT_UNDERSTOOD,
            )
        program = translated.program
    else:
        raise UserError("Say what one of the robots should do, or give a --program.")
    if options.on:  # before anybody reads it
        operator.robot.request("fleet.fit", {"robot": options.on, "program": program})
    review = operator.check(program, options.lang)
    terminal.show_review(review)
    here = next(each for each in _members(operator.robot) if each["here"])
    if options.on not in (here["name"], here["id"]):
        show(visible(words["fleet_rehearsed"].format(robot=here["name"])), markup=False)
    if terminal.settle(review) != "approve":
        show(words["rejected"], markup=False)
        return ExitStatus.NOT_APPROVED
    given = {
        "program": program,
        "sha256": review.sha256,
        "by": operator.name,
        "sentence": sentence,
        "language": options.lang,
        **({"robot": options.on} if options.on else {}),
    }
    errand: Errand | None = None
    try:
        with ctrl_c_later():  # once it is given, it is known what is to be called off
            errand = msgspec.convert(operator.robot.request("fleet.run", given), Errand)
        errand, robot = _watched(operator, terminal, errand)
    except KeyboardInterrupt:
        if errand is not None:
            with ctrl_c_later():  # pressed again, it keeps no robot from being stopped
                show(visible(_called_back(operator, errand.id, words)), markup=False)
        raise
    if errand.robot_name is not None and robot is None:
        show(visible(words["fleet_given"].format(robot=errand.robot_name)), markup=False)
    for name, why in errand.refused.items():
        show(visible(f"{name}: {why}"), markup=False)
    told = _errand_state(errand, words)
    show(visible(f"{told}. {errand.message or ''}".strip()), markup=False)
    return ExitStatus.OK if errand.state == "done" else ExitStatus.FAILED


def _watched(operator: Operator, terminal: Terminal, errand: Errand) -> tuple[Errand, str | None]:
    """The errand when it is over, and the robot that was told of."""
    robot = None
    while errand.open:
        if errand.robot_name is not None and errand.robot_name != robot:
            robot = errand.robot_name
            told = terminal.words["fleet_given"].format(robot=robot)
            terminal.console.print(visible(told), markup=False)
        waits = {"errand": errand.id, "timeout": 1.0 if robot is None else WAITS}
        errand = msgspec.convert(operator.robot.request("fleet.wait", waits), Errand)
    return errand, robot


def _called_back(operator: Operator, errand: str, words: Mapping[str, Any]) -> str:
    """Whoever approved it does not want it any more: it is not begun, or the robot that does it is
    stopped; which of them, in words."""
    try:
        operator.robot.request("fleet.call_off", {"errand": errand})
    except InvalidCall:  # a robot was told to begin it, or it is over
        now = operator.robot.request("fleet.wait", {"errand": errand, "timeout": 0})
        found = msgspec.convert(now, Errand)
        if found.open and found.robot is not None:
            operator.robot.request("fleet.stop", {"robot": found.robot})
    now = operator.robot.request("fleet.wait", {"errand": errand, "timeout": ENDS_WITHIN})
    return _errand_state(msgspec.convert(now, Errand), words)


def _stop(options: argparse.Namespace, terminal: Terminal, robot: Robot) -> int:
    given = {"robot": options.words} if options.words else {}
    told = msgspec.convert(robot.request("fleet.stop", given), Sequence[Told])
    if options.json:
        print(json.dumps(msgspec.to_builtins(told), ensure_ascii=False))
    else:
        table = terminal.table(*terminal.words["fleet_stop"])
        for each in told:
            how = "stands" if each.confirmed else "moves" if each.answered else "silent"
            table.add_row(visible(each.name), terminal.words["fleet_stops"][how])
        terminal.console.print(table, markup=False)
    return ExitStatus.OK if all(each.confirmed for each in told) else ExitStatus.FAILED
