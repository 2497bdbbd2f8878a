"""The hospital that the language tests speak of, and plans written in one line."""

from __future__ import annotations

import re
from typing import Any

from grammar.lexicon import Lexicon, Name, Question
from grammar.plan import (
    Ask,
    Both,
    Call,
    Choice,
    Collect,
    Compare,
    Either,
    Elapsed,
    End,
    Figure,
    ForEach,
    Forever,
    HasCome,
    Holds,
    If,
    Increase,
    Items,
    Length,
    Not,
    Number,
    Plan,
    Recall,
    Remember,
    Repeat,
    RepeatUntil,
    Sentence,
    Share,
    Text,
    Truth,
    Try,
    Weekday,
    While,
)
from robot_api.methods import METHODS

WARD = Lexicon(
    places=(
        Name("lobby", "hall", ("entrance hall",)),
        Name("reception", "desk", ("front desk",)),
        Name("entrance", "door", ("main entrance",)),
        Name("pharmacy", "room", ("drugstore",)),
        Name("radiology", "department", ("x-ray",)),
        Name("intensive care", "ward", ("ICU", "intensive care unit")),
        Name("children's ward", "ward"),
        Name("surgical ward", "ward"),
        Name("ward 3", "ward"),
        Name("Alice's office", "office"),
        Name("Bob's office", "office"),
        Name("supply room", "room", ("store room",)),
        Name("kitchen", "room"),
        Name("cafeteria", "room", ("canteen",)),
        Name("waiting room", "room", ("waiting area",)),
        Name("lift", "lift", ("elevator",)),
        Name("laundry", "room"),
        Name("room 12", "room"),
        Name("chemistry lab", "lab"),
        Name("robotics lab", "lab"),
        Name("charger", "charger", ("charging station",)),
    ),
    people=(
        Name("Alice", "nurse"),
        Name("Bob", "nurse"),
        Name("Carol", "visitor"),
        Name("Dr Weber", "doctor", ("Weber",)),
        Name("Mrs Miller", "patient"),
    ),
    objects=(
        Name("stapler", "tool"),
        Name("red cup", "cup"),
        Name("cup", "cup"),
        Name("water bottle", "bottle"),
        Name("bottle", "bottle"),
        Name("wheelchair"),
        Name("blanket"),
        Name("blood pressure monitor"),
        Name("medicine box", "box"),
    ),
    furniture=(Name("table"), Name("shelf"), Name("bed"), Name("desk")),
    contacts=("Dr Weber", "nurse station", "daughter"),
    joints=("head_yaw", "head_pitch", "left_shoulder", "right_shoulder"),
    skills=("sit",),
    questions=(
        Question("When are visiting hours?", "From two to eight in the afternoon."),
        Question("Where can I smoke?", "Only outside, in front of the entrance."),
    ),
)


def program(plan: Plan) -> str:
    """A plan in one line, for comparing: `goto("pharmacy"); repeat 3 { say("Hello.") }`."""
    return _steps(plan.steps)


def same(wanted: str, found: str) -> bool:
    """Whether a program is the wanted one; "..." stands for any words, capitals and full stops in
    texts do not count."""

    def normal(text: str) -> str:
        text = re.sub(r'"\{([^{}]*)\}"', r"\1", text)  # only a value
        return re.sub(r'[.!]"', '"', text).lower()

    pattern = re.escape(normal(wanted.replace("...", "\0"))).replace("\0", ".*")
    return re.fullmatch(pattern, normal(found)) is not None


def _steps(steps: tuple[Any, ...]) -> str:
    return "; ".join(_step(step) for step in steps)


def _step(step: Any) -> str:
    match step:
        case Call(method, arguments, save_as):
            call = _call(method, arguments)
            return f"{save_as} = {call}" if save_as else call
        case Remember(name, value):
            return f"{name} = {_value(value)}"
        case Collect(name, value):
            return f"{name} += {_value(value)}"
        case Increase(name, by):
            return f"{name} += {_value(by) if by else 1}"
        case If(condition, then, otherwise):
            text = f"if {_condition(condition)} {{ {_steps(then)} }}"
            return f"{text} else {{ {_steps(otherwise)} }}" if otherwise else text
        case Repeat(times, inner):
            return f"repeat {_value(times)} {{ {_steps(inner)} }}"
        case ForEach(variable, items, inner):
            return f"for {variable} in {_value(items)} {{ {_steps(inner)} }}"
        case While(condition, inner):
            return f"while {_condition(condition)} {{ {_steps(inner)} }}"
        case RepeatUntil(condition, inner):
            return f"until {_condition(condition)} {{ {_steps(inner)} }}"
        case Forever(inner):
            return f"forever {{ {_steps(inner)} }}"
        case Try(inner, otherwise):
            return f"try {{ {_steps(inner)} }} else {{ {_steps(otherwise)} }}"
        case End():
            return "end"
    raise AssertionError(step)


def _call(method: str, arguments: dict[str, Any]) -> str:
    form = METHODS[method].forms[-1 if "x" in arguments else 0]
    texts: list[str] = []
    positional = True
    for parameter in form:
        if parameter.name not in arguments:
            positional = False
            continue
        value = _value(arguments[parameter.name])
        texts.append(value if positional else f"{parameter.name}={value}")
    return f"{method}({', '.join(texts)})"


def _value(value: Any) -> str:
    match value:
        case Text(text):
            return '"' + text + '"'
        case Number(number):
            return f"{number:g}"
        case Truth(truth):
            return str(truth)
        case Recall(name):
            return name
        case Items(items):
            return f"[{', '.join(_value(item) for item in items)}]"
        case Ask(method, arguments, field):
            return _call(method, arguments) + (f".{field}" if field else "")
        case Sentence(parts):
            return '"' + "".join(_part(part) for part in parts) + '"'
        case Length(of):
            return f"len({_value(of)})"
        case Share(part, whole):
            return f"share({_value(part)}, {_value(whole)})"
        case Figure(how, of):
            return f"{how}_of({_value(of)})"
        case Elapsed(since):
            return f"minutes_since({_value(since)})"
        case HasCome(time, since):
            return f"has_come({_value(time)}, {_value(since)})"
        case Weekday(names):
            return f"weekday_called({', '.join(names)})"
        case Choice(among):
            return f"choice({_value(among)})"
    raise AssertionError(value)


def _part(part: Any) -> str:
    return part.value if isinstance(part, Text) else "{" + _value(part) + "}"


def _condition(condition: Any) -> str:
    match condition:
        case Holds(value):
            return _value(value)
        case Compare(left, operator, right):
            return f"{_value(left)} {operator} {_value(right)}"
        case Not(inner):
            return f"not {_condition(inner)}"
        case Both(conditions):
            return " and ".join(_condition(each) for each in conditions)
        case Either(conditions):
            return " or ".join(_condition(each) for each in conditions)
    raise AssertionError(condition)
