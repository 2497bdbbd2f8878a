"""What the robot is told to do: go, bring, say, show, look happy ...

Commands that are one robot method with its parameters need no code here. What stands here takes
several steps, or depends on what was said before.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import (
    ANYONE,
    Ambiguous,
    Discourse,
    NotUnderstood,
    Steps,
    Thing,
    Where,
    as_value,
    capital,
)
from grammar.language import spoken_name
from grammar.meanings.nouns import is_me, kind_places, sought, thing_it
from grammar.meanings.registry import meaning
from grammar.plan import (
    Ask,
    Call,
    ForEach,
    Forever,
    Holds,
    If,
    Items,
    Number,
    Recall,
    Text,
    Value,
)

# --- going


def go(d: Discourse, place: Value) -> Steps:
    """Drive there, unless that is where the robot is by what was said."""
    d.place = place
    if d.at == place:
        return []
    d.went(place)
    return [Call("goto", {"place": place})]


@meaning("go")
def go_to(d: Discourse, node: Node) -> Steps:
    """Drive to a place; to a piece of furniture, that is to where it stands."""
    spot: Where = d.get(node, "spot") or Where(d.get(node, "place"))
    if spot.place is None:
        return look_for(d, Thing(Text(str(spot.furniture))))
    d.went(spot.place)
    return [Call("goto", {"place": spot.place})]


@meaning("go_find")
def go_find(d: Discourse, node: Node) -> Steps:
    """ "go to the kitchen to find the cup"."""
    going = go_to(d, node)
    return [*going, *d.build(node.parts["then"])]


@meaning("go_places")
def go_places(d: Discourse, node: Node) -> Steps:
    """ "go to the lobby, the pharmacy and the kitchen"."""
    steps: Steps = []
    for place in [d.get(node, "place"), *d.get(node, "place_list")]:
        d.went(place)
        steps.append(Call("goto", {"place": place}))
    return steps


@meaning("go_point")
def go_point(d: Discourse, node: Node) -> Steps:
    arguments = {name: as_value(d.get(node, name)) for name in ("x", "y", "theta")}
    d.at = None
    return [
        Call("goto", {name: value for name, value in arguments.items() if node.parts.get(name)})
    ]


@meaning("in_place")
def in_place(d: Discourse, node: Node) -> Steps:
    """ "in the kitchen, count the cups": go there first."""
    spot: Where = d.get(node, "spot")
    going = go(d, spot.place) if spot.place is not None else []
    d.at_furniture = spot.furniture
    inner: Steps = d.build(node.parts["then"])
    d.at_furniture = None
    return [*going, *inner]


@meaning("come_back")
def come_back(d: Discourse, node: Node) -> Steps:
    """Back to where the command was given."""
    start = d.start()
    d.went(start)
    return [Call("goto", {"place": start})]


@meaning("go_person")
def go_person(d: Discourse, node: Node) -> Steps:
    person: Thing = d.get(node, "person_ref")
    if is_me(person):
        return come_back(d, node)
    return look_for(d, person)


@meaning("move")
def move(d: Discourse, node: Node) -> Steps:
    metres = float(d.get(node, "metres"))
    if node.production.fixed.get("back"):
        metres = -metres
    d.at = None
    return [Call("move", {"metres": as_value(metres)})]


@meaning("turn")
def turn(d: Discourse, node: Node) -> Steps:
    degrees = float(d.get(node, "degrees"))
    side = d.get(node, "side", "left")
    return [Call("turn", {"degrees": as_value(-degrees if side == "right" else degrees)})]


@meaning("drive")
def drive(d: Discourse, node: Node) -> Steps:
    linear = float(d.get(node, "linear", 0))
    if node.production.fixed.get("back"):
        linear = -linear
    angular = float(d.get(node, "angular", 0))
    if d.get(node, "side", "left") == "right":
        angular = -angular
    seconds = as_value(d.get(node, "seconds"))
    d.at = None
    return [
        Call(
            "drive", {"linear": as_value(linear), "angular": as_value(angular), "seconds": seconds}
        )
    ]


@meaning("dock")
def dock(d: Discourse, node: Node) -> Steps:
    d.at = None
    return [Call("dock")]


@meaning("wait")
def wait(d: Discourse, node: Node) -> Steps:
    return [Call("wait", {"seconds": as_value(d.get(node, "seconds"))})]


@meaning("wait_for")
def wait_for(d: Discourse, node: Node) -> Steps:
    thing = noun_of(d, node)
    timeout = d.get(node, "seconds")
    steps = go(d, thing.place) if thing.place is not None else []
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if timeout is not None:
        arguments["timeout"] = as_value(timeout)
    if thing.person:
        d.person = d.person or thing
        d.with_person = thing.value
    return [*steps, Call("wait_for", arguments)]


@meaning("patrol")
def patrol(d: Discourse, node: Node) -> Steps:
    """ "drive back and forth between the lobby and the kitchen"."""
    places: list[Value] = [d.get(node, "place"), *d.get(node, "place_list")]
    d.at = None
    return [Call("goto", {"place": place}) for place in places]


# --- people


@meaning("guide")
def guide(d: Discourse, node: Node) -> Steps:
    """Lead a person to a place; go and find them first if they are somebody by name."""
    pronoun = node.parts.get("person_ref")
    if pronoun is not None and d.thing_last and speaks_of_things(d, pronoun):
        return carry_it(d, node)
    thing = led(d, node)
    source: Where | None = d.get(node, "source")
    if source is not None and source.place is not None:
        thing = replace(thing, place=source.place, here=False)
    steps = meet(d, thing)
    spot: Where = d.get(node, "spot") or Where(d.get(node, "place"))
    if spot.place is None:
        raise NotUnderstood(d.language.phrase("guide_needs_place"))
    return [*steps, lead(d, thing, spot.place)]


def led(d: Discourse, node: Node) -> Thing:
    """Who is to be led: "me" is whoever is here."""
    person: Thing | None = d.get(node, "person_ref")
    if person is None or is_me(person):
        return Thing(Text(ANYONE), person=True, here=True)
    return person


def lead(d: Discourse, person: Thing, place: Value) -> Call:
    d.at = d.place = place
    d.with_person = person.value
    d.person = replace(person, place=None, furniture=None, here=True)
    d.thing_last = False
    return Call("guide", {"person": person.value, "place": place})


@meaning("guide_back")
def guide_back(d: Discourse, node: Node) -> Steps:
    """ "bring her back": to where the command was given."""
    thing = led(d, node)
    steps = meet(d, thing)
    return [*steps, lead(d, thing, d.start())]


@meaning("guide_nowhere")
def guide_nowhere(d: Discourse, node: Node) -> Steps:
    """ "guide Bob": asks back where to."""
    who = named(d, led(d, node))
    words = who if isinstance(who, str) else d.language.phrase("somebody")
    to_place = d.language.speech["to_place"]
    raise Ambiguous(
        d.language.phrase("guide_where", person=words),
        node.end,
        node.end,
        tuple(
            to_place.format(place=spoken_name(place.name, d.language)) for place in d.lexicon.places
        ),
    )


def speaks_of_things(d: Discourse, pronoun: Leaf | Node) -> bool:
    """Whether a pronoun may stand for things as well as for people: "them"."""
    return d.norms(pronoun.start, pronoun.end)[-1] in d.language.speech.get("things_too", ())


def carry_it(d: Discourse, node: Node) -> Steps:
    """ "take them to the kitchen", where "they" are cups."""
    assert d.thing is not None
    spot: Where = d.get(node, "spot") or Where(d.get(node, "place"))
    return deliver(d, replace(d.thing, pronoun=True), None, spot)


@meaning("statement")
def statement(d: Discourse, node: Node) -> Steps:
    """ "there is a cup on the table": nothing to do, but now it is spoken of."""
    thing: Thing | None = d.get(node, "thing") or d.get(node, "person_ref")
    spot: Where | None = d.get(node, "from")
    if thing is None:  # "he is in the kitchen"
        thing = d.person or d.thing or Thing(Text(ANYONE), person=True)
    if spot is not None:
        thing = replace(thing, place=spot.place, furniture=spot.furniture)
    if thing.person:
        d.person, d.thing_last = thing, False
        d.with_person = None
    else:
        d.thing, d.thing_last = thing, True
    return []


@meaning("guide_list")
def guide_list(d: Discourse, node: Node) -> Steps:
    """ "guide the visitors through all labs"."""
    person: Thing | None = d.get(node, "person_ref")
    who = Text(ANYONE) if person is None or is_me(person) else person.value
    variable = d.variable("place")
    d.at = None
    return [
        ForEach(
            variable,
            kind_places(d, d.get(node, "kinds")),
            (Call("guide", {"person": who, "place": Recall(variable)}),),
        )
    ]


@meaning("follow")
def follow(d: Discourse, node: Node) -> Steps:
    person = led(d, node)
    spot: Where | None = d.get(node, "spot")
    steps = meet(d, person)
    arguments: dict[str, Value] = {"person": person.value}
    d.at = None
    if spot is not None and spot.place is not None:
        arguments["to"] = d.at = d.place = spot.place
    d.with_person = person.value
    d.person = replace(person, place=None, furniture=None, here=True)
    d.thing_last = False
    return [*steps, Call("follow", arguments)]


def meet(d: Discourse, person: Thing) -> Steps:
    """Find a person, unless they are here by what was said."""
    if person.here or d.with_person == person.value:
        return []
    if not person.known and person.place is None:
        return []
    d.with_person = person.value
    d.at = person.place
    if person.place is not None:
        d.place = person.place
    return [found(d, person)]


def found(d: Discourse, thing: Thing) -> Call:
    """The call that looks for a thing or a person."""
    arguments: dict[str, Value] = {"thing": sought(d, thing)}
    if thing.place is not None:
        arguments["place"] = thing.place
    return Call("find", arguments)


@meaning("greet")
def greet(d: Discourse, node: Node) -> Steps:
    person: Thing | None = d.get(node, "person_ref")
    name = person.text if person is not None and person.known else ""
    words = d.say("hello_name", name=name) if name else d.say("hello")
    return speak_to(d, person, [words])


def speak_to(d: Discourse, person: Thing | None, steps: Steps) -> Steps:
    """Say something to a person: here, or where they are found."""
    if person is None or is_me(person) or person.here or person.value == d.with_person:
        return steps
    if not person.known and person.place is None and d.at is not None:
        return steps  # "go to the lobby and tell the visitors ..."
    if not person.known and person.place is None and person.plural:
        return steps
    if not person.known and person.place is not None and (person.plural or person.text == ANYONE):
        return [*go(d, person.place), *steps]
    d.at = person.place
    d.with_person = person.value
    return [
        If(Holds(Ask("find", found(d, person).arguments)), tuple(steps), (not_found(d, person),))
    ]


def not_found(d: Discourse, thing: Thing) -> Call:
    return d.say("not_found", thing=named(d, thing))


def named(d: Discourse, thing: Thing) -> Value | str:
    """A thing as it is spoken of: "the stapler", "Alice"."""
    if not isinstance(thing.value, Text):
        return thing.value
    if thing.known and thing.person:
        return thing.value.value
    return d.language.phrase("the", noun=thing.value.value)


# --- things


def noun_of(d: Discourse, node: Node) -> Thing:
    """The thing or person of a command."""
    thing: Thing | None = d.get(node, "thing")
    if thing is None:
        person: Thing = d.get(node, "person_ref")
        thing = Thing(Text(ANYONE), person=True, here=True) if is_me(person) else person
    spot: Where | None = d.get(node, "from")
    if spot is not None:
        return replace(thing, place=spot.place, furniture=spot.furniture)
    return thing


def look_for(d: Discourse, thing: Thing) -> Steps:
    d.at = thing.place
    if thing.place is not None:
        d.place = thing.place
    d.with_person = thing.value if thing.person else None
    if thing.person:
        d.person, d.thing_last = thing, False
    else:
        d.thing, d.thing_last = thing, True
    return [found(d, thing)]


@meaning("find")
def find(d: Discourse, node: Node) -> Steps:
    thing = noun_of(d, node)
    if thing.place is None and d.at is not None:
        thing = replace(thing, place=d.at)  # "go to the kitchen and find the cup"
    return look_for(d, thing)


@meaning("grab")
def grab(d: Discourse, node: Node) -> Steps:
    thing = noun_of(d, node)
    if thing.place is not None and thing.place != d.at:
        return pick_up(d, thing)
    d.holding = thing.value
    d.thing, d.thing_last = thing, True
    return [Call("grab", {"thing": sought(d, thing)})]


def pick_up(d: Discourse, thing: Thing) -> Steps:
    """Find a thing and take it; nothing if it is in the hand by what was said."""
    if d.holding == thing.value:
        return []
    take_back_delivery(d, thing)
    if d.holding == thing.value:
        return []
    last = d.done[-1] if d.done else None
    looked = isinstance(last, Call) and last == found(d, thing)
    if isinstance(last, Call) and last.method == "find" and thing.pronoun:
        looked = True  # "find the cup and bring it to me"
    is_here = thing.here or (d.at is not None and thing.place in (None, d.at))
    steps: Steps = [] if looked or is_here else look_for(d, thing)
    d.holding = thing.value
    d.thing, d.thing_last = thing, True
    return [*steps, Call("grab", {"thing": sought(d, thing)})]


def take_back_delivery(d: Discourse, thing: Thing) -> None:
    """ "get the cup and put it on the table": "get" alone would have handed it to the speaker."""
    if d.delivered == thing.value and len(d.done) >= 2:
        del d.done[-2:]
        d.delivered = None
        d.holding = thing.value
        d.at = d.at_pick_up


@meaning("put")
def put(d: Discourse, node: Node) -> Steps:
    """ "put the cup on the table", "... in the kitchen", "... down"."""
    thing: Thing = d.get(node, "thing") or thing_it(d, node)
    source: Where | None = d.get(node, "from")
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    spot: Where = d.get(node, "where") or Where()
    last = d.done[-1] if d.done else None
    if isinstance(last, Call) and last == Call("put", {"thing": thing.value}):
        d.done.pop()  # "carry it to the ward and put it on the table": put down once
        d.holding = thing.value
    take_back_delivery(d, thing)
    if d.holding != thing.value and spot == Where():
        return [Call("put", {"thing": thing.value})]
    return deliver(d, thing, None, spot)


@meaning("bring")
def bring(d: Discourse, node: Node) -> Steps:
    """Fetch a thing and hand it to a person, or put it down at a spot."""
    thing: Thing = d.get(node, "thing") or thing_it(d, node)  # "and deliver to Bob"
    source: Where | None = d.get(node, "from")
    if source is not None:
        thing = replace(thing, place=source.place, furniture=source.furniture)
    person: Thing | None = d.get(node, "person_ref")
    return deliver(d, thing, person, d.get(node, "where"))


def deliver(d: Discourse, thing: Thing, person: Thing | None, spot: Where | None) -> Steps:
    """Pick a thing up, go where it is to be, and put it down or hand it over."""
    no_way = spot is not None and spot.place is None and thing.place is None
    if no_way and d.holding != thing.value and not thing.pronoun:
        steps: Steps = [Call("grab", {"thing": sought(d, thing)})]  # both are here
    else:
        steps = pick_up(d, thing)
    d.holding = None
    d.thing, d.thing_last = thing, True
    give: dict[str, Value] = {"thing": thing.value}
    if spot is not None:
        if spot.place is not None:
            steps += go(d, spot.place)
        if spot.furniture:
            give["where"] = Text(spot.furniture)
        return [*steps, Call("put", give)]
    if person is None or is_me(person):
        start = d.start()
        steps.append(Call("goto", {"place": start}))
        d.at_pick_up = d.at
        d.went(start)
        d.delivered = thing.value if person is None else None
        return [*steps, Call("give", give)]
    if not person.here:
        steps += meet(d, person) or look_for(d, person)
    d.thing, d.thing_last = thing, True
    if person.text != ANYONE:
        give["person"] = person.value
    return [*steps, Call("give", give)]


# --- speaking


@meaning("say")
def say(d: Discourse, node: Node) -> Steps:
    """Speak a text, in the speaker's own words."""
    text = spoken(d, node)
    arguments: dict[str, Value] = {"text": text}
    language = d.get(node, "language")
    if language:
        arguments["language"] = Text(language)
    return speak_to(d, d.get(node, "person_ref"), [Call("say", arguments)])


def spoken(d: Discourse, node: Node) -> Value:
    """What is to be said: a quotation word for word, other text as a sentence."""
    quote = node.parts.get("quote")
    if quote is not None:
        return Text(str(d.build(quote)))
    part = node.parts["text"]
    return Text(sentence_form(d.words(part.start, part.end)))


def sentence_form(text: str) -> str:
    text = text.strip().strip('"“”„«»').strip()
    return capital(text) if text[-1:] in ".!?…" else capital(text) + "."


@meaning("say_it")
def say_it(d: Discourse, node: Node) -> Steps:
    """ "and say it": the answer or the code of before."""
    name = d.answer or d.code
    if name is None:
        raise NotUnderstood(d.language.phrase("say_what"))
    return speak_to(d, d.get(node, "person_ref"), [Call("say", {"text": Recall(name)})])


@meaning("phrase")
def phrase(d: Discourse, node: Node) -> Steps:
    """Say what the language holds ready: "introduce yourself", "thank them"."""
    return speak_to(d, d.get(node, "person_ref"), [d.say(str(node.production.fixed["phrase"]))])


@meaning("set_volume")
def set_volume(d: Discourse, node: Node) -> Steps:
    percent = round(float(d.get(node, "percent")))
    if not 0 <= percent <= 100:
        raise NotUnderstood(d.language.phrase("volume_range"))
    return [Call("set_volume", {"percent": Number(percent)})]


# --- screen


@meaning("show")
def show(d: Discourse, node: Node) -> Steps:
    url = d.get(node, "url")
    if url:
        address = str(url) if "://" in str(url) else f"https://{url}"
        return [Call("show", {"url": Text(address)})]
    quote = node.parts.get("quote")
    part = quote or node.parts.get("text")
    if part is None:
        name = d.answer or d.code
        if name is None:
            raise NotUnderstood(d.language.phrase("show_what"))
        return [Call("show", {"text": Recall(name)})]
    return [Call("show", {"text": Text(str(d.build(part)))})]


@meaning("touch")
def touch(d: Discourse, node: Node) -> Steps:
    """Let somebody choose on the touchscreen; the choice can be used afterwards."""
    from grammar.meanings.questions import remember_answer, split_options

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


# --- body


@meaning("joint")
def joint(d: Discourse, node: Node) -> Steps:
    return [
        Call(
            "joint",
            {"name": as_value(d.get(node, "joint")), "degrees": as_value(d.get(node, "degrees"))},
        )
    ]


@meaning("gesture")
def gesture(d: Discourse, node: Node) -> Steps:
    call = Call("gesture", {"name": as_value(d.get(node, "gesture"))})
    return speak_to(d, d.get(node, "person_ref"), [call])


@meaning("skill")
def skill(d: Discourse, node: Node) -> Steps:
    return [Call("do", {"skill": as_value(d.get(node, "skill"))})]


@meaning("emotion_gesture")
def emotion_gesture(d: Discourse, node: Node) -> Steps:
    return [Call("emotion", {"name": as_value(d.get(node, "emotion"))})]


@meaning("greet_all")
def greet_all(d: Discourse, node: Node) -> Steps:
    """ "greet everybody who comes in": again and again."""
    return [Forever((Call("wait_for", {"thing": Text(ANYONE)}), d.say("hello")))]


@meaning("refused")
def refused(d: Discourse, node: Node) -> Steps:
    """A sentence that is understood as something this robot must not or cannot do."""
    raise NotUnderstood(d.language.phrase(str(node.production.fixed["phrase"])))


@meaning("unknown_contact")
def unknown_contact(d: Discourse, node: Node) -> Steps:
    words = d.words(node.parts["unknown"].start, node.parts["unknown"].end)
    raise NotUnderstood(d.language.phrase("unknown_contact", name=words))
