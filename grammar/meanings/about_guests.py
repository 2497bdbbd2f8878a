"""Messages about somebody without a name: "when the courier comes, tell David that he is there".

That "he" would be David, were it not for what is said of him: who is there, waits, has come or
wants to see somebody is the one who was met or spoken of before.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from grammar.chart import Node, what_it_means
from grammar.discourse import ANYONE, Discourse, Thing, Where


def guest_spoken_of(d: Discourse) -> Thing | None:
    """Somebody without a name who was met or spoken of last."""
    last = (
        d.scene.person
        if d.scene.person is not None and not d.scene.person.known
        else d.people.visitor
    )
    if last is None or last.me or last.group is not None or last.text in ("", ANYONE):
        return None
    return last


def others_spoken_of(d: Discourse) -> bool:
    """Whether several people were spoken of last, whom "they" stands for in a message to one."""
    last = d.scene.person
    return last is not None and not last.me and (last.plural or last.group is not None)


def guest_in(d: Discourse, receiver: Thing, start: int, end: int) -> dict[int, str]:
    """The word of a message that stands for the guest spoken of before, by its token, and the
    words for them: "he" of "he is there" is "the courier"."""
    data: dict[str, Any] | None = d.language.speech.get("guests")
    guest: Thing | None = d.people.guest
    if data is None or guest is None or receiver.me or guest.value == receiver.value:
        return {}
    subject, *rest = d.norms(start, end)

    def says(phrases: list[str]) -> bool:
        return any(f" {words} " in f" {' '.join(rest)} " for words in phrases)

    if subject not in data["subjects"] or says(data["duties"]) or not says(data["presence"]):
        return {}
    return {start: data["the"].format(who=d.called(guest.text))}


def host_told(d: Discourse, node: Node) -> None:
    """ "There is a visitor for Clara. Tell her.": "her" is whom the visitor is for, as long as
    nothing was done with the visitor."""
    part = node.parts.get("person_ref")
    host: Thing | None = d.people.host
    if host is None or d.done or part is None or what_it_means(part) != "person_pronoun":
        return
    if d.may_be(host, part.start, part.end):
        d.scene = replace(d.scene, person=host)


def who_is_told(d: Discourse, node: Node) -> Thing | None:
    """Who is told what was found out, and where they are: "go and tell him in his office"."""
    host_told(d, node)
    person: Thing | None = d.get(node, "person_ref")
    at: Where | None = d.get(node, "person_at")
    if person is None or at is None:
        return person
    return replace(person, place=at.place, here=False)
