"""Canned utterances: a team's own sentences with what they should become, checked offline.

Two ways of writing them. YAML; each test says some of `program`, `calls`, `effects`, `status`:

    world: city-hospital            # optional; the command line may name another
    language: en
    tests:
      - say: go to the pharmacy and say hello
        program: |
          robot.goto("pharmacy")
          robot.say("Hello.")
      - say: fetch the stapler from the supply room
        calls: [location, find, grab, goto, give]        # these methods, in this order
        effects:                                         # what a run in the world leads to
          was at: [supply room, lobby]                   # in this order, others in between
          said: [Here you are.]
          asked: []
          holds: []                                      # at the end
          in order:                                      # all together, others in between
            - was at: supply room
            - took: stapler
            - was at: lobby
            - gave: stapler
      - say: what is the meaning of life
        status: rejected                                 # ok | clarify | rejected

Or plain lines, for sentences that just have to be understood, or with the calls they become:

    go to the pharmacy
    wave and say hello => gesture say
    what is the meaning of life => rejected
    # a comment

Every mistake in the file is told with its line.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

import msgspec
import yaml

from grammar.plan import calls, from_data
from nl2robot.changes import difference
from nl2robot.errors import UserError
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.review.rehearsal import Budget, EventKind, rehearse
from nl2robot.translate.outcome import Translation
from nl2robot.translate.translation import translate
from robot_api.errors import cause
from sim.world.files import read_text
from sim.world.loading import load_world
from sim.world.model import World

PATIENCE = Budget(seconds=7200.0, real_seconds=1800.0)
"""How far a run is followed here: nobody waits at a prompt."""


STATUSES = ("ok", "clarify", "rejected")


class Effects(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What a run must lead to; what is left out does not matter."""

    was_at: tuple[str, ...] | None = msgspec.field(name="was at", default=None)
    said: tuple[str, ...] | None = None
    asked: tuple[str, ...] | None = None
    holds: tuple[str, ...] | None = None
    in_order: tuple[dict[EventKind, str], ...] | None = msgspec.field(name="in order", default=None)
    """Events of all kinds, one after the other."""


class Test(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A sentence and what is expected of it."""

    __test__ = False  # for pytest: no test class

    say: str
    program: str | None = None
    calls: tuple[str, ...] | None = None
    effects: Effects | None = None
    status: str = "ok"
    line: int = 0
    """Where it stands in the file; filled in by `load`."""


class Suite(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A file of tests."""

    tests: tuple[Test, ...]
    world: str = DEFAULT_WORLD
    language: str = "en"


class Result(msgspec.Struct, frozen=True):
    """How a test came out."""

    test: Test
    failures: tuple[str, ...]
    program: str | None
    """What the sentence became."""
    status: str


# --- reading a file ------------------------------------------------------------------------------


def load(file: Path) -> Suite:
    """Read a file of canned utterances. Raises `UserError` with the line of the first mistake."""
    try:
        text = read_text(file)
    except (OSError, UnicodeDecodeError) as error:
        raise UserError(
            f"{file}: cannot be read ({cause(error)})."
            " Check its name and rights, and that it is UTF-8."
        ) from error
    if file.suffix.lower() in (".yaml", ".yml"):
        return _from_yaml(text, file)
    return Suite(tests=tuple(_from_lines(text)))


def _from_lines(text: str) -> Iterable[Test]:
    for number, line in enumerate(text.splitlines(), 1):
        words, arrow, methods = line.partition("=>")
        if words.strip() and not words.lstrip().startswith("#"):
            expected = tuple(methods.split())
            if len(expected) == 1 and expected[0] in STATUSES:
                yield Test(say=words.strip(), status=expected[0], line=number)
            else:
                yield Test(say=words.strip(), calls=expected if arrow else None, line=number)


def _from_yaml(text: str, file: Path) -> Suite:
    try:
        data = yaml.safe_load(text)
        suite = msgspec.convert(data, Suite)
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else 1
        raise UserError(f"{file}:{line}: this is no YAML ({error.problem}).") from error
    except yaml.YAMLError as error:
        raise UserError(f"{file}: this is no YAML ({error}).") from error
    except msgspec.ValidationError as error:
        line = _line_of(str(error), text)
        raise UserError(f"{file}:{line}: {error}.") from error
    lines = _lines_of_tests(text)
    return msgspec.structs.replace(
        suite,
        tests=tuple(
            msgspec.structs.replace(test, line=line)
            for test, line in zip(suite.tests, lines, strict=True)
        ),
    )


def _lines_of_tests(text: str) -> list[int]:
    root = yaml.compose(text, Loader=yaml.SafeLoader)
    fields = root.value if isinstance(root, yaml.MappingNode) else []
    return [
        entry.start_mark.line + 1
        for key, value in fields
        if key.value == "tests"
        for entry in value.value
    ]


def _line_of(message: str, text: str) -> int:
    """The line that a msgspec message means, which ends in a path such as `$.tests[3].say`."""
    node = yaml.compose(text, Loader=yaml.SafeLoader)
    path = message.rpartition("`$")[2].rstrip("`").replace("[", ".").replace("]", "")
    for step in filter(None, path.split(".")):
        if isinstance(node, yaml.SequenceNode) and step.isdigit():
            node = node.value[int(step)]
        elif isinstance(node, yaml.MappingNode):
            node = next((v for k, v in node.value if k.value == step), node)
    return int(node.start_mark.line) + 1 if node is not None else 1


# --- checking ------------------------------------------------------------------------------------


def check(suite: Suite, world: World | None = None) -> Iterable[Result]:
    """Check each test; yields the results as they come."""
    knowledge = Knowledge(world or load_world(suite.world))
    for test in suite.tests:
        translation = translate(test.say, knowledge, suite.language)
        failures = tuple(_failures(test, translation, knowledge))
        yield Result(test, failures, translation.program, translation.status)


def _failures(test: Test, translation: Translation, knowledge: Knowledge) -> Iterable[str]:
    if translation.status != test.status:
        told = f": {translation.message}" if translation.message else ""
        yield f"expected {test.status}, got {translation.status}{told}"
        return
    if translation.program is None or translation.plan is None:
        if test.program is not None or test.calls is not None or test.effects is not None:
            yield f"expected a program, got an answer: {translation.message}"
        return
    if test.program is not None and translation.program.strip() != test.program.strip():
        yield difference(test.program, translation.program, "expected program", "program now")
    if test.calls is not None:
        methods = tuple(call.method for call in calls(from_data(translation.plan)))
        if methods != test.calls:
            yield f"expected the calls {' '.join(test.calls)}, got {' '.join(methods)}"
    if test.effects is not None:
        yield from _missing_effects(test.effects, translation.program, knowledge.world)


def _missing_effects(effects: Effects, program: str, world: World) -> Iterable[str]:
    from sim.simulation import Simulation

    simulation = Simulation(world)
    run = rehearse(program, simulation, PATIENCE)
    if run.status != "done":
        yield f"the run ended as {run.status}: {run.message} (line {run.line})"
    for what, expected, found in (
        ("was at", effects.was_at, run.places),
        ("said", effects.said, run.says),
        ("asked", effects.asked, run.asks),
    ):
        if expected is not None and not _in_order(expected, found):
            yield f"expected {what} {list(expected)}, got {list(found)}"
    if effects.in_order is not None:
        events = [pair for entry in effects.in_order for pair in entry.items()]
        course = [(event.kind, event.what) for event in run.course]
        if not _in_order(events, course):
            told = ", ".join(f"{kind} {what}" for kind, what in course)
            yield f"“{_first_missing(events, course)}” did not come in its turn; it was: {told}"
    if effects.holds is not None and sorted(run.holds) != sorted(effects.holds):
        yield f"expected it to hold {list(effects.holds)} at the end, got {list(run.holds)}"


def _first_missing(
    expected: Sequence[tuple[EventKind, str]], found: Sequence[tuple[EventKind, str]]
) -> str:
    """The first event that does not come in its turn."""
    rest = iter(found)
    for kind, what in expected:
        if all(item != (kind, what) for item in rest):
            return f"{kind} {what}"
    return ""


def _in_order(expected: Sequence[object], found: Sequence[object]) -> bool:
    """Whether all expected are found in this order, with others in between; none means none."""
    if not expected:
        return not found
    rest = iter(found)
    return all(any(item == wanted for item in rest) for wanted in expected)
