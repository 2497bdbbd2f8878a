"""What a discourse remembers, by what it is about: the rooms of `grammar.discourse.Discourse`.

Meanings read them by name: `d.scene.person` is whom "her" stands for, `d.answers.last` the variable
with the last answer. No room ever changes; who learns something puts another in its place
(`d.scene = d.scene.speaking_of(thing)`, `d.answers = replace(d.answers, last=name)`), so that
whoever has kept one, to go back to or to begin a branch with, has it as it was.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from grammar.chart import Node
from grammar.plan import Step, Text, Value
from grammar.referents import Claim, Meeting, Thing, Where

Steps = list[Step]


@dataclass(frozen=True)
class Scene:
    """What the robot and the speaker have before them; each branch of a condition begins with the
    same scene."""

    thing: Thing | None = None
    """What was spoken of last: "it"."""
    person: Thing | None = None
    """Who was spoken of last: "her"."""
    person_on_arrival: Thing | None = None
    """Who was spoken of when the robot went to where it is: whoever's place that is, is nearer."""
    thing_last: bool = False
    """Whether a thing was spoken of after the last person."""
    place: Value | None = None
    """Which place was spoken of last: "there"."""
    at: Value | None = None
    """Where the robot is by now; None where the command was given."""
    away: bool = False
    """Whether the robot may be anywhere by now: something was looked for in several places."""
    looked_in: Value | None = None
    """That place, if a condition was checked there and for nothing else: others are not there."""
    with_person: Value | None = None
    """Whom the robot stands before."""
    led: Thing | None = None
    """Whom the robot has led to where it is."""
    holding: Value | None = None
    """What is in its hand."""
    now_at: Mapping[Value, Value] = field(default_factory=dict)
    """Where things are by now that were put down somewhere."""
    delivered: Value | None = None
    """A thing that was brought to the speaker without their saying where to."""
    at_pick_up: Value | None = None
    """Where it was picked up."""
    at_furniture: str | None = None
    """The furniture that a command is about: "on the table, ..."."""
    left: Mapping[Value, Value] = field(default_factory=dict)
    """Where people were led to."""
    missing: Thing | None = None
    """What was looked for in vain: "if not, look in the kitchen"."""
    lacking: Thing | None = None
    """What is not where it should be: "if there is none, bring one" is for that place."""
    group: Value | None = None
    """Several people spoken of together: "both", "each of them"."""

    def speaking_of(self, thing: Thing | None) -> Scene:
        """A thing was spoken of: it is "it"."""
        return replace(self, thing=thing, thing_last=True)

    def speaking_of_person(self, person: Thing | None) -> Scene:
        """Somebody was spoken of: it is "her"."""
        return replace(self, person=person, thing_last=False)

    def with_it_of(self, before: Scene) -> Scene:
        """ "It" is what it was in another scene."""
        return replace(self, thing=before.thing, thing_last=before.thing_last)

    def speaking_as(self, before: Scene) -> Scene:
        """Whatever was spoken of since, "it" and "her" are what they were."""
        return replace(self.with_it_of(before), person=before.person)

    def arrived(self, place: Value | None) -> Scene:
        """The robot is at a place, and that is "there"."""
        return replace(self, at=place, place=place)

    def wandered(self) -> Scene:
        """The robot may be at any of several places, and before nobody."""
        return replace(self, at=None, with_person=None)


@dataclass(frozen=True)
class People:
    """Who was spoken of, and as what."""

    last_named: Thing | None = None
    """Who was named last, in whichever branch: "him" is one person."""
    genders: Mapping[str, str] = field(default_factory=dict)
    """What people were called after they were named: "ask Bob whether he ..." makes Bob a "he"."""
    named: tuple[str, ...] = ()
    """Who was named so far."""
    awaited: Any = None
    """The step that waited for somebody last (`grammar.meanings.in_time.Awaited`)."""
    announced: Any = None
    """A guest who is expected (`grammar.meanings.strangers.Announced`)."""
    came: Thing | None = None
    """Whichever of several has come who were waited for."""
    visitor: Thing | None = None
    """Somebody nobody knows who was met or waited for: "they", told to somebody by name."""
    guest: Thing | None = None
    """Who without a name was spoken of before the receiver of the message that is made."""
    others: bool = False
    """Whether several people were spoken of before the message that is made."""
    host: Thing | None = None
    """Whom a guest was said to be for."""
    on_duty: str = ""
    """Whether the robot is to "guard" a place or to "stay" there: "when somebody comes" is then
    each time, or only "if anybody comes"."""


@dataclass(frozen=True)
class Answers:
    """What was asked, and what is known of the answers."""

    last: str | None = None
    """The variable with the last answer."""
    options: tuple[str, ...] = ()
    """What could be answered."""
    asked_for: Text | None = None
    """The thing that somebody was asked for, and that is still with them: "ask her for the key"."""
    held: Text | None = None
    """The thing that somebody was asked whether they have it."""
    says_so: bool = False
    """Whether what is said is done with whoever says that they have it."""
    taking: Any = None
    """How it is taken from whoever has it, before it is said where to."""
    wondered: tuple[Step, ...] = ()
    """The steps that ask what the speaker would like to know, before it is said whom to ask."""
    wonder: tuple[str, Thing | None] | None = None
    """The variable with the answer."""
    agreed: tuple[Any, Value] | None = None
    """The call that asked several who were found to say the same, and what they said."""
    claimed_question: Any = None
    """The step that answers somebody of whom it was only said that they have a question."""
    code: str | None = None
    """The variable with the code that was scanned last."""
    heard: str | None = None
    """The variable with what was heard last, of nobody in particular."""
    surveys: tuple[Any, ...] = ()
    """What was asked so far (`grammar.meanings.surveys.Survey`)."""
    put: Any = None
    """The last question (`Survey`) that the speaker put themselves, and waits to have answered."""
    message: Node | None = None
    """The command that told somebody something, or asked, last."""
    request: Any = None
    """What somebody was asked to do last (`grammar.meanings.requested.Request`)."""
    reminded: Any = None
    """Who was reminded by the last message (`grammar.reminders.reminded.Reminded`), if anybody."""
    undelivered: Any = None
    """That of somebody who is not there, and what was known then (`grammar.meanings.absences`)."""
    instead_of: str | None = None
    """The variable with the answer of somebody who, in this branch, is not there to give it."""
    counting: Any = None
    """The answers that the loop around has to count."""
    notes: Mapping[tuple[Any, ...], str] = field(default_factory=dict)
    """The variables with what is noted of a poll, by what that is (`grammar.meanings.polls`)."""
    said: Any = None
    """The answer that was last told of (`grammar.meanings.answers.Wanted`): "... that is"."""
    polled_for: str | None = None
    """What the last poll was to find out: "who", "many"."""
    asking_one: Thing | None = None
    """To whom a question is put by name: whether anybody has called is about others."""
    asking_each: bool = False
    """Whether a question is put to each of several: who wants tea is then whether they do."""


@dataclass(frozen=True)
class Deliveries:
    """What is fetched and brought, and for whom."""

    source: Value | None = None
    """Where a thing was taken from in the command before: "put it back"."""
    brought: tuple[Step, ...] = ()
    """How a thing was handed over last, if nobody was named to bring it to."""
    last: Any = None
    """What was brought to somebody last (`grammar.meanings.deliveries.Delivery`)."""
    destined: Any = None
    """That of a thing that was only said to be for somebody."""
    so_many: Step | None = None
    """The step that brings as many as somebody has answered."""
    meant_for: Any = None
    """Whom, or the place that, things are brought to where it is not said."""
    fetched: Step | None = None
    """The last step, if it brings somebody here for no other reason than that they were fetched."""
    taken_from: Where | None = None
    """Where the things of a command are taken from, if that is said of no noun phrase."""
    said_to_be: tuple[Thing, ...] = ()
    """Things that were said to be somewhere (`grammar.meanings.sources`)."""
    fetching: Any = None
    """The last command that takes things of which nobody has said where they are."""
    mislaid: Value | None = None
    """What somebody was said to wait or to look for: where "it" is then tells of that."""
    listed_last: tuple[Step, ...] = ()
    """The last steps that look for several things and tell which there are."""
    collected: Thing | None = None
    """Several things that are to be collected, before it was said where to."""
    shown: Value | None = None
    """What somebody was only to see or to sign, and is still in the robot's hand."""
    offers: tuple[Any, ...] = ()
    """What was offered to somebody so far (`grammar.meanings.offers.Offer`)."""
    listed_before: tuple[Thing, ...] = ()
    """The things of the last list."""
    only_fetches: bool = False
    """Whether a command fetches things without a word to whom or where to."""
    fetched_list: Any = None
    """The list of things that was fetched so (`grammar.meanings.thing_lists.FetchedList`)."""
    delivered_in: Step | None = None
    """The loop that brings several things to the speaker without their saying where to."""


@dataclass(frozen=True)
class Reports:
    """What was found out, and to whom it was told."""

    last: Any = None
    """What was told last (`grammar.meanings.reports.Report`), so that it can be told to others."""
    news: Any = None
    """What was told last of a poll or a round (`grammar.meanings.news.News`)."""
    checked: str | None = None
    """The variable with what was checked last."""
    counts: bool = False
    """Whether the last report is a count that nobody was named to be told of."""
    open: bool = False
    """Whether nobody was named whom to tell the last report."""
    last_counted: Thing | None = None
    """What was counted last: "how many people are here, and how many in the lobby?"."""
    counted: Any = None
    """The step that counts in the last round, the place it is at, and what is counted."""
    after_round: tuple[Thing | None, str] | None = None
    """Who is told, when a round is done, what was counted at each place (None for the speaker), and
    whether that is each number or the "total"."""
    told: Step | None = None
    """The last step, if it has told the speaker all there is to tell."""
    step: Step | None = None
    """The step that tells it."""
    asked: Any = None
    """The report as it was asked for, before it was known how it is told."""


@dataclass(frozen=True)
class Branched:
    """A condition that somebody or something is there: "if she is" may be said of it again."""

    step: Step
    """The `If` that checks it."""
    scene: Scene
    """The scene in which it was checked."""
    met: Meeting | None
    answer: str | None
    """The last answer that was known by then."""
    assumed: bool = False
    """Whether nothing was said of the other branch, and what is done there only assumed."""


@dataclass(frozen=True)
class Branch:
    """What the last condition was about, and what holds in the branch that is made."""

    met: Meeting | None = None
    """Who or what the last condition was about."""
    room: Value | None = None
    """The room of which something was looked at: "if it is free"."""
    before: Branched | None = None
    """The last condition that was followed by what is done then."""
    claim: Claim | None = None
    """What is so in this branch of a condition."""


@dataclass(frozen=True)
class Loops:
    """The loops around what is made, and what their variables stand for."""

    in_loop: bool = False
    """Whether what is made is done once for each of several."""
    bound: Mapping[int, Any] = field(default_factory=dict)
    """What noun phrases that speak of several stand for within their loop, by their `id`."""
    taking_apart: bool = False
    """Whether a noun phrase that speaks of several is made for the loop over them."""
    found_already: bool = False
    """Whether what a command is about was looked for by the steps around it."""
    stop: Value | None = None
    """The place of the loop around, if it is one over places."""
    at_people: bool = False
    """Whether the robot is where it is to meet people, so that things need not be there, too."""
    places: Mapping[str, Value] = field(default_factory=dict)
    """The places that loops go round, by their variables."""


@dataclass(frozen=True)
class Round:
    """What is known of the round of places that is made, or was made last."""

    lookout: Any = None
    """What a round looks for that nobody was told of (`grammar.meanings.lookouts.Lookout`)."""
    stop: Any = None
    """What is looked for at this stop of a round (`grammar.meanings.rounds.Trait`)."""
    here: Value | None = None
    """The stop of a round that a clause after it is about: "if one has none, come back and tell me
    which one"."""
    present: Any = None
    """The news of who of several people is in (`grammar.meanings.presence`)."""
    present_found: Any = None
    """The variable with which of them are in, and who they are."""
    such: str | None = None
    """The variable with the place that was looked for, as the first that is so."""
    told_of: bool = False
    """Whether somebody is only to be told of which places a condition is true."""
    claims: Any = None
    """What is so of them, and what if not (`grammar.meanings.some_places.Claims`)."""


@dataclass(frozen=True)
class Command:
    """The command that is made."""

    place_before: Value | None = None
    """The place that was spoken of before the command that is made."""
    origin: str | None = None
    """Where it was before the command before this was carried out."""
    at_place: Value | None = None
    """The place that a question is about: "in the kitchen, ..."."""
    resolved: frozenset[int] = frozenset()
    """The tokens of free texts that stand for what is only known when the program runs."""
    pending: tuple[Step, ...] = ()
    """Steps that a condition needs before it can be checked."""
    moments: tuple[Step, ...] = ()
    """The waits whose length was not said."""
