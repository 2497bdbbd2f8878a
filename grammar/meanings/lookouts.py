"""Rounds of places to look for something there: "check every office for a stapler".

What is then said decides what becomes of it: which places are named ("tell me which ones have
none"), whether there is one anywhere, or what is done where it is so ("if there is one, ..."). If
nothing is said, whoever sent the robot is told where it is so. What a search ends with ("... and
bring it to me") ends with the first that is found.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Final

from msgspec.structs import replace as structs_replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.conditions import negated
from grammar.meanings.deliveries import first_clause, inside
from grammar.meanings.finding import look_for, speak_to
from grammar.meanings.news import BACK, News, Told, go_back
from grammar.meanings.persons import is_me
from grammar.meanings.place_loops import (
    last_round,
    of_them,
    of_those,
    round_of,
    same_round,
    visits_alone,
)
from grammar.meanings.places import kind_places, sought
from grammar.meanings.registry import meaning
from grammar.meanings.rounds import found_places, summed_up
from grammar.meanings.searches import named_places, search_in, searched, searches
from grammar.meanings.sights import named_some, told_where
from grammar.meanings.traits import Trait
from grammar.plan import (
    Ask,
    Call,
    Collect,
    End,
    ForEach,
    Holds,
    If,
    Items,
    Recall,
    Remember,
    Text,
    Value,
)

ABOUT_IT: Final = frozenset(
    {"news", "tell_that", "tell_me_that", "tell_condition", "come_back", "look_now", "report"}
)
"""Clauses that say what is to be told of a round."""

LOOKS: Final = frozenset({"round_check", "for_each_place", "find", "report", "news"})
"""Clauses that look for something, or ask where it is."""


@dataclass(frozen=True)
class Lookout:
    """A round that looks for something at each place, and of which nothing was told yet."""

    place: str
    """What each place is called in it."""
    places: Value
    trait: Trait
    thing: Thing | None
    """What is looked for, if it is that it is there or not."""
    depth: int
    """In which sequence it was ordered."""
    definite: bool
    """Whether it is one thing, so that the search for it ends where it is: "the thermometer"."""
    tell: str
    """What is told if nothing else is asked for: "which", "any"; "all", if it has to be so
    everywhere and only where it is not is news."""

    def told(self, d: Discourse, tell: str = "") -> Told:
        """At which places it is so."""
        at = self.at(d)
        if at is None:
            raise NotUnderstood(d.language.phrase("which_places"))
        loop = d.done[at]
        assert isinstance(loop, ForEach)
        found, condition = d.variable("found"), self.trait.condition
        tell = tell or self.tell
        if self.tell == "all":
            condition, tell = negated(condition), "all"
        noted = If(condition, (Collect(found, Recall(self.place)),))
        d.done[at] = structs_replace(loop, steps=(*loop.steps, *self.trait.first, noted))
        d.done.insert(0, Remember(found, Items(())))
        d.round = replace(d.round, lookout=None)
        return Told(found_places(d, tell, found, so=condition), [])

    def counted(self, d: Discourse) -> Told:
        """How many of them there are at all the places."""
        if self.thing is None or self.trait.denied:
            return self.told(d, "many")
        d.round = replace(d.round, lookout=None)
        return summed_up(d, "total", self.thing)

    def at(self, d: Discourse) -> int | None:
        """Where among the steps so far it is."""
        at = last_round(d)
        if at is None:
            return None
        loop = d.done[at]
        return at if isinstance(loop, ForEach) and loop.variable == self.place else None

    def acted_on(self, body: Steps) -> Steps:
        """What is done at each place where it is so; nothing more is looked for where it was
        somebody by name, or is taken away: "look in every ward for a wheelchair and bring it"."""
        thing = self.thing
        taken = thing is not None and Call("grab", {"thing": thing.value}) in body
        if thing is not None and (taken or (thing.known and thing.person)):
            body = [*body, End()]
        return [*self.trait.first, If(self.trait.condition, tuple(body))]

    def until_found(self, d: Discourse) -> None:
        """Nothing but a search, after all, if it can be one."""
        at, places = self.at(d), named_places(d, self.places)
        d.round = replace(d.round, lookout=None)
        if at is not None and places and self.thing is not None and not self.trait.denied:
            d.done[at : at + 1] = search_in(d, self.thing, places)
            d.scene = replace(d.scene, at=None, away=True)

    def meet(self, d: Discourse) -> None:
        """The scene at a place where it is so."""
        if self.thing is not None and self.thing.person and not self.trait.denied:
            d.scene = replace(
                d.scene, person=replace(self.thing, here=True), with_person=self.thing.value
            )


@meaning("round_check")
def round_check(d: Discourse, node: Node) -> Steps:
    """ "check every office for a stapler", "see whether each of the labs has a microscope"."""
    them = node.production.fixed.get("of_them")
    places: Value = of_them(d) if them else of_those(d, kind_places(d, d.get(node, "kinds")))
    if same_round(d, places):
        return []
    place = d.variable("place")
    before = d.scene.thing
    d.scene = d.scene.arrived(Recall(place))
    trait: Trait = d.get(node, "place_trait")
    d.scene = d.scene.wandered()
    d.answers = replace(d.answers, last=None)
    d.reports = replace(d.reports, last=None, news=None, counted=None, checked=None)
    thing = trait.thing
    if thing is None:
        d.scene = replace(d.scene, thing=before)
    elif thing.person:
        d.scene = d.scene.speaking_of_person(thing)
    else:
        d.scene = d.scene.speaking_of(thing)
    tell = str(node.production.fixed.get("tell", "which"))
    until = bool(node.production.fixed.get("until"))
    one = until or definite(d, node.parts["place_trait"], thing)
    lookout = Lookout(place, places, trait, thing, d.depth, one, tell)
    d.round = replace(d.round, lookout=lookout)
    return [round_of(d, places, [], place)]


def definite(d: Discourse, part: Leaf | Node, thing: Thing | None) -> bool:
    """Whether it is one thing that is looked for, or somebody."""
    named = d.tokens[part.start].norm in d.language.speech.get("definite", ())
    return thing is not None and (named or (thing.known and thing.person))


def looks_out(d: Discourse, clause: Node) -> bool:
    """ "make a tour of the labs. Look for a laptop": whether a clause says what a round is for that
    does nothing else."""
    visits = visits_alone(d)
    part = clause.parts.get("thing") or clause.parts.get("person_ref")
    if visits is None or clause.means != "find" or part is None or "from" in clause.parts:
        return False
    thing: Thing | list[Thing] = d.build(part)
    if isinstance(thing, list) or thing.place is not None or thing.several or thing.here:
        return False
    if thing.person:
        d.scene = d.scene.speaking_of_person(thing)
    else:
        d.scene = d.scene.speaking_of(thing)
    seen = Trait(Holds(Ask("sees", {"thing": sought(d, thing)})), [], thing)
    one = definite(d, part, thing)
    lookout = Lookout(visits.variable, visits.items, seen, thing, d.depth, one, "which")
    d.round = replace(d.round, lookout=lookout)
    return True


def told_of_lookout(d: Discourse, many: bool) -> Told | None:
    """What a round has looked for, or how many of them it has found; a search through several
    places is such a round if "how many there are" is asked."""
    lookout: Lookout | None = d.round.lookout
    if lookout is None and many:
        lookout = search_as_round(d)
    if lookout is None:
        return None
    return lookout.counted(d) if many else lookout.told(d)


def found_before_coming_back(d: Discourse) -> None:
    """ "look for it in all the labs. Come back. Tell me where it is": found out on the way, so that
    the way back is said once more with what is told."""
    looked = d.done[-2] if len(d.done) > 1 and d.done[-1] == BACK else None
    if searched(looked) is not None or isinstance(looked, ForEach):
        d.done.pop()
        d.scene = replace(d.scene, at=None)


def looked_on_visits(d: Discourse, node: Node) -> Lookout | None:
    """ "go through all rooms and tell me if you see a dog": what is to be looked for on a round in
    which nothing else is done."""
    visits = visits_alone(d)
    if visits is None:
        return None
    somebody = d.gender(node.start, node.end) is not None
    last = d.scene.person if somebody or d.scene.thing is None else d.scene.thing
    thing: Thing | None = d.get(node, "thing") or last
    if thing is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    seen = Trait(Holds(Ask("sees", {"thing": sought(d, thing)})), [], thing)
    return Lookout(visits.variable, visits.items, seen, thing, d.depth, True, "any")


def another_meant(d: Discourse, node: Node) -> Thing | None:
    """ "tell Alice that ..., then tell Bob where she is": who but the one spoken of last is meant
    by the pronoun; None if it may be that one."""
    last, gender = d.scene.person, d.gender(node.start, node.end)
    if last is None or d.scene.thing_last or gender is None or d.may_have(last, gender):
        return None
    names = [name for name in d.people.named if d.gender_of(name) == gender]
    return Thing(Text(names[-1]), known=True, person=True) if names else None


def where_met(d: Discourse, person: Thing | None) -> Told | None:
    """Where somebody was found before, noted there."""
    if person is None:
        return None
    place = d.variable("place")
    noted = Remember(place, Ask("location"))
    for at in range(len(d.done) - 1, -1, -1):
        match d.done[at]:
            case Call(method="find", arguments={"thing": who}) if who == person.value:
                d.done.insert(at + 1, noted)
                break
            case If(condition=Holds(value=Ask(method="find", arguments={"thing": who}))) as met:
                if who == person.value:
                    d.done[at] = structs_replace(met, then=(noted, *met.then))
                    break
    else:
        raise NotUnderstood(d.language.phrase("which_places"))
    return Told([d.say("it_is_at", thing=named_some(d, person), place=Recall(place))], [])


def told_of_search(d: Discourse, tell: str) -> Told:
    """ "look for a ladder in the lobby and tell Bob whether there is one", "check the lobby and the
    hall for it and tell me where it is": of the search that the last step is."""
    condition = searched(d.done[-1] if d.done else None)
    if (
        condition is None and tell == "which" and d.answers.last is None
    ):  # "I am looking for Bob, tell me where he is"
        return told_where(d, d.scene.thing if d.scene.thing_last else d.scene.person)
    if condition is None:
        raise NotUnderstood(d.language.phrase("which_places"))
    looked = searches(condition)
    thing = sought_last(d, looked[0])
    lookout = search_as_round(d)
    if lookout is not None:
        return lookout.told(d, tell)
    if tell != "any" or len(looked) > 1:
        raise NotUnderstood(d.language.phrase("which_places"))
    found = d.variable("found")
    d.done[-1] = Remember(found, looked[0])
    words = If(
        Holds(Recall(found)),
        (d.say("yes_seen", thing=named_some(d, thing)),),
        (d.say("no_seen", thing=named_some(d, thing)),),
    )
    return Told([words], [])


def sought_last(d: Discourse, search: Ask) -> Thing:
    """What a search is for, as it was spoken of."""
    value = search.arguments["thing"]
    known = (each for each in (d.scene.thing, d.scene.person) if each and sought(d, each) == value)
    return next(known, Thing(value))


def search_as_round(d: Discourse) -> Lookout | None:
    """The search that the last step is, as a round of all its places, if it has several."""
    condition = searched(d.done[-1] if d.done else None)
    looked = [] if condition is None else searches(condition)
    places = tuple(each.arguments["place"] for each in looked if "place" in each.arguments)
    if len(places) < 2:
        return None
    thing = sought_last(d, looked[0])
    place = d.variable("place")
    d.done[-1] = round_of(d, Items(places), [], place)
    seen = Trait(Holds(Ask("sees", {"thing": looked[0].arguments["thing"]})), [], thing)
    return Lookout(place, Items(places), seen, thing, d.depth, True, "which")


def tell_lookout(d: Discourse, person: Thing | None) -> Steps | None:
    """What a round was to find out, told to somebody; None if there is none to tell of."""
    if d.round.lookout is None:
        return None
    words = d.round.lookout.told(d).words
    d.reports = replace(d.reports, news=News(words, person is None), told=words[-1])
    if person is None or is_me(person):
        return [*go_back(d, []), *words]
    return speak_to(d, person, words)


@meaning("look_now")
def look_now(d: Discourse, node: Node) -> Steps:
    """ "Is there a mug in the kitchen? Go and look ...": that is what is done already."""
    told = bool(d.done) and d.reports.told == d.done[-1]  # "is there a mug anywhere? Go and look"
    asked = d.reports.news or d.reports.last or d.round.lookout or d.round.such
    if not told and asked is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return []


def why_only(clause: Node, rest: Node) -> bool:
    """ "I need a projector. Which of the rooms has one?": whether a clause only says why something
    is looked for. It is then what is spoken of, and nothing is done about it yet."""
    wish = first_clause(clause)
    if not wish.production.fixed.get("why"):
        return False
    of_it = (each.production.fixed.get("it") or each.means == "thing_it" for each in inside(rest))
    return first_clause(rest).means in LOOKS and any(of_it)


def why(d: Discourse, clause: Node) -> None:
    """Speak of what is needed, and of no more."""
    wish = first_clause(clause)
    part = wish.parts.get("thing") or wish.parts["person_ref"]
    thing: Thing = d.build(part)
    if thing.person:
        d.scene = d.scene.speaking_of_person(thing)
    else:
        d.scene = d.scene.speaking_of(thing)
    d.background += (d.words(clause.start, clause.end),)


@meaning("looking_for")
def looking_for(d: Discourse, node: Node) -> Steps:
    """ "I am looking for Clara. Go to her office and see if she is there": why, if it is said where
    to look for her; else what to do."""
    person: Thing = d.get(node, "person_ref")
    if any(token.kind == "word" for token in d.tokens[node.end : node.end + 2]):
        d.background += (d.words(node.start, node.end),)
        d.scene = d.scene.speaking_of_person(person)
        return []
    return look_for(d, person)


def told_at_last(d: Discourse) -> Steps:
    """What a round was to find out, at the end of a sequence in which nobody asked for it."""
    waiting: News | None = d.reports.news
    if d.depth == 1 and waiting is not None and waiting.waiting and waiting.whom is not None:
        return speak_to(d, waiting.whom, waiting.words)
    lookout: Lookout | None = d.round.lookout
    if lookout is None or lookout.depth != d.depth:
        return []
    at = lookout.at(d)
    if at is not None and at != len(d.done) - 1 and lookout.tell == "all" and not lookout.definite:
        # "check that nobody is in the labs, then go to the charger": told in between
        d.start()
        told = lookout.told(d).words
        d.done[at + 2 : at + 2] = [BACK, *told]
        return []
    if at is not None and d.done[at + 1 :] == [BACK] and not lookout.definite:
        d.done.pop()  # "..., then come back": to say it
    elif at != len(d.done) - 1 or lookout.definite:
        lookout.until_found(d)
        return []
    return tell_lookout(d, None) or []
