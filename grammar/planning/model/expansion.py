"""From what a language model writes to a plan: the dialect is shorter than the program.

`robot.` stands before no method, and a search for somebody stands alone: that what follows is only
done if they are found, and that they were not is told where the robot was sent from, is a matter of
course that no model has to write each time. A search for somebody else begins anew, unless what is
done with them needs what the first was found for.
"""

from __future__ import annotations

import ast
from collections.abc import Collection, Sequence
from typing import Final

import msgspec

from grammar.identifiers import Identifiers, all_names, names_in, speaks_of
from grammar.language import Language, speech
from grammar.lexicon import Lexicon
from grammar.naming import joined_up, naming
from grammar.plan import (
    Ask,
    Call,
    ForEach,
    Holds,
    If,
    Items,
    Not,
    Plan,
    Recall,
    Step,
    Text,
    Value,
)
from grammar.planning.model.expressions import CALLS, DAYS
from grammar.program_parser import NotAPlan, parse_program
from grammar.roles import ANYBODY
from grammar.tidy import BODIES, nodes

START: Final = "start"
_SEARCH: Final = "find"


def program_of(text: str, language: Language) -> str:
    """The dialect as Python that a robot's program is: with `robot.` before its methods. Raises
    `NotAPlan` for what is no Python."""
    try:
        tree = ast.parse(text)
        spelled = _Spelled(language, tree).visit(tree)
        return ast.unparse(ast.fix_missing_locations(spelled)) + "\n"
    except SyntaxError as error:
        raise NotAPlan(
            error.lineno or 1, f"Python does not understand this: {error.msg}."
        ) from error
    except (ValueError, RecursionError, MemoryError) as error:
        raise NotAPlan(1, "Python does not understand this.") from error


class _Spelled(ast.NodeTransformer):
    """Writes out what is short in the dialect."""

    def __init__(self, language: Language, tree: ast.AST) -> None:
        self.language = language
        self.days = {
            target.id
            for node in ast.walk(tree)
            if isinstance(node, ast.Assign) and _is_weekday(node.value)
            for target in node.targets
            if isinstance(target, ast.Name)
        }
        """Names of days, as people call them."""

    def visit_Compare(self, node: ast.Compare) -> ast.AST:
        sides = [node.left, *node.comparators]
        if any(_is_weekday(side) for side in sides):  # the clock names the days in English
            sides = [
                ast.parse("robot.clock().weekday", mode="eval").body if _is_weekday(side) else side
                for side in sides
            ]
        elif any(isinstance(side, ast.Name) and side.id in self.days for side in sides):
            for part in (part for side in sides for part in ast.walk(side)):
                if isinstance(part, ast.Constant) and part.value in DAYS:
                    part.value = spoken_name(self.language, part.value)
        node.left, *node.comparators = sides
        return self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> ast.AST:
        self.generic_visit(node)
        if not isinstance(node.func, ast.Name):
            return node
        if _is_weekday(node):
            names = [spoken_name(self.language, day) for day in DAYS]
            return ast.parse(f"weekday_called({names!r})", mode="eval").body
        if node.func.id == "random_choice":
            node.func = ast.Attribute(ast.Name("random", ast.Load()), "choice", ast.Load())
        elif node.func.id in CALLS:
            node.func = ast.Attribute(ast.Name("robot", ast.Load()), node.func.id, ast.Load())
        return node


def _is_weekday(node: ast.expr) -> bool:
    return isinstance(node, ast.Call) and getattr(node.func, "id", None) == "weekday"


def spoken_name(language: Language, day: str) -> str:
    """What a language calls a day."""
    names: dict[str, str] = language.speech.get("names", {})
    return names.get(day, day)


def expanded(text: str, people: Collection[str], lexicon: Lexicon, language: Language) -> Plan:
    """The plan of what a model wrote; `people` are whom the sentence speaks of. Raises `NotAPlan`
    for what is no plan."""
    plan = parse_program(program_of(text, language), language.code)
    return Expansion(people, lexicon, language).of(plan)


def _name_of_start(plan: Plan) -> str:
    """A name for the place where the robot starts: that of the plan, if it has one, and else one
    that stands for nothing else."""
    for node in nodes(plan.steps):
        is_place = isinstance(node, Call) and node.method == "location"
        if not is_place and not isinstance(node, Recall) and START in names_in(node).values():
            names = Identifiers()
            for name in all_names(plan):
                names.of(name)
            return names.spare(START)
    return START


def _is_kept(steps: Sequence[Step], name: str) -> bool:
    """Whether the plan itself gives this name before it is used."""
    for step in steps:
        if isinstance(step, Call) and step.save_as == name:
            return True
        if any(isinstance(node, Recall) and node.name == name for node in nodes((step,))):
            return False
    return False


def _hands(steps: Sequence[Step]) -> int:
    """How much more was taken than was given away."""
    calls = [node.method for node in nodes(steps) if isinstance(node, Call)]
    return calls.count("grab") - calls.count("give") - calls.count("put")


class Expansion:
    """What goes without saying, said."""

    def __init__(self, people: Collection[str], lexicon: Lexicon, language: Language) -> None:
        self.people = {*people} - {ANYBODY}
        self.lexicon = lexicon
        self.language = language
        self.returns = False
        self.start = START

    def of(self, plan: Plan) -> Plan:
        self.start = _name_of_start(plan)
        steps = self.steps(plan.steps, in_loop=False, names={})
        if self.returns and not _is_kept(steps, self.start):
            steps = (Call("location", save_as=self.start), *steps)
        return msgspec.structs.replace(plan, steps=steps)

    def steps(
        self, steps: tuple[Step, ...], in_loop: bool, names: dict[str, Value]
    ) -> tuple[Step, ...]:
        done: list[Step] = []
        for number, step in enumerate(steps):
            step = self.inner(step, in_loop, names)
            if self.is_search(step, names):
                assert isinstance(step, Call)
                after = steps[number + 1 :]
                end = self.end(step, after, names)
                rest = self.steps(after[:end], in_loop, names)
                anew = self.steps(after[end:], in_loop, names)
                return (*done, self.searched(step, rest, in_loop), *anew)
            done.append(step)
        return tuple(done)

    def inner(self, step: Step, in_loop: bool, names: dict[str, Value]) -> Step:
        if isinstance(step, ForEach):
            names = {**names, step.variable: step.items}
        changed = {
            body: self.steps(getattr(step, body), in_loop or not isinstance(step, If), names)
            for body in BODIES
            if getattr(step, body, ())
        }
        return msgspec.structs.replace(step, **changed) if changed else step

    def is_search(self, step: Step, names: dict[str, Value]) -> bool:
        """Whether somebody is looked for, and nothing said of what is done if they are not
        found."""
        if not isinstance(step, Call) or step.method != _SEARCH or step.save_as is not None:
            return False
        thing = step.arguments["thing"]
        if isinstance(thing, Recall):
            among = names.get(thing.name)
            named = among.items if isinstance(among, Items) else ()
            return any(isinstance(each, Text) and each.value in self.people for each in named)
        return isinstance(thing, Text) and thing.value in self.people

    def end(self, search: Call, steps: tuple[Step, ...], names: dict[str, Value]) -> int:
        """How many of the steps after a search are done with whoever is found: those up to the next
        search, if nothing from there on is about them, or needs what was found out or taken."""
        for number, step in enumerate(steps):
            before, after = steps[:number], steps[number:]
            if before and self.is_search(step, names):
                given = {name for node in nodes(before) for name in names_in(node).values()}
                about = search.arguments["thing"] in nodes(after)
                needed = about or any(speaks_of(after, name) for name in given)
                if not needed and _hands(before) <= 0:
                    return number
        return len(steps)

    def searched(self, search: Call, rest: tuple[Step, ...], in_loop: bool) -> Step:
        found = Holds(Ask(_SEARCH, search.arguments))
        missing = () if in_loop else self.missing(search.arguments["thing"])
        if not rest:
            return If(Not(found), missing) if missing else search
        return If(found, rest, missing)

    def missing(self, thing: Value) -> tuple[Step, ...]:
        """Coming back and telling that somebody could not be found."""
        self.returns = True
        called = naming(self.lexicon, self.language).called
        name = thing.value if isinstance(thing, Text) else ""
        known = any(person.name == name for person in self.lexicon.people)
        spoken = called(name) if known else speech(self.language.code).nouns.the(called(name))
        told = joined_up(self.language.phrase("not_found", thing=spoken), self.language)
        return (
            Call("goto", {"place": Recall(self.start)}),
            Call("say", {"text": Text(told)}),
        )
