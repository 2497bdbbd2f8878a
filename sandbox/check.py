"""Reads a program before it runs and says everything that is wrong with it, at once.

    program -> syntax -> what the sandbox does not run -> hidden robot calls -> types

Nothing of the program is executed. The rules about `robot` (it is only ever used as
`robot.method(...)`, and never within something that Python calls on its own) are what makes the
other reviews sound: every robot call there is can be seen in the text.
"""

from __future__ import annotations

import ast
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

from robot_api.methods import METHODS
from sandbox.diagnosis import diagnose
from sandbox.disguise import at_definition, hidden_signs, strange_letters, without_comments
from sandbox.limits import MAX_PROGRAM
from sandbox.sentences import UNAVAILABLE, near, problem, type_problem
from sandbox.source import WRAPPERS, unix_newlines
from sandbox.worker import Unavailable

MODULES: Final = ("re", "math", "random")
"""What a program may import."""

MAX_NESTING: Final = 50
"""How deeply expressions and blocks may be nested."""


@dataclass(frozen=True)
class Finding:
    """Something wrong ("error": the program will not be run) or doubtful ("warning")."""

    line: int
    column: int
    """Both count from 1."""
    severity: Literal["error", "warning"]
    code: str
    """A short name for programs to look at, such as "unknown-name"."""
    message: str
    """What is wrong, and what to do."""


def check(program: str, stub: str) -> list[Finding]:
    """All findings, in the order of the lines. `stub` is `robot_api.stub.stub(...)` for the robot
    that is to run it. Never raises, whatever the program is."""
    program = unix_newlines(program)
    first = syntax_finding(program)
    if first is not None:
        return [first]
    tree = _parsed(program)
    findings = [*_Reader(program, tree).findings(), *_disguises(program)]
    wrong = {finding.line for finding in findings if finding.severity == "error"}
    # What has been explained in our own words is not said again in the type checker's.
    findings += [each for each in _type_findings(program, stub) if each.line not in wrong]
    return sorted(set(findings), key=lambda each: (each.line, each.column, each.code))


def syntax_finding(program: str) -> Finding | None:
    """Why the text is no Python program at all, or one too large to be looked at."""

    def error(code: str, message: str, line: int = 1, column: int = 1) -> Finding:
        return Finding(max(1, line), max(1, column), "error", code, message)

    if len(program.encode(errors="replace")) > MAX_PROGRAM:
        size = MAX_PROGRAM // 1000
        return error("too-long", f"The program is longer than {size} kB. Make it shorter.")
    too_deep = "The program is nested too deeply. Split it into simpler steps."
    try:
        tree = _parsed(program)
        depth, line = _depth(tree)
        if depth > MAX_NESTING:
            return error("too-deep", too_deep, line)
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", SyntaxWarning)
            # Finds what parsing does not: `break` outside a loop, a name both global and local.
            compile(program, "program", "exec", dont_inherit=True)
    except SyntaxError as wrong:
        text = (wrong.msg or "this is not Python").rstrip(".")
        message = f"Python does not understand this: {text}. Correct it here or just before."
        return error("syntax", message, wrong.lineno or 1, wrong.offset or 1)
    except (RecursionError, MemoryError):
        return error("too-deep", too_deep)
    except (ValueError, OverflowError, UnicodeError) as wrong:
        return error("syntax", f"This is not a text that can be a program: {wrong}. Type it anew.")
    return None


def _parsed(program: str) -> ast.Module:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", SyntaxWarning)
        return ast.parse(program)


def _depth(tree: ast.AST) -> tuple[int, int]:
    """How deeply the tree is nested, and the line of the deepest spot."""
    deepest, line = 0, 1
    todo: list[tuple[ast.AST, int]] = [(tree, 0)]
    while todo:
        node, depth = todo.pop()
        if depth > deepest:
            deepest, line = depth, getattr(node, "lineno", line)
        todo += [(child, depth + 1) for child in ast.iter_child_nodes(node)]
    return deepest, line


def _disguises(program: str) -> Iterator[Finding]:
    for line, column, code, message in (*hidden_signs(program), *strange_letters(program)):
        yield Finding(line, column, "error", code, message)


def _type_findings(program: str, stub: str) -> Iterator[Finding]:
    try:
        diagnostics = diagnose(without_comments(program), stub)
    except Unavailable:
        yield Finding(1, 1, "error", "unavailable", UNAVAILABLE)
        return
    for each in diagnostics:
        if each.code == "unsupported":
            kind, _, text = each.message.partition(": ")
            message = problem(kind, text)
        else:
            message = type_problem(each.code, each.message)
        yield Finding(max(1, each.line), max(1, each.column), "error", each.code, message)


# --- our own rules -------------------------------------------------------------------------------

# Syntax that Monty 1.4.0 refuses (measured), or that has no use without files and other tasks.
_UNSUPPORTED: Final[dict[str, str]] = {
    "Yield": "yield. Collect the values in a list instead",
    "YieldFrom": "yield. Collect the values in a list instead",
    "Await": "await. Robot calls wait by themselves",
    "AsyncFunctionDef": "async. Robot calls wait by themselves",
    "AsyncFor": "async. Robot calls wait by themselves",
    "AsyncWith": "async. Robot calls wait by themselves",
    "Delete": "del. Give the name a new value instead",
    "With": "with. There is nothing to open here",
    "TryStar": "except*. Write except instead",
    "TypeAlias": "type. Leave the line out",
    "TemplateStr": 't"...". Write f"..." instead',
    "MatMult": "@ between values. Use * or a loop",
}

_FORBIDDEN: Final[dict[str, str]] = {
    "eval": "Write what it should compute as code",
    "exec": "Write what it should do as code",
    "compile": "Write what it should do as code",
    "open": "There are no files here; keep what you need in a variable",
    "input": "Use robot.ask instead",
    "getattr": "Write the name after a dot",
    "setattr": "Write the name after a dot",
    "delattr": "Leave it out",
    "globals": "Use the variables themselves",
    "locals": "Use the variables themselves",
    "vars": "Use the variables themselves",
    "breakpoint": "Use the pause and step buttons",
    "exit": "Let the program come to its end",
    "quit": "Let the program come to its end",
    "help": "See the list of the robot's methods",
    "__import__": f"Only {', '.join(MODULES)} can be imported",
}


class _Reader:
    """Our own rules over a program's syntax tree."""

    def __init__(self, program: str, tree: ast.Module) -> None:
        self.lines = program.encode(errors="replace").split(b"\n")
        self.tree = tree
        self.callers = _what_calls_the_robot(tree)

    def findings(self) -> Iterator[Finding]:
        called = {id(node.func) for node in ast.walk(self.tree) if isinstance(node, ast.Call)}
        spoken_to = {
            id(node.value)
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Attribute) and id(node) in called
        }
        for node in ast.walk(self.tree):
            yield from self.unsupported(node)
            yield from self.names(node)
            yield from self.robot(node, called, spoken_to)
            yield from self.hidden_calls(node)
            yield from self.loops(node)

    def finding(
        self,
        node: ast.AST,
        code: str,
        message: str,
        severity: Literal["error", "warning"] = "error",
    ) -> Finding:
        line = getattr(node, "lineno", 1)
        before = self.lines[line - 1][: getattr(node, "col_offset", 0)]
        return Finding(line, len(before.decode(errors="replace")) + 1, severity, code, message)

    def unsupported(self, node: ast.AST) -> Iterator[Finding]:
        match node:
            case ast.BinOp(op=ast.MatMult()) | ast.AugAssign(op=ast.MatMult()):
                kind = "MatMult"
            case ast.operator():
                return
            case _:
                kind = type(node).__name__
        if kind in _UNSUPPORTED:
            message = f"Programs for a robot cannot use {_UNSUPPORTED[kind]}."
            yield self.finding(node, "unsupported", message)
        if isinstance(node, ast.FunctionDef | ast.ClassDef) and node.decorator_list:
            message = "There are no decorators here. Take the line with @ away."
            yield self.finding(node.decorator_list[0], "unsupported", message)
        if isinstance(node, ast.ClassDef):
            if node.bases or node.keywords:
                message = "A class cannot be based on another here. Write it out, or use functions."
                yield self.finding(node, "unsupported", message)
            for inner in node.body:
                if isinstance(inner, ast.ClassDef):
                    message = "A class cannot stand in a class here. Move it out."
                    yield self.finding(inner, "unsupported", message)

    def names(self, node: ast.AST) -> Iterator[Finding]:
        match node:
            case ast.Import():
                for alias in node.names:
                    if alias.name not in MODULES:
                        yield self.finding(node, "import", self.no_module(alias.name))
            case ast.ImportFrom():
                if node.level or node.module not in MODULES:
                    yield self.finding(node, "import", self.no_module(node.module or "."))
                elif any(alias.name == "*" for alias in node.names):
                    message = f"Name what you need: from {node.module} import ... instead of *."
                    yield self.finding(node, "import", f"The * hides what is imported. {message}")
            case ast.Name(id=name) if name in _FORBIDDEN:
                message = f"Programs for a robot cannot use {name}. {_FORBIDDEN[name]}."
                yield self.finding(node, "forbidden", message)
            case ast.Name(id=name) | ast.Attribute(attr=name) if name.startswith("__"):
                message = f"Names such as {name} belong to Python itself. Choose another way."
                yield self.finding(node, "forbidden", message)
            case ast.Constant(value=str(text)) if any(
                "\ud800" <= sign <= "\udfff" for sign in text
            ):
                message = "This text holds half a sign. Write the whole sign, or take it out."
                yield self.finding(node, "half-a-sign", message)
            case _:
                pass

    def no_module(self, name: str) -> str:
        if name == "time":
            return "There is no module time here. Use robot.wait(...) and robot.clock() instead."
        return f"There is no module {name} here. Only {', '.join(MODULES)} can be imported."

    def robot(self, node: ast.AST, called: set[int], spoken_to: set[int]) -> Iterator[Finding]:
        for name in {"robot", *WRAPPERS.values()}.intersection(_bound(node)):
            message = f"The name {name} belongs to the robot. Choose another name."
            yield self.finding(node, "robot", message)
        match node:
            case ast.Attribute(value=ast.Name(id="robot"), attr=name) if id(node) not in called:
                hint = near(name, METHODS, "See the list of its methods.")
                if name in METHODS:
                    hint = f"Write robot.{name}(...)."
                message = f"A robot method has to be called where it stands. {hint}"
                yield self.finding(node, "robot", message)
            case ast.Name(id="robot", ctx=ast.Load()) if id(node) not in spoken_to:
                if not self.is_attribute_of_robot(node):
                    message = "The robot can only be told something, as in robot.say(...)."
                    yield self.finding(node, "robot", f"{message} Write such a call here.")
            case ast.Name(ctx=ast.Load()) | ast.Attribute(ctx=ast.Load()) if (
                _name(node) in self.callers and id(node) not in called
            ):
                name = _name(node).lstrip(".")
                message = f"{name} calls the robot, so it has to be called where it stands."
                yield self.finding(node, "callback", f"{message} Write {name}(...), or a loop.")
            case _:
                pass

    def is_attribute_of_robot(self, name: ast.Name) -> bool:
        """Whether it is the `robot` of a `robot.method` without brackets: that was said above."""
        return any(
            isinstance(node, ast.Attribute) and node.value is name for node in ast.walk(self.tree)
        )

    def hidden_calls(self, node: ast.AST) -> Iterator[Finding]:
        """Robot calls where Python, not the program, decides when they are made."""
        match node:
            case ast.GeneratorExp(elt=element, generators=[first, *others]):
                # What the first `for` goes through is worked out once, in either case.
                inside: list[ast.AST] = [element, first.target, *first.ifs, *others]
                if any(map(self.calls_the_robot, inside)):
                    message = "All robot calls in here would be made at once, needed or not."
                    yield self.finding(node, "generator", f"{message} Write a for loop instead.")
            case ast.Lambda() if self.calls_the_robot(node):
                message = "A robot call cannot stand in a lambda. Write a for loop instead."
                yield self.finding(node, "callback", message)
            case ast.FunctionDef(name=name) if (
                name.startswith("__") and name != "__init__" and self.calls_the_robot(node)
            ):
                message = f"A robot call cannot stand in {name}. Give the method another name."
                yield self.finding(node, "callback", message)
            case _:
                for where, message in at_definition(node, self.calls_the_robot):
                    yield self.finding(where, "callback", message)

    def calls_the_robot(self, node: ast.AST) -> bool:
        return any(
            isinstance(inner, ast.Call)
            and (_robot_method(inner.func) is not None or _name(inner.func) in self.callers)
            for inner in ast.walk(node)
        )

    def loops(self, node: ast.AST) -> Iterator[Finding]:
        if not isinstance(node, ast.While) or _never_goes_round(node):
            return
        is_true = isinstance(node.test, ast.Constant) and bool(node.test.value)
        endless = is_true and not _leaves(node)
        if not self.calls_the_robot(node):
            if endless:
                message = "This loop computes without end and never calls the robot."
                yield self.finding(
                    node, "busy-loop", f"{message} Put robot.wait(1) into it.", "warning"
                )
            return
        if not self.takes_time(node):
            message = "This loop asks the robot as fast as it can. Put robot.wait(1) into it."
            yield self.finding(node, "busy-loop", message, "warning")
        if endless:
            message = "This loop goes on until somebody stops the robot. Leave it if you want that."
            yield self.finding(node, "endless-loop", message, "warning")

    def takes_time(self, node: ast.AST) -> bool:
        return any(
            isinstance(inner, ast.Call)
            and (
                ((name := _robot_method(inner.func)) is not None and _slow(name))
                or _name(inner.func) in self.callers
            )
            for inner in ast.walk(node)
        )


def _slow(name: str) -> bool:
    method = METHODS.get(name)
    if method is None:
        return True
    return (
        method.moves
        or name in ("say", "wait", "wait_until", "wait_for")
        or "TimedOut" in method.errors
    )


def _robot_method(function: ast.expr) -> str | None:
    match function:
        case ast.Attribute(value=ast.Name(id="robot"), attr=name):
            return name
        case _:
            return None


def _what_calls_the_robot(tree: ast.Module) -> set[str]:
    """The functions, classes and methods (".name") with a robot call in them, or in what they
    call."""
    names: dict[int, str] = {}
    calls: dict[str, set[str]] = {}
    found: set[str] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ClassDef):
            # Making an object calls its __init__.
            names |= {
                id(inner): node.name if inner.name == "__init__" else f".{inner.name}"
                for inner in node.body
                if isinstance(inner, ast.FunctionDef)
            }
        if not isinstance(node, ast.FunctionDef):
            continue
        name = names.get(id(node), node.name)
        inside = [each.func for each in ast.walk(node) if isinstance(each, ast.Call)]
        if any(_robot_method(each) is not None for each in inside):
            found.add(name)
        calls[name] = calls.get(name, set()) | {_name(each) for each in inside}
    grown = True
    while grown:
        more = {name for name, called in calls.items() if called & found} - found
        found |= more
        grown = bool(more)
    return found


def _name(function: ast.AST) -> str:
    """As `_what_calls_the_robot` names it; "" for what has no name."""
    match function:
        case ast.Name(id=name):
            return name
        case ast.Attribute(attr=name):
            return f".{name}"
        case _:
            return ""


def _bound(node: ast.AST) -> list[str | None]:
    """The names to which the node gives another meaning."""
    match node:
        case ast.Name(id=name, ctx=ast.Store() | ast.Del()) | ast.arg(arg=name):
            return [name]
        case (
            ast.FunctionDef(name=name)
            | ast.AsyncFunctionDef(name=name)
            | ast.ClassDef(name=name)
            | ast.ExceptHandler(name=name)
            | ast.MatchAs(name=name)
            | ast.MatchStar(name=name)
            | ast.MatchMapping(rest=name)
        ):
            return [name]
        case ast.alias(name=name, asname=other):
            return [other or name]
        case ast.Attribute(value=ast.Name(id="robot"), ctx=ast.Store() | ast.Del()):
            return ["robot"]
        case ast.Global(names=names) | ast.Nonlocal(names=names):
            return [*names]
        case _:
            return []


def _never_goes_round(loop: ast.While) -> bool:
    again = any(isinstance(node, ast.Continue) for node in ast.walk(loop))
    return _always_leaves(loop.body) and not again


def _always_leaves(steps: list[ast.stmt]) -> bool:
    """Whether these steps end the loop they stand in, whichever way they go."""
    for step in steps:
        match step:
            case ast.Break() | ast.Return() | ast.Raise():
                return True
            case ast.If(body=body, orelse=otherwise) if otherwise:
                ways = [body, otherwise]
            case ast.Try(body=body, handlers=handlers, orelse=otherwise):
                ways = [[*body, *otherwise], *(handler.body for handler in handlers)]
            case _:
                continue
        if all(map(_always_leaves, ways)):
            return True
    return False


def _leaves(loop: ast.While) -> bool:
    """Whether something in the loop can end it: break, return or raise."""
    todo: list[ast.AST] = list(loop.body)
    while todo:
        node = todo.pop()
        if isinstance(node, ast.Break | ast.Return | ast.Raise):
            return True
        if isinstance(node, ast.For | ast.While):
            # Its own `break` leaves the inner loop only.
            todo += [each for each in ast.walk(node) if isinstance(each, ast.Return | ast.Raise)]
            todo += node.orelse
        elif not isinstance(node, ast.FunctionDef | ast.Lambda):
            todo += ast.iter_child_nodes(node)
    return False
