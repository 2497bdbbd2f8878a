"""The arguments of `nl2robot schedule`, and what each action does."""

from __future__ import annotations

import argparse
import json
import time
from collections.abc import Sequence
from datetime import datetime
from typing import Any, Final

import msgspec

from nl2robot.cli.commands.fleet.command import check_fleet
from nl2robot.cli.commands.run import open_session
from nl2robot.cli.commands.schedule.books import Distant, book_of
from nl2robot.cli.commands.schedule.record import show_reminders
from nl2robot.cli.commands.schedule.times import DAYS, day_of, end_of, rhythm_of_options
from nl2robot.cli.operator import Wish
from nl2robot.cli.options.robot import add_robot, robot_of
from nl2robot.cli.options.sentence import add_language, add_planner
from nl2robot.cli.options.values import read_program, whole, words
from nl2robot.cli.session import Session, wished
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus, UserError
from nl2robot.plain import visible
from nl2robot.review.review import Review
from nl2robot.schedule.appointments import MAKES_UP_AT_MOST, PRIORITIES
from nl2robot.schedule.rhythm import local, next_begin
from nl2robot.schedule.schedule import Came, Listed, Schedule, Told
from nl2robot.schedule.triggers import WRITTEN, written
from nl2robot.schedule.words import in_words
from nl2robot.station.robots import Chosen
from robot_api.local_time import local_zone

ACTIONS: Final = (
    *(
        "list",
        "add",
        "approve",
        "pause",
        "resume",
        "remove",
        "skip",
        "history",
        "notices",
        "reminders",
    ),
)
OF_ONE: Final = ("approve", "pause", "resume", "remove", "skip")
EXAMPLE: Final = 'nl2robot schedule add "every weekday at eight" "go to the lobby"'


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("action", choices=ACTIONS, nargs="?", default="list")
    parser.add_argument(
        "first",
        nargs="?",
        type=words,
        metavar="WHEN|NUMBER",
        help='add: at what times, such as "every weekday at eight"; else an appointment\'s number',
    )
    parser.add_argument(
        "second", nargs="?", type=words, metavar="WORDS", help="add: what the robot should do"
    )
    times = parser.add_argument_group("at what times, instead of in words")
    times.add_argument("--at", metavar="TIME", help='"08:00", or once "2026-12-24 08:00"')
    times.add_argument(
        "--every",
        metavar="RHYTHM",
        help=f"{', '.join(DAYS)}, monday,thursday ..., 30m or 2h",
    )
    times.add_argument(
        "--until", metavar="DATE", help="the last day on which it is done (default: 30 days)"
    )
    times.add_argument(
        "--when", metavar="EVENT", help=f"when something happens: {WRITTEN}".replace("%", "%%")
    )
    adding = parser.add_argument_group("to add one")
    adding.add_argument("--program", metavar="FILE", help="this program instead of words")
    adding.add_argument(
        "--priority",
        type=whole(*PRIORITIES),
        metavar="N",
        help=f"{PRIORITIES[0]} to {PRIORITIES[1]}: of those that wait the highest begins first"
        " (default: 5)",
    )
    adding.add_argument(
        "--make-up",
        type=whole(0, MAKES_UP_AT_MOST),
        metavar="MINUTES",
        help="within how many minutes it is still done if the server was not running (default: 0)",
    )
    adding.add_argument(
        "--fleet",
        action="store_true",
        help="by any robot of the fleet, the best one then; --robot names the server that keeps it",
    )
    adding.add_argument("-y", "--yes", action="store_true", help="approve without being asked")
    parser.add_argument("--on", metavar="DATE", help="skip: this day, instead of what comes next")
    parser.add_argument("--back", action="store_true", help="skip: have that day done after all")
    parser.add_argument(
        "--last", type=whole(1, 1000), default=20, metavar="N", help="how many (default: 20)"
    )
    record = parser.add_argument_group("reminders")
    record.add_argument("--since", metavar="DATE", help="from this day on, all of them")
    record.add_argument(
        "--csv", metavar="FILE", help="write them into this file for a spreadsheet; - prints them"
    )
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    add_robot(parser)
    add_language(parser)
    add_planner(parser)
    parser.set_defaults(speak=False, voices=False, mic=False, robot_voice=None, ask_always=True)


def run(options: argparse.Namespace) -> int:
    robot = robot_of(options)
    if options.action == "add":
        return _add(options, robot)
    number = _number(options)
    if options.action == "approve":
        assert number is not None
        return _approve(options, robot, number)
    with book_of(options, robot) as book:
        terminal = Terminal(language=options.lang)
        match options.action:
            case "list":
                _show(terminal, book.listed(options.lang), options.json)
            case "history":
                _show_history(terminal, book.history(number, options.last, options.lang), options)
            case "notices":
                _show_notices(terminal, book.notices(0, options.last, options.lang), options)
            case "reminders":
                show_reminders(terminal, book, options)
            case "skip":
                assert number is not None
                _skip(terminal, book, number, options)
            case action:
                assert number is not None
                _change(terminal, book, action, number)
    return ExitStatus.OK


# --- adding and approving ------------------------------------------------------------------------


def _add(options: argparse.Namespace, robot: Chosen) -> int:
    by_options = any((options.at, options.every, options.when))
    said = [each for each in (options.first, options.second) if each]
    if by_options and len(said) == 2:
        raise UserError("Say at what times in words or by --at, --every or --when, not both.")
    if options.when is not None and (options.at is not None or options.every is not None):
        raise UserError("Say by --at and --every at what times, or by --when at what event.")
    if options.program is not None and not by_options:
        raise UserError("Say by --at, --every or --when at what times the program is to be done.")
    if not said and options.program is None:
        raise UserError(f"Write it so: {EXAMPLE}.")
    program = read_program(options.program) if options.program is not None else None
    now = datetime.now()
    with open_session(options, robot, approve_all=options.yes) as (session, _):
        if options.fleet:  # before anybody reads it
            check_fleet(session.operator.robot, options.robot)
        if not by_options:
            return _in_words(session, " ".join(said), options)
        wish = Wish(
            **_times(session, options, now),
            sentence=" ".join(said) or str(options.program),
            more=_more(options),
        )
        if program is not None:
            return session.perform_program(program, wish=wish)
        translation = session.understand(wish.sentence)
        if translation.program is None:
            session.terminal.show_refusal(translation)
            return ExitStatus.NOT_UNDERSTOOD
        return session.make_appointment(wish, translation)


def _times(session: Session, options: argparse.Namespace, now: datetime) -> dict[str, Any]:
    """At what times, or at what event, as the options say; and in words. What the robot would never
    notice is refused here, before anybody reviews anything."""
    if options.when is not None:
        trigger, when = session.operator.happens(written(options.when), options.lang)
        return {"trigger": trigger, "when": when}
    rhythm = rhythm_of_options(options.at, options.every, options.until, local_zone(), now)
    return {"rhythm": rhythm, "when": in_words(rhythm, options.lang)}


def _in_words(session: Session, sentence: str, options: argparse.Namespace) -> int:
    translation = session.understand(sentence)
    planned = translation.schedule
    if planned is None:
        if translation.program is not None:
            raise UserError(f"That says no times and no event. Write it so: {EXAMPLE}.")
        session.terminal.show_refusal(translation)
        return ExitStatus.NOT_UNDERSTOOD
    wish = msgspec.structs.replace(wished(planned), more=_more(options))
    return session.make_appointment(wish, planned.translation)


def _more(options: argparse.Namespace) -> dict[str, Any]:
    until = end_of(options.until, local_zone()) if options.until is not None else None
    fleet = True if options.fleet else None  # which older servers do not know
    more = {"until": until, "priority": options.priority, "makes_up": options.make_up}
    return {**more, "fleet": fleet}


def _approve(options: argparse.Namespace, robot: Chosen, number: int) -> int:
    """Show an appointment's program and its review as it is now, and ask."""
    with open_session(options, robot, approve_all=options.yes) as (session, _):
        operator, terminal = session.operator, session.terminal
        known = {each.appointment.id: each for each in operator.appointments(options.lang)}
        if number not in known:
            raise UserError(
                f"There is no appointment {number}. `nl2robot schedule` lists those there are."
            )
        kept = known[number].appointment
        review = operator.check(kept.program, options.lang, at=next_begin(kept.rhythm, time.time()))
        terminal.show_when(known[number].when)
        terminal.show_review(review)
        if not (review.acceptable and _agreed(terminal, review, options)):
            terminal.console.print(terminal.words["rejected"])
            return ExitStatus.NOT_APPROVED
        operator.approve_anew(kept, _more(options)["until"], insists=not review.came_through)
        shown = {each.appointment.id: each for each in operator.appointments(options.lang)}
        terminal.show_appointment(shown[number])
    return ExitStatus.OK


def _agreed(terminal: Terminal, review: Review, options: argparse.Namespace) -> bool:
    return bool(options.yes) or terminal.settle(review) == "approve"


# --- what is in the book --------------------------------------------------------------------------


def _number(options: argparse.Namespace) -> int | None:
    """Of the appointment that is meant. Raises `UserError`."""
    if options.second is not None or (options.action == "list" and options.first):
        raise UserError(f"Write it so: nl2robot schedule {options.action}, or {EXAMPLE}.")
    if options.first is None:
        if options.action in OF_ONE:
            raise UserError(f"Say which one by its number: nl2robot schedule {options.action} 3.")
        return None
    if not options.first.isdecimal() or len(options.first) > 18:
        raise UserError(
            f"{options.first!r} is no number. Write nl2robot schedule {options.action} 3."
        )
    return int(options.first)


def _change(terminal: Terminal, book: Schedule | Distant, action: str, number: int) -> None:
    if action == "remove":
        book.remove(number)
    else:
        book.pause(number, action == "pause")
    told = terminal.words["appointment_changed"][action].format(number=number)
    terminal.console.print(told, markup=False)


def _skip(
    terminal: Terminal, book: Schedule | Distant, number: int, options: argparse.Namespace
) -> None:
    day = day_of(options.on) if options.on is not None else None
    if options.back:
        if day is None:
            raise UserError("Say by --on which day is to be done after all.")
        moments = book.call_back(number, day)
    else:
        moments = book.skip(number, day)
    told = terminal.words["appointment_changed"]["back" if options.back else "skip"]
    shown = ", ".join(map(_when, moments))
    terminal.console.print(told.format(number=number, times=shown), markup=False)


# --- showing -------------------------------------------------------------------------------------


def _show(terminal: Terminal, listed: Sequence[Listed], as_json: bool) -> None:
    if as_json:
        _print(listed)
        return
    if not listed:
        terminal.console.print(
            terminal.words["no_appointments"].format(example=EXAMPLE), markup=False
        )
        return
    table = terminal.table(*terminal.words["appointments"])
    for each in listed:
        kept = each.appointment
        table.add_row(
            str(kept.id),
            visible(each.when),
            _next(terminal, each),
            visible(kept.sentence),
            visible(kept.approved_by),
            terminal.words["any_robot"] if kept.fleet is not None else visible(kept.robot),
        )
    terminal.console.print(table, markup=False)


def _next(terminal: Terminal, listed: Listed) -> str:
    states = terminal.words["appointment_states"]
    if listed.appointment.asked is not None:
        return str(states["asked"])
    if listed.appointment.paused:
        return str(states["paused"])
    return _when(listed.next[0]) if listed.next else ""


def _show_history(terminal: Terminal, came: Sequence[Came], options: argparse.Namespace) -> None:
    if options.json:
        _print(came)
        return
    if not came:
        terminal.console.print(terminal.words["no_history"], markup=False)
        return
    table = terminal.table(*terminal.words["history"])
    for each in reversed(came):
        about = each.occurrence
        run = "" if about.run is None else str(about.run)
        sentence = visible(each.sentence)
        table.add_row(_when(about.due), str(about.appointment), sentence, visible(each.told), run)
    terminal.console.print(table, markup=False)


def _show_notices(terminal: Terminal, notices: Sequence[Told], options: argparse.Namespace) -> None:
    if options.json:
        _print(notices)
        return
    if not notices:
        terminal.console.print(terminal.words["no_notices"], markup=False)
    for each in notices:
        line = f"{_when(each.notice.time)}  {each.told}"
        terminal.console.print(visible(line), markup=False, soft_wrap=True)


def _print(found: Sequence[msgspec.Struct]) -> None:
    for each in found:
        print(json.dumps(msgspec.to_builtins(each), ensure_ascii=False))


def _when(moment: float) -> str:
    return f"{local(moment, local_zone()):%Y-%m-%d %H:%M}"
