"""What is true of a place: "is empty", "has a stapler but no screen", "has three chairs"."""

from __future__ import annotations

from dataclasses import dataclass

from grammar.chart import Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing
from grammar.meanings.nouns import thing_it
from grammar.meanings.places import sought
from grammar.meanings.registry import meaning
from grammar.plan import (
    Ask,
    Both,
    Call,
    Compare,
    Condition,
    Holds,
    Items,
    Not,
    Number,
    Recall,
    Text,
)


@dataclass(frozen=True)
class Trait:
    """Something that is true of a place or not."""

    condition: Condition
    first: Steps
    """What finds it out, there."""
    thing: Thing | None = None
    """What has to be there, or must not be."""
    denied: bool = False
    """Whether it must not be there."""


@meaning("trait_seen")
def trait_seen(d: Discourse, node: Node) -> Trait:
    """ "is empty", "has a stapler", "there is somebody in"."""
    thing: Thing | None = d.get(node, "thing") or d.get(node, "person_ref")
    if node.production.fixed.get("it"):  # "has none": of what was spoken of
        thing = thing_it(d, node)
    looked_for = Text(ANYONE) if thing is None else sought(d, thing)
    seen: Condition = Holds(Ask("sees", {"thing": looked_for}))
    denied = bool(node.production.fixed.get("no"))
    return Trait(Not(seen) if denied else seen, [], thing, denied)


@meaning("trait_both")
def trait_both(d: Discourse, node: Node) -> Trait:
    """ "has a projector but no screen", "is empty and has a fan"."""
    first: Trait = d.get(node, "first")
    second: Trait = d.get(node, "second")
    both = Both((first.condition, second.condition))
    return Trait(both, [*first.first, *second.first])


@meaning("trait_counted")
def trait_counted(d: Discourse, node: Node) -> Trait:
    """ "has more than two chairs"."""
    thing: Thing = d.get(node, "thing")
    number = Number(int(d.get(node, "count")))
    count = Ask("count", {"thing": sought(d, thing)})
    return Trait(Compare(count, d.get(node, "operator", "=="), number), [], thing)


@meaning("trait_asked")
def trait_asked(d: Discourse, node: Node) -> Trait:
    """ "needs towels": only the people there can tell."""
    part = node.parts["text"]
    form = str(node.production.fixed["form"])
    question = Text(form.format(text=d.words(part.start, part.end)))
    agree, refuse = d.language.phrase("yes"), d.language.phrase("no")
    answer = d.variable("answer")
    options = Items((Text(agree), Text(refuse)))
    asking = Call("ask", {"question": question, "options": options}, save_as=answer)
    agreed: Condition = Compare(Recall(answer), "==", Text(agree))
    return Trait(Not(agreed) if node.production.fixed.get("no") else agreed, [asking])
