"""Screen, gestures, joints and skills: commands that are nearly one robot method each."""

from __future__ import annotations

from grammar.chart import Node
from grammar.discourse import Discourse, Steps, Thing, as_value
from grammar.errors import NotUnderstood
from grammar.meanings.asking import remember_answer
from grammar.meanings.finding import speak_to
from grammar.meanings.options import split_options
from grammar.meanings.orders_to_tell import on_screen
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report, kept
from grammar.meanings.surveys import each_asked
from grammar.plan import Call, Items, Recall, Text


@meaning("show")
def show(d: Discourse, node: Node) -> Steps:
    url = d.get(node, "url")
    if url:
        address = str(url) if "://" in str(url) else f"https://{url}"
        return [Call("show", {"url": Text(address)})]
    quote = node.parts.get("quote")
    part = quote or node.parts.get("text")
    if part is None and d.answers.last is not None and each_asked(d) is not None:
        return on_screen(d)  # of all who were asked
    if part is None:
        return [Call("show", {"text": Recall(found_out(d))})]
    shown: Steps = [Call("show", {"text": Text(str(d.build(part)))})]
    whom: Thing | None = d.get(node, "person_ref")
    return shown if whom is None else speak_to(d, whom, shown)


@meaning("show_fact")
def show_fact(d: Discourse, node: Node) -> Steps:
    """ "show the time on the screen": what would be said of it is shown instead."""
    told = d.get(node, "info")
    if isinstance(told, Report) and told.value is not None and told.otherwise is None:
        words = dict(told.words)
        shown = d.sentence(told.phrase, **words, value=told.value)
        return [*told.before, Call("show", {"text": shown})]
    raise NotUnderstood(d.language.phrase("show_what"))


def found_out(d: Discourse) -> str:
    """The variable with what was found out last; what would have been said of it is not."""
    name = d.answers.last or d.answers.code or kept(d)
    if name is None:
        raise NotUnderstood(d.language.phrase("show_what"))
    return name


@meaning("touch")
def touch(d: Discourse, node: Node) -> Steps:
    """Let somebody choose on the touchscreen; the choice can be used afterwards."""
    part = node.parts["text"]
    options = split_options(d, part.start, part.end)
    name = remember_answer(d, options, "choice")
    return [Call("touch", {"options": Items(tuple(Text(each) for each in options))}, save_as=name)]


@meaning("type_text")
def type_text(d: Discourse, node: Node) -> Steps:
    part = node.parts.get("quote") or node.parts["text"]
    return [
        Call(
            "type_text",
            {"selector": as_value(d.get(node, "selector")), "text": Text(str(d.build(part)))},
        )
    ]


@meaning("joint")
def joint(d: Discourse, node: Node) -> Steps:
    return [
        Call(
            "joint",
            {"name": as_value(d.get(node, "joint")), "degrees": as_value(d.get(node, "degrees"))},
        )
    ]


@meaning("joint_turn")
def joint_turn(d: Discourse, node: Node) -> Steps:
    """ "turn your head to the left by thirty degrees": the joint that turns that part that way."""
    way = str(d.get(node, "side"))
    part = str(d.get(node, "part"))
    axis = way.removeprefix("-")
    degrees = float(d.get(node, "degrees"))
    usual = f"{part}_{axis}"
    named = (each for each in d.lexicon.joints if part in each.lower() and axis in each.lower())
    angle = -degrees if way != axis else degrees
    return [Call("joint", {"name": Text(next(named, usual)), "degrees": as_value(angle)})]


@meaning("gesture")
def gesture(d: Discourse, node: Node) -> Steps:
    call = Call("gesture", {"name": as_value(d.get(node, "gesture"))})
    return speak_to(d, d.get(node, "person_ref"), [call])


@meaning("emotion")
def emotion(d: Discourse, node: Node) -> Steps:
    """ "look happy"; "smile at Bob" is shown to him."""
    call = Call("emotion", {"name": as_value(d.get(node, "name"))})
    return speak_to(d, d.get(node, "person_ref"), [call])


@meaning("skill")
def skill(d: Discourse, node: Node) -> Steps:
    return [Call("do", {"skill": as_value(d.get(node, "skill"))})]
