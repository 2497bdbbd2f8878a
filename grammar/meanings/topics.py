"""What is spoken of stands first: "the cup on the desk, could you bring it to me?"."""

from __future__ import annotations

from dataclasses import replace
from typing import Final

from grammar.chart import Node
from grammar.discourse import Discourse, Steps
from grammar.errors import NotUnderstood
from grammar.meanings.deliveries import inside
from grammar.meanings.registry import meaning

THINGS: Final = "thing"
"""The rule for things; another topic is somebody."""


@meaning("topic")
def topic(d: Discourse, node: Node) -> Steps:
    """The command as if it named the topic where it says "it"."""
    spoken_of, command = node.parts["topic"], node.parts["then"]
    assert isinstance(spoken_of, Node)
    assert isinstance(command, Node)
    named = with_topic(command, spoken_of)
    if named is None:
        words = d.words(spoken_of.start, spoken_of.end)
        gap = (spoken_of.start, spoken_of.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words), gap=gap)
    steps: Steps = d.build(named)
    return steps


def with_topic(command: Node, topic: Node) -> Node | None:
    """A command with the topic for the first pronoun that stands for it; None if there is none."""
    pronoun = "thing_it" if topic.production.rule == THINGS else "person_pronoun"
    for name, part in command.parts.items():
        if not isinstance(part, Node):
            continue
        if part.means == pronoun:
            return replace(command, parts={**command.parts, name: topic})
        inner = with_topic(part, topic)
        if inner is not None:
            return replace(command, parts={**command.parts, name: inner})
    return None


@meaning("chosen_from")
def chosen_from(d: Discourse, node: Node) -> Steps:
    """ "of the books on the shelf, bring me the thickest": which of them is left to say."""
    d.build(node.parts["set"])
    command = node.parts["then"]
    assert isinstance(command, Node)
    if not any("superlative" in part.parts for part in [command, *inside(command)]):
        words = d.words(node.parts["set"].start, node.parts["set"].end)
        gap = (node.parts["set"].start, node.parts["set"].end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words), gap=gap)
    steps: Steps = d.build(command)
    return steps


@meaning("looked_over")
def looked_over(d: Discourse, node: Node) -> Steps:
    """ "look at the books on the shelf and bring me the thickest": several, to choose from."""
    those = d.get(node, "thing")
    if isinstance(those, list) or not those.plural:
        words = d.words(node.start, node.end)
        raise NotUnderstood(
            d.language.phrase("not_understood", part=words), gap=(node.start, node.end)
        )
    return []
