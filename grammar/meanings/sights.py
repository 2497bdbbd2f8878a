"""What the robot sees, as something to tell: who is there, what lies there, how many."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node, what_it_means
from grammar.discourse import ANYONE, START, Discourse, Steps, Thing, Where
from grammar.errors import NotUnderstood
from grammar.meanings.answered_numbers import number_answered
from grammar.meanings.descriptions import described
from grammar.meanings.finding import found, in_state, is_here, not_found, whether_found
from grammar.meanings.news import Told
from grammar.meanings.nouns import best_of_those, is_best
from grammar.meanings.places import at_own_place, place_called_after, sought
from grammar.meanings.polls import polled, told_as_asked
from grammar.meanings.registry import meaning
from grammar.meanings.reports import Report
from grammar.meanings.surveys import asked_yet, in_loop
from grammar.naming import person_called, place_called, some, the
from grammar.pieces import leaves
from grammar.plan import Ask, Call, Holds, If, Items, Recall, Remember, Text, Value
from grammar.tidy import mentions
from grammar.wordforms import plural, singular


def names_answered(d: Discourse, node: Node) -> Report | None:
    """ "ask Clara which students come and tell Bob their names": what she has answered."""
    survey = d.answers.surveys[-1] if d.answers.surveys else None
    if (
        survey is None
        or d.answers.last is None
        or d.answers.last != survey.call.save_as
        or survey.options
    ):
        return None
    asked = survey.call.arguments["question"]
    words = d.language.tokens_of(asked.value) if isinstance(asked, Text) else ()
    of_others = set(words[:1]) & set(d.language.speech.get("asks_for_names", ()))
    theirs = d.language.words_called("of_them_all") & set(d.norms(node.start, node.end))
    if not of_others or not theirs or in_loop(d, survey.call):
        return None
    return Report("only", Recall(d.answers.last), about_here=False)


@meaning("names_here")
def names_here(d: Discourse, node: Node) -> Report | Steps:
    """ "who is in the lobby?", "the name of the person in the kitchen"; "their names", behind a
    condition on what they were asked, of those who said so."""
    of_who_said_so = (d.depth > 1 and d.answers.said is not None) or d.answers.polled_for == "who"
    if of_who_said_so and asked_yet(d) and names_whom(d, node):
        return polled(d, "who", None).words
    if (theirs := names_answered(d, node)) is not None:
        return theirs
    person: Thing | None = d.get(node, "person_ref")
    if person is not None and person.coming:  # whoever will come: not who is here now
        raise NotUnderstood(d.language.phrase("one_person"))
    come = None if person is not None or "mods" in node.parts else who_has_come(d)
    if come is not None:
        return come
    given = name_given(d, node, person)
    if given is not None:
        return given
    if person is None:
        person = described(d, ANYONE, node)
        away = person.place is not None
        d.scene = replace(
            d.scene,
            person=Thing(Text(ANYONE), person.place, person=True, plural=True, here=not away),
        )
    elif "mods" in node.parts and not person.known:  # "the man's name in the bedroom"
        person = replace(person, place=described(d, "", node).place or person.place)
    elif "mods_after" in node.parts and not person.known:  # "which man in the hall is waving"
        more = described(d, person.text, node)
        place, furniture = person.place or more.place, person.furniture or more.furniture
        who = replace(more, place=place, furniture=furniture, person=True)
        return Report("only", Ask("describe", {"thing": sought(d, who)}), place, name="description")
    elif person.here and isinstance(d.reports.asked, Report):
        if d.reports.asked.value == Ask("people"):  # those who were seen
            return d.reports.asked
        person = replace(person, place=None)
    elif person.here or d.scene.with_person == person.value:  # wherever that is by now
        person = replace(person, place=None)
    if is_told_apart(d, person):  # "the woman at the sofa": a description says her name
        look = Ask("describe", {"thing": sought(d, person)})
        return Report("only", look, person.place, name="description")
    return Report("people_seen", Ask("people"), person.place, name="names")


def is_told_apart(d: Discourse, person: Thing) -> bool:
    """Whether one person is meant, and not only by the place they are at: "the woman at the sofa",
    "the person sitting there"."""
    if person.known or person.plural or person.pronoun:
        return False
    if person.noun not in ("", ANYONE, person.text):
        return True
    before, someone, behind = person.text.partition(ANYONE)
    return bool(someone) and (bool(before) or not d.language.closed.issuperset(behind.split()[:1]))


def names_whom(d: Discourse, node: Node) -> bool:
    """Whether a pronoun says whose names are asked for."""
    part = node.parts.get("person_ref")
    return isinstance(part, Node) and part.means == "person_pronoun"


@meaning("who_came")
def who_came(d: Discourse, node: Node) -> Report:
    """ "who has come"; "there is somebody in the hall, see who it is"."""
    come = who_has_come(d)
    if come is None and d.scene.person is not None and d.scene.person.place is not None:
        person = replace(d.scene.person, pronoun=False)
        d.scene = replace(d.scene, person=person)
        look = Ask("describe", {"thing": sought(d, person)})
        return Report("only", look, person.place, name="description")
    if come is None:
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return come


def who_has_come(d: Discourse) -> Report | None:
    """Whoever was met: by the name they gave, or as a visitor."""
    if d.people.visitor is None:
        return None
    survey = survey_named_so(d, "name")
    if survey is not None:
        return Report("is_here", Recall(survey), about_here=False, name="name")
    words = (("thing", some(d.called(d.people.visitor.text), d.language)),)
    return Report("somebody_here", words=words, about_here=False)


def name_given(d: Discourse, node: Node, person: Thing | None) -> Report | None:
    """ "ask for her name, take her to Bob and tell him her name": the name that she gave."""
    survey = survey_named_so(d, "name")
    part = node.parts.get("person_ref")
    if survey is None or d.people.visitor is None or person is None or "mods" in node.parts:
        return None
    pronoun = isinstance(part, Node) and part.means == "person_pronoun"
    if not pronoun and person.value != d.people.visitor.value:
        return None
    return Report("only", Recall(survey), about_here=False, name="name")


def survey_named_so(d: Discourse, noun: str) -> str | None:
    """The variable with the one answer to a question for a name."""
    for survey in reversed(d.answers.surveys):
        if noun in survey.nouns and survey.call.save_as and not in_loop(d, survey.call):
            name: str = survey.call.save_as
            return name
    return None


@meaning("seen_here")
def seen_here(d: Discourse, node: Node) -> Report | Steps:
    """ "what you see"; "everything", after people were asked, is all that they said."""
    if node.end - node.start == 1 and asked_yet(d) and d.reports.last is None:
        return polled(d, "answers", None).words
    place = described(d, "", node, lies_about=True)
    if place.text:  # "what is behind the cup?", "what is on the far left of the shelf?"
        return one_there(d, node)
    if "at_place" in node.parts:  # "describe the lobby"
        place = replace(place, place=d.get(node, "at_place"))
    if place.furniture:
        return things_on(d, place)
    if place.place is None and isinstance(d.reports.asked, Report) and d.reports.asked.looked:
        return d.reports.asked  # "see what is on the desk and tell Alex what is there"
    return Report("objects_seen", Ask("objects"), place.place, name="things")


def one_there(d: Discourse, node: Node) -> Report:
    """What is just there, and nothing else, is what "it" is then."""
    noun = d.language.phrase("objects")
    thing = described(d, noun, node, lies_about=True)
    if thing.text.startswith(noun):
        every = described(d, d.language.phrase("all_objects"), node, lies_about=True)
        found = whatever_there(d, thing, every)
    else:
        found = best_there(d, thing)
        d.scene = d.scene.speaking_of(replace(thing, noun=noun, here=thing.place is None))
    return found


def seen_around(d: Discourse) -> Report:
    """All that is to be seen where the robot is."""
    if d.scene.at_furniture:
        return things_on(d, Thing(Text(""), d.scene.at, d.scene.at_furniture))
    return Report("objects_seen", Ask("objects"), None, name="things", looked=True)


def things_on(d: Discourse, place: Thing) -> Report:
    """ "what is on the bed?": all that is on it, or that there is nothing."""
    thing = replace(place, value=Text(d.language.phrase("objects")))
    every = replace(place, value=Text(d.language.phrase("all_objects")))
    return whatever_there(d, thing, every)


def whatever_there(d: Discourse, thing: Thing, every: Thing) -> Report:
    """All things that are as one and "every" one is said to be, or that there is nothing. What is
    there is "it" then."""
    d.scene = d.scene.speaking_of(replace(thing, here=thing.place is None))
    one, everything = sought(d, thing), sought(d, every)
    assert isinstance(one, Text)
    where = d.called(one.value.removeprefix(d.language.phrase("objects")).strip())
    words = d.variable("description")
    look = Remember(words, Ask("describe", {"thing": everything}))
    before = (
        Remember(words, d.sentence("nothing_there", where=where)),
        If(Holds(Ask("sees", {"thing": one})), (look,)),
    )
    return Report("only", Recall(words), thing.place, before=before, looked=True)


@meaning("kind_seen")
def kind_seen(d: Discourse, node: Node) -> Report:
    """ "which cups are on the table?": all of them in a sentence, or that there are none."""
    head = node.parts["head"]
    assert isinstance(head, Leaf)
    name = str(head.value[0]) if head.value else d.noun_words(head.start, head.end)
    thing = described(d, singular(name, d.language), node, lies_about=True)
    return which_there(d, thing)


def which_there(d: Discourse, thing: Thing) -> Report:
    """Which things of a kind are somewhere: all, or as many as are asked for, or that there are
    none."""
    words = d.variable("description")
    called = plural(thing.text, d.language)
    number = "" if thing.count is None else f"{thing.count} "
    several = replace(thing, value=Text(number + called), count=None)
    look = Remember(words, Ask("describe", {"thing": sought(d, several)}))
    none = d.sentence("none_seen", things=d.called(called))
    seen = Holds(Ask("sees", {"thing": sought(d, replace(thing, count=None))}))
    before = (Remember(words, none), If(seen, (look,)))
    return Report("only", Recall(words), thing.place, before=before)


def best_there(d: Discourse, thing: Thing) -> Report:
    """Which thing is the biggest, or which three are."""
    return Report(
        "only", Ask("describe", {"thing": sought(d, thing)}), thing.place, name="description"
    )


@meaning("looks_of")
def looks_of(d: Discourse, node: Node) -> Report | Steps:
    """How something looks; a description says it all."""
    thing: Thing = (
        d.get(node, "thing")
        or d.get(node, "person_ref")
        or d.scene.person  # "there is somebody in the kitchen, report the gender"
        or Thing(Text(ANYONE), person=True, here=True)
    )
    extra = described(d, "", node)
    place = thing.place or extra.place
    if thing.person and thing.known and place is None and not is_here(d, thing):
        return described_where_found(d, thing)
    return Report("only", Ask("describe", {"thing": sought(d, thing)}), place, name="description")


def described_where_found(d: Discourse, person: Thing) -> Steps:
    """ "what is Alice wearing?": look for her, come back and say it."""
    arguments: dict[str, Value] = {"thing": person.value}
    start, name = d.start(), d.variable("description")
    back = Call("goto", {"place": start})
    look = Remember(name, Ask("describe", arguments))
    d.went(start)
    told = d.say("only", value=Recall(name))
    found = Holds(Ask("find", arguments))
    return [If(found, (look, back, told), (back, not_found(d, person)))]


@meaning("best_of")
def best_of(d: Discourse, node: Node) -> Report:
    """ "what is the biggest thing on the table?"."""
    thing: Thing | None = d.get(node, "thing")
    if thing is None:
        thing = _best(d, node)
    else:
        more = described(d, thing.text, node)
        thing = replace(
            thing, place=thing.place or more.place, furniture=thing.furniture or more.furniture
        )
    found = best_there(d, thing)
    d.scene = d.scene.speaking_of(replace(thing, here=thing.place is None))
    return found


def _best(d: Discourse, node: Node) -> Thing:
    head = node.parts.get("head")
    noun = "object"
    if isinstance(head, Leaf):
        said = str(head.value[0]) if head.value else d.noun_words(head.start, head.end)
        noun = singular(said, d.language)
    elif d.scene.thing is not None and (d.scene.thing.plural or is_best(d, d.scene.thing)):
        # "check the drinks and tell me which is biggest"
        noun = d.scene.thing.noun or noun
    return best_of_those(d, node, described(d, noun, node))


@meaning("counted_info")
def counted_info(d: Discourse, node: Node) -> Report | Steps:
    """ "how many cups are in the kitchen?"; "how many cups", after somebody was asked just that, is
    what they said."""
    if asked_yet(d) and d.reports.last is None and node.parts.keys() == {"thing"}:
        said = told_as_asked(d, node.start, node.end)
        if said is not None:
            return said.words
    answered = number_answered(d, node)
    if answered is not None:
        return answered.words
    thing: Thing = d.get(node, "thing")
    more = described(d, thing.text, node, lies_about=not thing.person)
    first: Where | None = d.get(node, "spot_first")
    thing = replace(
        thing,
        value=in_state(d, node, more).value,
        place=thing.place or more.place or (first.place if first else None),
        furniture=thing.furniture or more.furniture or (first.furniture if first else None),
    )
    nowhere = thing.place is None and d.scene.at in (None, Recall(START))
    if nowhere and no_kind(node) and d.reports.last_counted is not None:
        thing = replace(
            thing, place=d.reports.last_counted.place
        )  # of those who were counted there
    d.reports = replace(d.reports, last_counted=thing)
    if not thing.person:
        d.scene = replace(
            d.scene, thing=replace(thing, plural=True)
        )  # "..., and which one is the smallest"
    if thing.person and d.scene.person is not None:
        there = d.scene.person.place or thing.place
        d.scene = replace(
            d.scene, person=replace(d.scene.person, plural=True, place=there)
        )  # who are counted are several
    return count_report(d, thing)


def no_kind(node: Node) -> bool:
    """Whether people are spoken of only by what they do: "how many are sitting"."""
    part = node.parts.get("thing")
    return isinstance(part, Node) and part.parts.keys() == {"mods"}


def count_report(d: Discourse, thing: Thing) -> Report:
    phrase_words = d.called(thing.text)
    spot = _spot_words(d, thing)
    noun = d.called(thing.noun) if thing.person and thing.noun in thing.text else ""
    noun = noun or (phrase_words.split()[0] if thing.person else phrase_words)
    things = phrase_words.replace(noun, plural(noun, d.language), 1)
    looked_for = sought(d, thing)
    count = Ask("count", {"thing": looked_for})
    if thing.furniture and isinstance(looked_for, Text):  # "cups on the table"
        things, spot = f"{things} {d.called(looked_for.value.removeprefix(thing.text).strip())}", ""
    phrase = "counted_at" if spot and "counted_at" in d.language.phrases else "counted"
    words = (
        (("things", things), ("place", spot)) if phrase == "counted_at" else (("things", things),)
    )
    return Report(phrase, count, thing.place, words, name="count")


def _spot_words(d: Discourse, thing: Thing) -> str:
    """Where things were counted, as a name."""
    if thing.furniture:
        return place_called(thing.furniture, d.lexicon, d.language)
    place = thing.place or d.scene.at
    return place_called(place.value, d.lexicon, d.language) if isinstance(place, Text) else ""


@meaning("whether_seen")
def whether_seen(d: Discourse, node: Node) -> Report | Steps:
    """ "is there anybody in the waiting room?", "has Bob got a cup on his desk?"."""
    holder: Thing | None = d.get(node, "holder")  # whose desk "his desk" is
    thing: Thing = d.get(node, "thing") or d.get(node, "person_ref")
    there: Value | None = d.get(node, "at_place")  # "whether Bob has come back to his office"
    more = described(d, thing.text, node)
    if not thing.known:  # "whether the woman is lying down"
        thing = replace(thing, value=more.value)
    elif thing.person and (more.text != thing.text or does_something(node)):
        return looks_of(d, node)  # "is Alice sitting?"
    thing = replace(
        in_state(d, node, thing),
        place=thing.place or more.place or there,
        furniture=thing.furniture or more.furniture,
    )
    if thing.known and thing.person:  # "whether Bob is asleep"
        thing = replace(thing, value=more.value)
    if holder is not None and thing.place is None:  # what somebody has is where they work
        thing = replace(thing, place=place_called_after(d, holder.text, node.parts["holder"]))
    if isinstance(thing.place, Items):  # "in the lobby or in the kitchen"
        return located(d, thing)
    if node.production.fixed.get("own") and thing.place is None:
        thing = at_own_place(d, thing)
    named = named_some(d, thing)
    d.get(node, "for_whom")  # "whether there is a letter for Bob": "him"
    return Report(
        "yes_seen",
        Ask("sees", {"thing": sought(d, thing)}),
        thing.place,
        (("thing", named),),
        otherwise="nobody_seen" if named == d.language.phrase("somebody") else "no_seen",
        name="seen",
        thing=replace(thing, place=thing.place or d.scene.at),
    )


def named_some(d: Discourse, thing: Thing) -> str:
    """A thing as one speaks of it for the first time: "somebody", "a cup"."""
    if thing.person and thing.text == ANYONE:
        return d.language.phrase("somebody")
    called = d.called(thing.text)
    somebody = thing.known and thing.person
    return person_called(called, d.language) if somebody else some(called, d.language)


def does_something(node: Node) -> bool:
    """Whether it is said of a person by name what they are doing: "ist Clara wach"."""
    person = node.parts.get("person_ref")
    return isinstance(person, Node) and any(leaf.slot == "activity" for leaf in leaves(person))


@meaning("where_found")
def where_found(d: Discourse, node: Node) -> Steps:
    """ "where is the stapler?": look for it, come back and say where it is, unless somebody was
    asked just that, who has said it."""
    said = (
        told_as_asked(d, node.start, node.end) if asked_yet(d) and d.reports.last is None else None
    )
    if said is not None:
        return said.words
    thing: Thing = d.get(node, "thing") or d.get(node, "person_ref")
    part, last = node.parts.get("person_ref"), d.done[-1] if d.done else None
    again = thing.pronoun or (part is not None and what_it_means(part) == "person_pronoun")
    if (
        again
        and isinstance(last, If)
        and last == d.reports.told
        and mentions((last.condition,), thing.value)
    ):
        return []  # "where is Victor? Go and see where he is": looked for already
    if thing.text == ANYONE and (thing.pronoun or thing.here):  # "where is that?", of a place
        raise NotUnderstood(d.language.phrase("where_is_there"), gap=(node.start, node.end))
    if thing.person and thing.every:  # "where is everyone?": a search ends with the first
        part = node.parts.get("person_ref", node)
        words = d.words(part.start, part.end)
        raise NotUnderstood(d.language.phrase("find_one", things=words), gap=(part.start, part.end))
    return located(d, thing)


def told_where(d: Discourse, thing: Thing | None) -> Told:
    """ "where the wheelchair is", if no places were spoken of: it may be anywhere."""
    if thing is None or thing.pronoun:
        raise NotUnderstood(d.language.phrase("which_places"))
    return Told(located(d, thing), [])


def located(d: Discourse, thing: Thing) -> Steps:
    """Look for something or somebody, come back and say where it is."""
    if d.done and d.done[-1] == found(d, thing):
        d.done.pop()  # "find the cup and tell me where it is"
    anyone = thing.person and (thing.known or thing.text == ANYONE)
    known = named_some(d, thing) if anyone else the(d.called(thing.text), d.language)
    name = d.variable("place")
    start = d.start()
    back = Call("goto", {"place": start})
    told = d.say("it_is_at", thing=known, place=Recall(name))
    d.went(start)
    return [
        If(
            whether_found(d, thing),
            (Remember(name, Ask("location")), back, told),
            (back, not_found(d, thing)),
        )
    ]


@meaning("counted_there")
def counted_there(d: Discourse, node: Node) -> Report:
    """ "How many people are in the kitchen, and how many in the lobby?"."""
    if d.reports.last_counted is None:
        raise NotUnderstood(d.language.phrase("count_what"))
    spot: Where = d.get(node, "spot")
    return count_report(
        d, replace(d.reports.last_counted, place=spot.place, furniture=spot.furniture)
    )
