"""A plan: what a sentence means, as typed data, before it becomes a program.

A plan is a list of steps over the robot methods of `robot_api.methods`, with conditions, loops and
remembered values; it is the language-independent middle of the project. `grammar.program` writes
it as Python, `grammar.program_parser` reads it back, `grammar.explain` puts it into plain words,
`grammar.normal` gives the one form of all plans that say the same, `grammar.schema` the JSON
Schema. Every node is a tagged `msgspec.Struct`, so `to_data` and `from_data` round-trip through
JSON.

Richer commands ("bring the stapler from the supply room to Alice") are not nodes of their own: they
are spelled out as the calls they consist of, so that what is explained is what is done.
"""

from __future__ import annotations

from typing import Annotated, Any, Final, Literal

import msgspec


class Node(
    msgspec.Struct, frozen=True, tag_field="is", omit_defaults=True, forbid_unknown_fields=True
):
    """Base of everything in a plan."""


# --- values --------------------------------------------------------------------------------------


class Text(Node, frozen=True, tag="text"):
    """A fixed text, or a name the world knows, in the world's own spelling."""

    value: str


class Number(Node, frozen=True, tag="number"):
    """A number in the unit of the parameter it is for (metres, degrees, seconds, percent)."""

    value: int | float


class Truth(Node, frozen=True, tag="truth"):
    value: bool


class Recall(Node, frozen=True, tag="recall"):
    """The value a former step saved under this name, or the variable of a loop around."""

    name: str


class Items(Node, frozen=True, tag="items"):
    """A list."""

    items: tuple[Value, ...]


class Ask(Node, frozen=True, tag="ask"):
    """The result of a robot method: `robot.count("person")`. `field` picks a part of the result,
    such as the time of the clock."""

    method: str
    arguments: dict[str, Value] = {}
    field: str | None = None


PLACE: Final = Ask("location", field="place")
"""The name of the place where the robot is, as a text: its coordinates where there is none."""


class Sentence(Node, frozen=True, tag="sentence"):
    """Words put together from fixed texts and values: an f-string."""

    parts: tuple[Value, ...]


class Record(Node, frozen=True, tag="record"):
    """Values by keys, such as a number for each person: a dict."""

    entries: tuple[tuple[Value, Value], ...] = ()
    """Keys with their values, in order."""


class Range(Node, frozen=True, tag="range"):
    """The whole numbers from `start` on that are less than `stop`."""

    stop: Value
    start: Value = Number(0)


class Length(Node, frozen=True, tag="length"):
    """How many items a list has, or entries a record."""

    of: Value


class Item(Node, frozen=True, tag="item"):
    """The item of a list at a position (0 is the first, -1 the last), or what a record has for a
    key; `default` if it has nothing for it."""

    of: Value
    at: Value
    default: Value | None = None


class ListOf(Node, frozen=True, tag="list of"):
    """A list of its own: of the items of a list or a range, or the keys of a record."""

    of: Value


class Values(Node, frozen=True, tag="values"):
    """The values of a record, as a list."""

    of: Value


class KeyOf(Node, frozen=True, tag="key of"):
    """The key that has the smallest or largest value of a record, the first of several; an empty
    text if there is none."""

    function: Literal["min", "max"]
    of: Value


class Occurrences(Node, frozen=True, tag="occurrences"):
    """How many items of a list are equal to one."""

    of: Value
    item: Value


class Sorted(Node, frozen=True, tag="sorted"):
    """A list in order, the smallest first or last."""

    of: Value
    descending: bool = False


class Distinct(Node, frozen=True, tag="distinct"):
    """A list without what is in it a second time."""

    of: Value


class Join(Node, frozen=True, tag="join"):
    """The items of a list as one text, with another between them."""

    of: Value
    separator: Value


class Field(Node, frozen=True, tag="field"):
    """A part of a location or a clock that was remembered, such as its time."""

    of: Value
    name: str


class Arithmetic(Node, frozen=True, tag="arithmetic"):
    """Two numbers calculated with: `//` divides without remainder, `%` gives the remainder. `+`
    also puts two lists together."""

    left: Value
    operator: Literal["+", "-", "*", "/", "//", "%"]
    right: Value


class Aggregate(Node, frozen=True, tag="aggregate"):
    """The sum of the numbers of a list, the smallest or the largest of them; 0 if it is empty."""

    function: Literal["min", "max", "sum"]
    of: Value


class Round(Node, frozen=True, tag="round"):
    """A number rounded, to a whole one unless `digits` says how many are left after the point."""

    of: Value
    digits: Value = Number(0)


class Absolute(Node, frozen=True, tag="absolute"):
    """A number without its sign."""

    of: Value


class NumberIn(Node, frozen=True, tag="number in"):
    """The first number that a text names, in digits or in words of the plan's language; 0 if it
    names none."""

    of: Value


class Share(Node, frozen=True, tag="share"):
    """What percentage `part` is of `whole`, a whole number; 0 if there is no whole."""

    part: Value
    whole: Value


class Figure(Node, frozen=True, tag="figure"):
    """A number made of the numbers that a list of answers names: `how` is "sum", "average",
    "highest" or "lowest"; 0 if none of them names one."""

    how: Annotated[str, msgspec.Meta(pattern="^(sum|average|highest|lowest)$")]
    of: Value


class Choice(Node, frozen=True, tag="choice"):
    """One of the items, at random."""

    among: Value


class Elapsed(Node, frozen=True, tag="elapsed"):
    """How many whole minutes have passed since a time of day, which may be before midnight."""

    since: Value


class HasCome(Node, frozen=True, tag="has come"):
    """Whether a time of day has come, once, since the clock showed what was remembered of it: on
    the same day, or after midnight."""

    time: Value
    since: Value


class Weekday(Node, frozen=True, tag="weekday"):
    """What day it is, by seven names from Monday on: what a language calls them. The clock itself
    names the days in English."""

    names: tuple[str, ...]


# --- conditions ----------------------------------------------------------------------------------


class Holds(Node, frozen=True, tag="holds"):
    """The value is true (`sees`, `find`, `wait_for`), or there is something in it: a list that is
    not empty, a text, a number other than 0."""

    value: Value


Comparison = Annotated[str, msgspec.Meta(pattern="^(==|!=|<|<=|>|>=|in)$")]


class Compare(Node, frozen=True, tag="compare"):
    """Two values compared: one of == != < <= > >=; `in` for an item of a list, a key of a record
    or a part of a text (upper and lower case count as the same in texts)."""

    left: Value
    operator: Comparison
    right: Value


class Not(Node, frozen=True, tag="not"):
    condition: Condition


class Both(Node, frozen=True, tag="and"):
    conditions: tuple[Condition, ...]


class Either(Node, frozen=True, tag="or"):
    conditions: tuple[Condition, ...]


Condition = Holds | Compare | Not | Both | Either

Value = (
    Text
    | Number
    | Truth
    | Recall
    | Items
    | Record
    | Range
    | Ask
    | Sentence
    | Length
    | Item
    | ListOf
    | Values
    | KeyOf
    | Occurrences
    | Sorted
    | Distinct
    | Join
    | Field
    | Arithmetic
    | Aggregate
    | Round
    | Absolute
    | NumberIn
    | Share
    | Figure
    | Choice
    | Elapsed
    | HasCome
    | Weekday
    | Holds
    | Compare
    | Not
    | Both
    | Either
)
"""Conditions are values, too: whether they hold."""


# --- steps ---------------------------------------------------------------------------------------


class Call(Node, frozen=True, tag="call"):
    """Call a robot method; `save_as` remembers its result under a name."""

    method: str
    arguments: dict[str, Value] = {}
    save_as: str | None = None


class Remember(Node, frozen=True, tag="remember"):
    """Keep a value under a name."""

    name: str
    value: Value


class Collect(Node, frozen=True, tag="collect"):
    """Add a value to the list of this name (`Remember(name, Items(()))` makes it first)."""

    name: str
    value: Value


class Increase(Node, frozen=True, tag="increase"):
    """Add to the number of this name: one, unless it says how much; to a list all items of another.
    With a `key`, to what the record of this name has for it, which is 0 at first."""

    name: str
    by: Value | None = None
    key: Value | None = None


class SetItem(Node, frozen=True, tag="set item"):
    """Keep a value for a key in the record of this name, or at a position in the list."""

    name: str
    key: Value
    value: Value


class If(Node, frozen=True, tag="if"):
    condition: Condition
    then: tuple[Step, ...]
    otherwise: tuple[Step, ...] = ()


class Repeat(Node, frozen=True, tag="repeat"):
    """Do it so many times."""

    times: Value
    steps: tuple[Step, ...]


class ForEach(Node, frozen=True, tag="for each"):
    """Do it for every item of a list, or key of a record, which goes by the name `variable` inside;
    what the record has for the key by the name `value`."""

    variable: str
    items: Value
    steps: tuple[Step, ...]
    value: str | None = None


class While(Node, frozen=True, tag="while"):
    """Do it as long as the condition holds; checked before each round."""

    condition: Condition
    steps: tuple[Step, ...]


class RepeatUntil(Node, frozen=True, tag="repeat until"):
    """Do it again and again; checked after each round."""

    condition: Condition
    steps: tuple[Step, ...]


class Forever(Node, frozen=True, tag="forever"):
    """Do it until somebody stops the robot."""

    steps: tuple[Step, ...]


class Try(Node, frozen=True, tag="try"):
    """Do it, and if the robot fails at it, do the other, in which the sentence that says why goes
    by the name `problem`."""

    steps: tuple[Step, ...]
    otherwise: tuple[Step, ...]
    problem: str | None = None


class End(Node, frozen=True, tag="end"):
    """Leave the innermost loop."""


class Continue(Node, frozen=True, tag="continue"):
    """Go on with the next round of the innermost loop."""


Step = (
    Call
    | Remember
    | Collect
    | Increase
    | SetItem
    | If
    | Repeat
    | ForEach
    | While
    | RepeatUntil
    | Forever
    | Try
    | End
    | Continue
)


class Plan(msgspec.Struct, frozen=True):
    """The whole: steps in order, and the language they were said in."""

    steps: tuple[Step, ...]
    language: str = "en"
    background: tuple[str, ...] = ()
    """What was said besides that asks for nothing ("I do not hear well"): shown, not acted on."""


def calls(plan: Plan) -> list[Call | Ask]:
    """Every robot call of a plan, in the order in which they are made, each once."""
    found: list[Call | Ask] = []

    def visit(node: Any) -> None:
        if isinstance(node, tuple):
            for item in node:
                visit(item)
        elif isinstance(node, msgspec.Struct):
            for name in node.__struct_fields__:
                child = getattr(node, name)
                visit(tuple(child.values()) if isinstance(child, dict) else child)
            if isinstance(node, Call | Ask):
                found.append(node)

    visit(plan.steps)
    return found


def methods(plan: Plan) -> frozenset[str]:
    """The robot methods that a plan calls."""
    return frozenset(call.method for call in calls(plan))


def to_data(plan: Plan) -> dict[str, Any]:
    """The plan as plain data for JSON."""
    data: dict[str, Any] = msgspec.to_builtins(plan)
    return data


msgspec.json.Decoder(Plan)  # learned before there are threads, see `robot_api.schema`


def from_data(data: Any) -> Plan:
    """The plan of such data. Raises `msgspec.ValidationError`, whose message names the spot."""
    return msgspec.convert(data, Plan)
