"""Telling what the robot finds out: the time, the place, what it sees, how many there are.

What is to be told is a `Report`: how to find it out and the phrase it is told with. A report about
somewhere else that is for the speaker is brought back to them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from grammar.chart import Leaf, Node
from grammar.discourse import (
    ANYONE,
    START,
    Ambiguous,
    Discourse,
    NotUnderstood,
    Steps,
    Thing,
    Where,
    as_value,
)
from grammar.meanings import news
from grammar.meanings.finding import is_here, look_for, meet, not_found, speak_to
from grammar.meanings.nouns import described, is_me
from grammar.meanings.places import kind_places, sought
from grammar.meanings.registry import meaning
from grammar.meanings.surveys import in_loop, moved
from grammar.naming import place_called, some, the
from grammar.plan import (
    Ask,
    Call,
    Choice,
    Compare,
    Holds,
    If,
    Items,
    Number,
    Recall,
    Remember,
    Step,
    Text,
    Truth,
    Value,
)
from grammar.tidy import nodes
from grammar.wordforms import plural, singular


@dataclass(frozen=True)
class Report:
    """Something to tell."""

    phrase: str
    value: Value | None = None
    """What the phrase tells, found out when it is spoken."""
    place: Value | None = None
    """Where to find it out."""
    words: tuple[tuple[str, str], ...] = ()
    """Fixed words of the phrase."""
    otherwise: str | None = None
    """The phrase for a value that is false; then `phrase` is for one that is true."""
    name: str = "result"
    """What the value is called when it is remembered."""
    before: tuple[Step, ...] = ()
    """Steps that find it out, where one value is not enough."""
    about_here: bool = True
    """Whether it is about where the robot is, and so has to be found out there."""


@meaning("report")
def report(d: Discourse, node: Node) -> Steps:
    if node.production.fixed.get("joke"):
        return told(d, joke(d), d.get(node, "person_ref"))
    person: Thing | None = d.get(node, "person_ref")
    found: Report | Steps = d.get(node, "info")
    if isinstance(found, list):
        return speak_to(d, person, found)
    asked_by_me = person is None or is_me(person)
    fixed = node.production.fixed
    d.report_open = person is None and bool(fixed.get("open", not fixed.get("to_me")))
    d.report_counts = person is None and bool(fixed.get("counted"))
    back = bool(node.production.fixed.get("to_me")) or is_me(person)
    steps: Steps = []
    if found.place is not None and found.place != d.at:
        d.start()
        steps.append(Call("goto", {"place": found.place}))
        d.went(found.place)
        back = back or asked_by_me
    steps += found.before
    if (
        back
        and asked_by_me
        and d.at is not None
        and not d.in_loop
        and found.about_here
        and found.value is not None
    ):
        start = d.start()
        if not isinstance(found.value, Recall):
            name = d.variable(found.name)
            steps.append(Remember(name, found.value))
            found = replace(found, value=Recall(name))
        steps.append(Call("goto", {"place": start}))
        d.went(start)
        return [*steps, *told(d, found, None)]
    far = person is not None and not is_here(d, person) and found.about_here
    if far and found.value is not None and not isinstance(found.value, Recall):
        name = d.variable(found.name)  # found out here, told there
        steps.append(Remember(name, found.value))
        found = replace(found, value=Recall(name))
    return [*steps, *told(d, found, person)]


def told(d: Discourse, found: Report, person: Thing | None) -> Steps:
    """Say it."""
    saying = _saying(d, found)
    d.report, d.report_step = found, saying
    d.answer = d.news = d.counted = d.checked = None
    return speak_to(d, person, [saying])


def _saying(d: Discourse, found: Report) -> Call | If:
    words = dict(found.words)
    if found.otherwise is not None:
        assert found.value is not None
        yes, no = d.say(found.phrase, **words), d.say(found.otherwise, **words)
        return If(Holds(found.value), (yes,), (no,))
    values: dict[str, Value | str] = {**words}
    if found.value is not None:
        values["value"] = found.value
    return d.say(found.phrase, **values)


# --- about the robot


@meaning("about_robot")
def about_robot(d: Discourse, node: Node) -> Report:
    fixed = node.production.fixed
    value = Ask(str(fixed["method"]), {}, fixed.get("field"))
    return Report(str(fixed["phrase"]), value, about_here=False)


@meaning("fixed_phrase")
def fixed_phrase(d: Discourse, node: Node) -> Report:
    return Report(str(node.production.fixed["phrase"]), about_here=False)


@meaning("some_joke")
def some_joke(d: Discourse, node: Node) -> Report:
    return joke(d)


def joke(d: Discourse) -> Report:
    jokes = [text for name, text in d.language.phrases.items() if name.startswith("joke_")]
    return Report(
        "only", Choice(Items(tuple(Text(each) for each in jokes))), name="joke", about_here=False
    )


@meaning("known_places")
def known_places(d: Discourse, node: Node) -> Report:
    return Report("places_are", kind_places(d, d.get(node, "kind")), about_here=False)


@meaning("last_log")
def last_log(d: Discourse, node: Node) -> Report:
    lines = d.get(node, "lines")
    arguments: dict[str, Value] = {} if lines is None else {"lines": as_value(lines)}
    return Report("log_says", Ask("log", arguments), about_here=False)


# --- about what is seen


@meaning("names_here")
def names_here(d: Discourse, node: Node) -> Report:
    """ "who is in the lobby?", "the name of the person in the kitchen"."""
    person: Thing | None = d.get(node, "person_ref")
    if person is None:
        person = described(d, ANYONE, node)
        d.person = Thing(Text(ANYONE), person.place, person=True, here=True)
    return Report("people_seen", Ask("people"), person.place, name="names")


@meaning("seen_here")
def seen_here(d: Discourse, node: Node) -> Report:
    place = described(d, "", node)
    if place.furniture:
        return things_on(d, place)
    return Report("objects_seen", Ask("objects"), place.place, name="things")


def things_on(d: Discourse, place: Thing) -> Report:
    """ "what is on the bed?": all that is on it, or that there is nothing."""
    thing = replace(place, value=Text(d.language.phrase("objects")))
    all_of_it = replace(place, value=Text(d.language.phrase("all_objects")))
    one, everything = sought(d, thing), sought(d, all_of_it)
    assert isinstance(one, Text)
    where = d.called(one.value.removeprefix(thing.text).strip())
    words = d.variable("description")
    look = Remember(words, Ask("describe", {"thing": everything}))
    before = (
        Remember(words, d.sentence("nothing_there", where=where)),
        If(Holds(Ask("sees", {"thing": one})), (look,)),
    )
    return Report("only", Recall(words), place.place, before=before)


@meaning("kind_seen")
def kind_seen(d: Discourse, node: Node) -> Report:
    """ "which cups are on the table?": all of them in a sentence, or that there are none."""
    head = node.parts["head"]
    assert isinstance(head, Leaf)
    name = str(head.value[0]) if head.value else d.noun_words(head.start, head.end)
    thing = described(d, singular(name, d.language), node, lies_about=True)
    words = d.variable("description")
    several = replace(thing, value=Text(plural(thing.text, d.language)))
    look = Remember(words, Ask("describe", {"thing": sought(d, several)}))
    none = d.sentence("none_seen", things=d.called(several.text))
    seen = Holds(Ask("sees", {"thing": sought(d, thing)}))
    before = (Remember(words, none), If(seen, (look,)))
    return Report("only", Recall(words), thing.place, before=before)


@meaning("looks_of")
def looks_of(d: Discourse, node: Node) -> Report:
    """How something looks; a description says it all."""
    thing: Thing = (
        d.get(node, "thing")
        or d.get(node, "person_ref")
        or Thing(Text(ANYONE), person=True, here=True)
    )
    extra = described(d, "", node)
    place = thing.place or extra.place
    return Report("only", Ask("describe", {"thing": sought(d, thing)}), place, name="description")


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
    value = sought(d, thing)
    d.thing, d.thing_last = replace(thing, here=True), True
    return Report("only", Ask("describe", {"thing": value}), thing.place, name="description")


def _best(d: Discourse, node: Node) -> Thing:
    head = node.parts.get("head")
    noun = "object"
    if isinstance(head, Leaf):
        said = str(head.value[0]) if head.value else d.noun_words(head.start, head.end)
        noun = singular(said, d.language)
    return described(d, noun, node)


@meaning("counted_info")
def counted_info(d: Discourse, node: Node) -> Report:
    """ "how many cups are in the kitchen?"."""
    thing: Thing = d.get(node, "thing")
    more = described(d, thing.text, node)
    first: Where | None = d.get(node, "spot_first")
    thing = replace(
        thing,
        value=more.value,
        place=thing.place or more.place or (first.place if first else None),
        furniture=thing.furniture or more.furniture or (first.furniture if first else None),
    )
    d.last_counted = thing
    return count_report(d, thing)


def count_report(d: Discourse, thing: Thing) -> Report:
    phrase_words = d.called(thing.text)
    spot = _spot_words(d, thing)
    noun, _, rest = phrase_words.partition(" ") if thing.person else (phrase_words, "", "")
    things = f"{plural(noun, d.language)} {rest}".strip()
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
    place = thing.place or d.at
    return place_called(place.value, d.lexicon, d.language) if isinstance(place, Text) else ""


@meaning("whether_seen")
def whether_seen(d: Discourse, node: Node) -> Report:
    """ "is there anybody in the waiting room?", "has Bob got a cup on his desk?"."""
    d.get(node, "holder")  # whose desk "his desk" is
    thing: Thing = d.get(node, "thing") or d.get(node, "person_ref")
    more = described(d, thing.text, node)
    thing = replace(
        thing, place=thing.place or more.place, furniture=thing.furniture or more.furniture
    )
    named = named_some(d, thing)
    return Report(
        "yes_seen",
        Ask("sees", {"thing": sought(d, thing)}),
        thing.place,
        (("thing", named),),
        otherwise="nobody_seen" if named == d.language.phrase("somebody") else "no_seen",
        name="seen",
    )


def named_some(d: Discourse, thing: Thing) -> str:
    """A thing as one speaks of it for the first time: "somebody", "a cup"."""
    if thing.person and thing.text == ANYONE:
        return d.language.phrase("somebody")
    called = d.called(thing.text)
    return called if thing.known and thing.person else some(called, d.language)


@meaning("where_found")
def where_found(d: Discourse, node: Node) -> Steps:
    """ "where is the stapler?": look for it, come back and say where it is."""
    thing: Thing = d.get(node, "thing") or d.get(node, "person_ref")
    called = d.called(thing.text)
    known = called if thing.known and thing.person else the(called, d.language)
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if thing.place is not None:
        arguments["place"] = thing.place
    name = d.variable("place")
    start = d.start()
    back = Call("goto", {"place": start})
    told = d.say("it_is_at", thing=known, place=Recall(name))
    d.went(start)
    return [
        If(
            Holds(Ask("find", arguments)),
            (Remember(name, Ask("location")), back, told),
            (back, not_found(d, thing)),
        )
    ]


def kept(d: Discourse) -> str | None:
    """The variable with what the last report told; the report itself is dropped."""
    found: Report | None = d.report
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
    if found is None or found.value is None or at is None:
        return None
    if isinstance(found.value, Recall):
        del d.done[at]
        return found.value.name
    name = d.variable(found.name)
    d.done[at] = Remember(name, found.value)
    return name


def known_words(d: Discourse) -> Steps:
    """Say the last answer, those of all who were asked, or what the last code says."""
    if d.answer is not None:
        if d.surveys and in_loop(d, d.surveys[-1].call):
            return news.polled(d, d.polled_for or "answers", None).words
        return [Call("say", {"text": Recall(d.answer)})]
    if d.code is not None:
        return [d.say("code_is", value=Recall(d.code))]
    raise NotUnderstood(d.language.phrase("say_what"))


@meaning("tell_that")
def tell_that(d: Discourse, node: Node) -> Steps:
    """ "and tell Alice how many there are": what was found out before, told to somebody else."""
    return told_again(d, d.get(node, "person_ref"))


def told_again(d: Discourse, person: Thing | None) -> Steps:
    """Tell somebody what was told or answered last."""
    again = news.told_again(d, person)
    if again is not None:
        return again
    if person is None or is_me(person):
        return tell_speaker(d)
    if d.claim is not None and d.claim.known == d.known_by_now():
        return speak_to(d, person, [d.claim.saying])
    if d.report is None:
        return speak_to(d, person, known_words(d))
    return retold(d, person)


def retold(d: Discourse, person: Thing | None) -> Steps:
    """Tell the last report to somebody else, or somewhere else."""
    found: Report = d.report
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
    if at is not None and not isinstance(found.value, Recall) and found.value is not None:
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
        found = replace(found, value=Recall(name))
    elif at is not None and at == len(d.done) - 1:
        d.done.pop()  # it is told to them and not to the speaker
        if d.done and d.done[-1] == Call("goto", {"place": Recall(START)}):
            d.done.pop()
            d.at = found.place
    return told(d, found, person)


@meaning("report_told")
def report_told(d: Discourse, node: Node) -> news.Told:
    """ "how many people are in the lobby", "what time it is", as one of several things to tell."""
    found: Report | Steps = d.get(node, "info")
    return news.Told(found, []) if isinstance(found, list) else told_report(d, found)


def told_report(d: Discourse, found: Report) -> news.Told:
    first: Steps = []
    if found.place is not None and found.place != d.at:
        first.append(Call("goto", {"place": found.place}))
        d.went(found.place)
    if found.about_here and found.value is not None:
        name = d.variable(found.name)
        first.append(Remember(name, found.value))
        found = replace(found, value=Recall(name))
    return news.Told([_saying(d, found)], first)


@meaning("counted_too")
def counted_too(d: Discourse, node: Node) -> news.Told:
    """ "how many people are in the kitchen and how many in the lobby"."""
    if d.last_counted is None:
        raise NotUnderstood(d.language.phrase("count_what"))
    spot: Where = d.get(node, "spot")
    thing = replace(d.last_counted, place=spot.place, furniture=spot.furniture)
    return told_report(d, count_report(d, thing))


@meaning("whether_told")
def whether_told(d: Discourse, node: Node) -> news.Told:
    """ "whether there are five chairs in the lobby", "whether the kitchen is empty": of any
    condition, found out there and told elsewhere."""
    part = node.parts["condition"]
    condition = d.get(node, "condition")
    before, d.pending = d.pending, []
    d.checked = d.variable("so")
    no, yes = Remember(d.checked, Truth(False)), Remember(d.checked, Truth(True))
    clause = d.words(part.start, part.end)
    told_yes, told_no = d.say("so_it_is", clause=clause), d.say("not_so", clause=clause)
    told = If(Holds(Recall(d.checked)), (told_yes,), (told_no,))
    d.report = None
    return news.Told([told], [*before, no, If(condition, (yes,))])


def checked(d: Discourse) -> Value | None:
    """What was checked last, for "if so" and "if not"; that nobody was named to tell it to is then
    no reason to tell the speaker."""
    if d.checked is not None and d.news is not None:
        news.take_back(d, d.news)
        return Recall(d.checked)
    found: Report | None = d.report
    if found is None or found.otherwise is None or found.value is None:
        return None
    if not d.report_open:
        return found.value if isinstance(found.value, Recall) else None
    name = found.value.name if isinstance(found.value, Recall) else None
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
    if at is None:
        return None
    if name is None:
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
    else:
        d.done.pop(at)
        _not_back_yet(d)
    d.report = replace(found, value=Recall(name))
    return Recall(name)


@meaning("found_told")
def found_told(d: Discourse, node: Node | None = None) -> news.Told:
    """ "the result", "it", "what you found out": whatever was found out last."""
    told: news.News | None = d.news
    if told is not None:
        news.take_back(d, told)
        return news.Told(told.words, [])
    if d.report is not None:
        return _report_again(d)
    if d.answer is not None and d.surveys:
        many = node is not None and bool(node.production.fixed.get("many"))
        each = "many" if many else d.polled_for or "each"
        return news.polled(d, each if in_loop(d, d.surveys[-1].call) else "answers", None)
    return news.Told(known_words(d), [])


def _report_again(d: Discourse) -> news.Told:
    """The last report, which then is told only as is said now."""
    found: Report = d.report
    at = next((at for at, step in enumerate(d.done) if step is d.report_step), None)
    if at is None:
        return summed_or_said(d, found)
    if found.value is not None and not isinstance(found.value, Recall):
        name = d.variable(found.name)
        d.done[at] = Remember(name, found.value)
        found = replace(found, value=Recall(name))
    elif at == len(d.done) - 1:
        d.done.pop()
        _not_back_yet(d)
    return news.Told([_saying(d, found)], [])


def summed_at_end(d: Discourse) -> Steps:
    """What was counted in a round that nobody was told of: brought back to the speaker."""
    from grammar.meanings.rounds import last_round

    at = last_round(d)
    found: Report | None = d.report
    if at is None or at != len(d.done) - 1 or found is None or not d.report_counts:
        return []
    if found.name != "count" or not any(each is d.report_step for each in nodes(d.done[at])):
        return []
    told = summed_or_said(d, found)
    return [*told.first, *news.go_back(d, []), *told.words]


def summed_or_said(d: Discourse, found: Report) -> news.Told:
    """What was counted in each place of a round; else the report as it is."""
    from grammar.meanings.rounds import last_round, summed_up

    if found.name == "count" and last_round(d) is not None:
        return summed_up(d, "each")
    return news.Told([_saying(d, found)], [])


def _not_back_yet(d: Discourse) -> None:
    """What was to be told to the speaker is told elsewhere: the way back comes to nothing."""
    if d.done and d.done[-1] == news.BACK:
        d.done.pop()
        d.at = None


@meaning("tell_me_that")
def tell_me_that(d: Discourse, node: Node) -> Steps:
    """ "and tell me": what was found out just before, brought back to the speaker."""
    return tell_speaker(d)


def tell_speaker(d: Discourse) -> Steps:
    again = news.told_again(d, None)
    if again is not None:
        return again
    last = d.done[-1] if d.done else None
    if last is not None and last is d.told:
        return []
    if d.claim is not None and d.claim.known == d.known_by_now():
        if d.at is None or d.at == Recall(START):
            return [d.claim.saying]
        start = d.start()
        d.went(start)
        return [Call("goto", {"place": start}), d.claim.saying]
    if d.report is not None and d.report_step is last and d.at is not None:
        start = d.start()
        if d.at == start:
            return []
        told_there = retold(d, None)
        d.went(start)
        return [Call("goto", {"place": start}), *told_there]
    if d.answer is None and d.code is None and d.thing is not None:
        if not (isinstance(last, Call) and last.method == "find"):
            raise NotUnderstood(d.language.phrase("say_what"))
        # "find the smallest cup and tell me what it is"
        what = Ask("describe", {"thing": sought(d, d.thing)})
        name = d.variable("description")
        start = d.start()
        d.went(start)
        saying = Call("say", {"text": Recall(name)})
        return [Remember(name, what), Call("goto", {"place": start}), saying]
    if d.answer is not None or d.code is not None:
        words = known_words(d)
        start = d.start()
        going = d.at is not None or moved(d.done)
        d.went(start)
        back = Call("goto", {"place": start})
        return [back, *words] if going and last != back else words
    if isinstance(last, Call) and last.method == "say":
        return []  # it is told already
    raise NotUnderstood(d.language.phrase("say_what"))


@meaning("scan")
def scan(d: Discourse, node: Node) -> Steps:
    """Scan a code, of a thing or on a person that is looked for first if it is not here; where
    nothing is done with the code, it is read out."""
    steps: Steps = []
    person: Thing | None = d.get(node, "person_ref")
    thing: Thing | None = d.get(node, "thing")
    if person is not None:
        steps = meet(d, person)
    elif thing is not None and not thing.here and not thing.pronoun:
        steps = look_for(d, thing)
    d.code = d.variable("code")
    d.answer = d.report = None
    return [*steps, Call("scan", {}, save_as=d.code)]


@meaning("tell")
def tell(d: Discourse, node: Node) -> Steps:
    """Say a phrase with the result of a robot method in it."""
    fixed = node.production.fixed
    selector = d.get(node, "selector")
    value = Ask(str(fixed["method"]), {"selector": as_value(selector)} if selector else {})
    return speak_to(d, d.get(node, "person_ref"), [d.say(str(fixed["phrase"]), value=value)])


@meaning("battery_low")
def battery_low(d: Discourse, node: Node) -> object:

    fixed = node.production.fixed
    return Compare(Ask("battery"), str(fixed["operator"]), Number(int(fixed["percent"])))


@meaning("offer_guide")
def offer_guide(d: Discourse, node: Node) -> Steps:
    """ "where is the lift?": the robot can show the way, if that is wanted."""
    place = d.get(node, "place")
    if not isinstance(place, Text):
        raise NotUnderstood(d.language.phrase("where_is_there"))
    name = place_called(place.value, d.lexicon, d.language)
    question = d.language.phrase("offer_guide", place=name)
    yes = d.language.phrase("take_me_to", place=name)
    raise Ambiguous(question, 0, len(d.tokens), (yes,))
