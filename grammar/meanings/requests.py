"""What is asked of the application about routines, commands that go by a name; and their steps
among others (`grammar.understand` enters what the name of one means)."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import msgspec

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps
from grammar.lexicon import Name, Routine
from grammar.meanings.registry import meaning
from grammar.plan import Call, ForEach, Plan, Remember, Try
from grammar.requests import Kind, Request
from grammar.tidy import nodes


def with_own_names(d: Discourse, plan: Plan) -> Steps:
    """The steps with names that the sentence around does not use."""
    names: dict[str, str] = {}
    own: tuple[str, ...]
    for each in nodes(plan.steps):
        match each:
            case Call(save_as=str() as name) | Remember(name=name) | Try(problem=str() as name):
                own = (name,)
            case ForEach(variable=name, value=other):
                own = (name,) if other is None else (name, other)
            case _:
                own = ()
        for name in own:
            if name not in names:
                names[name] = d.variable(name)
    return [_renamed(step, names) for step in plan.steps]


def _renamed(value: Any, names: dict[str, str]) -> Any:
    if isinstance(value, tuple):
        return tuple(_renamed(each, names) for each in value)
    if isinstance(value, dict):
        return {key: _renamed(each, names) for key, each in value.items()}
    if not isinstance(value, msgspec.Struct):
        return value
    changed = {field: _renamed(getattr(value, field), names) for field in value.__struct_fields__}
    owned = ("value", "problem") if isinstance(value, ForEach | Try) else ()
    for field in ("name", "save_as", "variable", *owned):
        if changed.get(field) in names:
            changed[field] = names[changed[field]]
    return type(value)(**changed)


# --- asked of the application


def request(d: Discourse, node: Node, kind: Kind) -> Request:
    """What is asked, with the original words of its parts."""

    def said(name: str) -> str:
        part = node.parts.get(name)
        if part is None:
            return ""
        if isinstance(part, Leaf) and isinstance(part.value, tuple):
            known: Name | Routine = part.value[0]
            return known.name
        if part.end == part.start + 1 and d.tokens[part.start].kind == "quote":
            return d.tokens[part.start].inner
        return d.words(part.start, part.end)

    return Request(kind, said("name"), said("new"), said("sentence"), said("part"))


@meaning("ask_help")
def ask_help(d: Discourse, node: Node) -> Request:
    return request(d, node, "help")


@meaning("learn_routine")
def learn_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "learn")


@meaning("list_routines")
def list_routines(d: Discourse, node: Node) -> Request:
    return request(d, node, "list")


@meaning("explain_routine")
def explain_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "explain")


@meaning("change_routine")
def change_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "change")


@meaning("forget_routine")
def forget_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "forget")


@meaning("schedule_routine")
def schedule_routine(d: Discourse, node: Node) -> Request:
    asked = request(d, node, "schedule")
    return replace(asked, when=d.build(node.parts["part"]))


@meaning("rename_routine")
def rename_routine(d: Discourse, node: Node) -> Request:
    return request(d, node, "rename")


@meaning("ask_about_run")
def ask_about_run(d: Discourse, node: Node) -> Request:
    """ "what did she say?", "are you done?"."""
    kind: Kind = node.production.fixed["kind"]
    return request(d, node, kind)
