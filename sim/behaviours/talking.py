"""Speaking, and what people answer: in words, on the touchscreen, with something held up."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from sim.hospital import Hospital
from sim.people.crowd import Human
from sim.people.perception import in_view, person_in_view
from sim.physics.bodies import STEP
from sim.physics.placing import Item
from sim.physics.robot import bearing, wrap
from sim.runner import Behaviour
from sim.world.model import key
from sim.world.words import words

_LETTER = 0.06
"""Seconds that the robot speaks for each character."""
_LEAST = 0.5
_THINKS = 0.8
"""Seconds before somebody answers."""
_PRESSES = 1.5
_SCANS = 1.0
_HEARING = 6.0
"""Metres."""
_SCANNER = 1.5
_SCANNER_ANGLE = 60.0
"""The scanner reads so many metres far and so many degrees to either side."""
_GESTURE = 2.0


@dataclass(frozen=True)
class Reply:
    """What somebody says."""

    person: str
    words: str


def speak(hospital: Hospital, text: str, language: str | None) -> Behaviour[None]:
    """Say it; those who are near turn to the robot."""
    hospital.emit("speech", {"text": text, "language": language or hospital.robot.language})
    seconds = max(_LEAST, _LETTER * len(text))
    for human in _near(hospital):
        human.attend(hospital, seconds + 4.0)
    yield from hospital.wait(seconds)


def gesture(hospital: Hospital, name: str) -> Behaviour[None]:
    hospital.emit("gesture", {"name": name})
    yield from hospital.wait(_GESTURE)


def hear(
    hospital: Hospital,
    timeout: float,
    question: str | None,
    options: Sequence[str] | None,
    person: str | None,
) -> Behaviour[str | None]:
    """As `reply`; the words are heard as they are said."""
    said = yield from reply(hospital, timeout, question, options, person)
    if said is None:
        return None
    hospital.emit("heard", {"text": said.words, "person": said.person})
    return said.words


def reply(
    hospital: Hospital,
    timeout: float,
    question: str | None,
    options: Sequence[str] | None,
    person: str | None,
) -> Behaviour[Reply | None]:
    """The next answer of the person, of the one the robot deals with, or of the nearest. None if
    nobody is there, or they keep silent, for the whole of the timeout. Whether it was heard is
    for the robot to say."""
    end = hospital.time + timeout
    human = person_in_view(hospital, person) if person is not None else None
    while human is None:
        human = _listener(hospital)
        if human is None:
            if hospital.time >= end - STEP / 2:
                return None
            yield
    hospital.partner = human.name
    human.attend(hospital)
    answer = _answer(hospital, human, options)
    seconds = _THINKS + _LETTER * len(answer)
    if not answer or hospital.time + seconds > end:
        yield from hospital.wait(end - hospital.time)
        return None
    yield from hospital.wait(seconds)
    human.said = answer
    return Reply(human.name, answer)


def touch(hospital: Hospital, options: Sequence[str], timeout: float) -> Behaviour[str | None]:
    """Somebody near presses the option that they said, else the next of their answers that is
    one, else any."""
    end = hospital.time + timeout
    while (human := _listener(hospital)) is None:
        if hospital.time >= end - STEP / 2:
            return None
        yield
    hospital.partner = human.name
    human.attend(hospital)
    if timeout < _PRESSES:
        yield from hospital.wait(timeout)
        return None
    yield from hospital.wait(_PRESSES)
    pressed = _said_option(human, options)
    if pressed is None:
        remaining = human.person.answers[human.answered :]
        pressed = next((o for text in remaining[:1] if (o := _option(text, options))), None)
        if pressed is not None:
            human.answered += 1
        else:
            pressed = hospital.random.choice(list(options))
    human.said = pressed
    hospital.emit("heard", {"text": pressed, "person": human.name})
    return pressed


def scan(hospital: Hospital, timeout: float) -> Behaviour[str | None]:
    """The code of what the robot holds, of what somebody here holds up, or of what lies before
    it, whichever comes first."""
    end = hospital.time + timeout
    while (code := _code(hospital)) is None:
        if hospital.time >= end - STEP / 2:
            return None
        yield from hospital.wait(min(0.25, end - hospital.time))
    if hospital.time + _SCANS > end:
        yield from hospital.wait(end - hospital.time)
        return None
    yield from hospital.wait(_SCANS)
    return code


def _near(hospital: Hospital) -> list[Human]:
    """The people within hearing, the nearest first."""
    robot = hospital.robot.position
    return [
        sight
        for sight in in_view(hospital, "person")
        if isinstance(sight, Human) and sight.distance(robot) <= _HEARING
    ]


def _listener(hospital: Hospital) -> Human | None:
    near = _near(hospital)
    for human in near:
        if human.name == hospital.partner:
            return human
    return near[0] if near else None


def _answer(hospital: Hospital, human: Human, options: Sequence[str] | None) -> str:
    """The next of their answers; after the last, something sensible."""
    if human.answered < len(human.person.answers):
        answer = human.person.answers[human.answered]
        human.answered += 1
        return answer
    if options:
        return hospital.random.choice(list(options))
    return words().yes.get(hospital.robot.language[:2], words().yes["en"])


def _said_option(human: Human, options: Sequence[str]) -> str | None:
    return _option(human.said, options) if human.said else None


def _option(text: str, options: Sequence[str]) -> str | None:
    """The option that a text is, or that it speaks of."""
    said = key(text)
    for option in options:
        if key(option) == said:
            return option
    return next((option for option in options if f" {key(option)} " in f" {said} "), None)


def _code(hospital: Hospital) -> str | None:
    robot = hospital.robot
    held = [hospital.items[number] for number in robot.holding]
    for human in _near(hospital):
        held += [hospital.items[number] for number in human.holding]
    before = [
        (off, item.thing.code)
        for item in hospital.items
        if item.present and item.holder is None and (off := _off_scanner(hospital, item)) < math.inf
    ]
    codes = [item.thing.code for item in held] + [code for _, code in sorted(before, key=_first)]
    return next((code for code in codes if code), None)


def _off_scanner(hospital: Hospital, item: Item) -> float:
    """How far a thing is from lying right before the scanner; infinite if out of its reach."""
    robot, spot = hospital.robot, (item.x, item.y)
    away = math.dist(robot.position, spot) / _SCANNER
    aside = abs(wrap(bearing(robot.position, spot) - robot.theta)) / _SCANNER_ANGLE
    readable = max(away, aside) <= 1 and hospital.here(*spot)
    return aside + 0.3 * away if readable else math.inf


def _first(found: tuple[float, str | None]) -> float:
    return found[0]
