"""What is said about the command before: which change is asked for, with its words."""

from __future__ import annotations

from grammar.chart import Node
from grammar.discourse import Discourse
from grammar.edits import Edit, EditKind
from grammar.meanings.registry import meaning


def edit(d: Discourse, node: Node, kind: EditKind) -> Edit:
    """The change that is asked for, with the original words of its parts."""

    def said(name: str) -> str:
        part = node.parts.get(name)
        return d.words(part.start, part.end) if part is not None else ""

    more = said("more")
    new = f"{said('new')}, {more}" if more else said("new")
    which = int(node.production.fixed.get("which", -1))
    return Edit(kind, new, said("old") or said("what"), said("late"), which)


@meaning("edit_cancel")
def edit_cancel(d: Discourse, node: Node) -> Edit:
    """ "cancel that": nothing of it is to be done."""
    return edit(d, node, "cancel")


@meaning("edit_drop_step")
def edit_drop_step(d: Discourse, node: Node) -> Edit:
    """ "undo the last step", "skip the first part"."""
    return edit(d, node, "drop step")


@meaning("edit_drop")
def edit_drop(d: Discourse, node: Node) -> Edit:
    """ "without the greeting", "skip the pharmacy"."""
    return edit(d, node, "drop")


@meaning("edit_instead")
def edit_instead(d: Discourse, node: Node) -> Edit:
    """ "tea instead of coffee", "not the lab, the pharmacy"."""
    return edit(d, node, "instead")


@meaning("edit_correct")
def edit_correct(d: Discourse, node: Node) -> Edit:
    """ "no, the pharmacy", "make it three"."""
    return edit(d, node, "correct")


@meaning("edit_only")
def edit_only(d: Discourse, node: Node) -> Edit:
    """ "only in the lobby": of several the one with this in it."""
    return edit(d, node, "only")


@meaning("edit_first")
def edit_first(d: Discourse, node: Node) -> Edit:
    """ "first go to the lab": before all the rest."""
    return edit(d, node, "first")


@meaning("edit_add")
def edit_add(d: Discourse, node: Node) -> Edit:
    """ "and then wave": after all the rest."""
    return edit(d, node, "add")


@meaning("edit_reverse")
def edit_reverse(d: Discourse, node: Node) -> Edit:
    """ "the other way round": the last of several first."""
    return edit(d, node, "reverse")


@meaning("edit_again")
def edit_again(d: Discourse, node: Node) -> Edit:
    """ "again", "once more in the kitchen"."""
    return edit(d, node, "again")


@meaning("edit_same")
def edit_same(d: Discourse, node: Node) -> Edit:
    """ "the same for Bob", "what about the lobby": it all, with this in the place of its like."""
    return edit(d, node, "same")


@meaning("edit_manner")
def edit_manner(d: Discourse, node: Node) -> Edit:
    """ "say it louder", "say that in German"."""
    return edit(d, node, "manner")
