"""Asking people: reported speech becomes a direct question, choices become its options."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.discourse import ANYONE, Discourse, Steps, Thing, capital
from grammar.errors import NotUnderstood
from grammar.meanings.answered import says_the_same
from grammar.meanings.asking import Audience, asked, audience, put, remember_answer
from grammar.meanings.finding import go
from grammar.meanings.holders import asks_who_has, says_having
from grammar.meanings.options import (
    MOST_OPTIONS,
    names_people,
    numbers_offered,
    options_of,
    people_named,
    place_at_end,
    places_asked_for,
    places_named,
    without_little_words,
)
from grammar.meanings.persons import guest_for
from grammar.meanings.pronouns import (
    NOBODY_ELSE,
    about_another,
    called_as_asked,
    meant_in,
    named_themselves,
    none_for,
    of_each,
)
from grammar.meanings.references import nouns_of
from grammar.meanings.registry import meaning
from grammar.meanings.speaking import put_for
from grammar.meanings.verb_forms import base_form, in_past, one_each, past_base, perfect_form
from grammar.meanings.who_agreed import asks_for_some
from grammar.meanings.whom_asked import (
    all_meant,
    asked_in_each,
    gone_to,
    just_visited,
    several_of_a_kind,
    spoken_of,
    told_in_each,
)
from grammar.naming import some, the
from grammar.plan import (
    Ask,
    Call,
    ForEach,
    Forever,
    Items,
    Recall,
    Text,
    Value,
)
from grammar.texts.words import words_for
from grammar.tokens import COMMA
from grammar.wordforms import head_word, singular
from grammar.wordorder import parted

LONGEST_OFFERED: Final = 3
"""Words of a thing that somebody is asked about."""


@meaning("ask")
def ask(d: Discourse, node: Node) -> Steps:
    """Ask somebody a question and remember the answer."""
    person: Thing | None = guest_for(d, node.parts.get("person_ref"), d.get(node, "person_ref"))
    d.answers = replace(d.answers, message=node)
    question = node.parts.get("question")
    if person is None and isinstance(question, Node) and "asked_one" in question.parts:
        person = d.build(question.parts["asked_one"])  # "find out what Bob wants"
    there = told_in_each(d, node, person)
    if there is not None:
        return asked_in_each(d, there, lambda everybody: ask_one(d, node, everybody))
    if person is None:
        person = just_visited(d) or all_meant(d, node) or gone_to(d) or spoken_of(d)
    nobody = (
        person is None
        and d.scene.with_person is None
        and d.scene.at is None
        and not d.loops.in_loop
    )
    if nobody and node.production.fixed.get("of_those_there"):
        raise NotUnderstood(d.language.phrase("no_question"))
    if person is not None and person.coming:
        going = go(d, person.place) if person.place is not None else []
        waiting = Call("wait_for", {"thing": person.value})
        d.scene = replace(d.scene, person=replace(person, coming=False, place=None))
        return [*going, Forever((waiting, *ask_one(d, node, d.scene.person)))]
    steps = ask_one(d, node, person)
    if node.production.fixed.get("to_me"):
        d.answers = replace(d.answers, put=d.answers.surveys[-1])
    return steps


def ask_one(d: Discourse, node: Node, person: Thing | None) -> Steps:
    """Ask those who are there, or somebody who has to be found first."""
    person = several_of_a_kind(d, node, person)
    whom = audience(d, person)
    question = node.parts["question"]
    assert isinstance(question, Node)
    text, options = worded(d, question, whom)
    if whom.person is not None:
        called_as_asked(d, question, whom.person)
    scale = node.parts.get("scale")
    if scale is not None:  # "ask from one to ten how bad it is"
        options = numbers_offered(d, scale.start, scale.end)
        end = re.search(r"\s*[?.]?$", text)
        mark = text[end.start() :] if end else ""
        text = f"{text.removesuffix(mark)}, {d.words(scale.start, scale.end)}{mark}"
    arguments: dict[str, Value] = {"question": Text(text)}
    name = remember_answer(d, options, "answer")
    if options:
        arguments["options"] = Items(tuple(Text(each) for each in options))
    elif question.production.fixed.get("where"):
        if len(d.lexicon.places) <= MOST_OPTIONS:
            arguments["options"] = Ask("places")
        d.scene = replace(d.scene, place=Recall(name))
    elif (places := places_asked_for(d, question)) is not None:
        arguments["options"] = places
        d.scene = replace(d.scene, place=Recall(name))
    spoken_of = places_named(d, question.start, question.end)
    if len(spoken_of) == 1 and d.scene.place != Recall(name):
        d.scene = replace(
            d.scene, place=Text(spoken_of[0])
        )  # "ask whether they want to see the lab; take them there"
    # "ask Bob whether Alice is in; if so, tell her ..."
    d.has_named(*people_named(d, question.start, question.end))
    if whom.many and asks_for_some(d, question):
        d.answers = replace(d.answers, polled_for="who")
    if node.production.fixed.get("vote"):
        d.answers = replace(d.answers, polled_for="each")  # nobody asks who voted for what
    offered(d, question, options, name)
    return put(
        d, whom, Call("ask", arguments, save_as=name), options, nouns_of(d, question, options)
    )


def worded(d: Discourse, question: Node, whom: Audience) -> tuple[str, tuple[str, ...]]:
    """The words of a question for those who are asked, and the answers that it offers."""
    d.answers = replace(
        d.answers, asking_each=whom.many, asking_one=None if whom.many else whom.person
    )
    text: str = capital(put_for(d, "asked_singly", d.build(question)))
    options = named_themselves(d, options_of(d, question), whom.person)
    d.answers = replace(d.answers, asking_each=False, asking_one=None)
    return text, options


def ask_everybody_here(d: Discourse, start: int, end: int) -> Steps:
    """Whether they do what some words say: "wants coffee", "would like to come", "is ready"."""
    forms: dict[str, Any] | None = d.language.speech.get("poll_forms")
    first = d.tokens[start].norm
    known = forms is not None and any(first in forms[each] for each in ("be", "aux", "verbs"))
    if forms is None or not known or d.scene.at is None:  # only those who are where it was sent
        raise NotUnderstood(d.language.phrase("no_question"))
    kind = next((each for each in ("be", "aux") if first in forms[each]), "verb")
    verb = first if kind == "aux" else base_form(d, past_base(d, first) or first)
    form = forms["past" if kind == "verb" and past_base(d, first) else f"{kind}_form"]
    rest = turn_to_you(d, start + 1, end)
    text = capital(" ".join(form.format(verb=verb, rest=rest).split()).replace(" ?", "?"))
    options = (d.language.phrase("yes"), d.language.phrase("no"))
    answer = remember_answer(d, options, "answer")
    who = Recall(d.variable("person"))
    arguments: dict[str, Value] = {
        "question": Text(text),
        "options": Items(tuple(Text(each) for each in options)),
        "person": who,
    }
    call = asked(d, Call("ask", arguments, save_as=answer), options, who)
    return [ForEach(who.name, Ask("people"), (call,))]


def _no_thing(d: Discourse, wh: Leaf | Node | None) -> bool:
    """Whether what is asked for cannot be a thing: when, where, how."""
    words = set(d.norms(wh.start, wh.end)) if wh is not None else set()
    return bool(words & set(d.language.speech.get("asks_no_thing", ())))


def offered(d: Discourse, question: Node, options: tuple[str, ...], name: str) -> None:
    """What was asked about is "it" afterwards: a wheelchair that somebody may need, or whichever
    of tea and coffee they chose."""
    subject = question.parts.get("subject")
    if subject is not None and set(d.norms(subject.start, subject.end)) <= d.language.words_called(
        "speakers"
    ):
        subject = None  # "whether I may borrow the projector"
    rest = subject or question.parts.get("rest")
    d.answers = replace(d.answers, asked_for=None)
    if question.production.fixed.get("wanted"):
        asked_for = question.parts["noun"]
        what = singular(d.noun_words(asked_for.start, asked_for.end), d.language)
        if isinstance(asked_for, Node):  # "the key to the supply room"
            what = d.build(asked_for).text
        wanted = Text(what)
        held = wanted if d.language.phrase("yes") in options else None
        d.answers = replace(d.answers, asked_for=wanted, held=held)
        d.scene = d.scene.speaking_of(Thing(wanted, noun=head_word(what, d.language)))
        return
    counted = question.parts.get("wh")
    noun = counted.parts.get("noun") if isinstance(counted, Node) else None
    asks_thing = counted is not None and d.tokens[counted.start].norm in d.language.speech.get(
        "asks_thing", ()
    )
    if (
        asks_thing
        and not options
        and "subject" not in question.parts
        and d.scene.place != Recall(name)
    ):
        d.scene = replace(
            d.scene, thing=Thing(Recall(name)), thing_last=False
        )  # "what he would like to drink"
    elif noun is not None:  # "how many blankets they need"
        what = singular(d.noun_words(noun.start, noun.end), d.language)
        d.scene = replace(d.scene, thing=Thing(Text(what)), thing_last=False)
    elif (
        not options
        and {"verb", "aux"} & question.parts.keys()
        and d.scene.thing is None
        and d.scene.place != Recall(name)
        and not _no_thing(d, counted)
        and not _no_thing(d, question.parts.get("aux"))
    ):
        d.scene = replace(
            d.scene, thing=Thing(Recall(name)), thing_last=False
        )  # "ask what they need and bring it"
    elif "noun" in question.parts and d.scene.place != Recall(name):
        d.scene = replace(
            d.scene, thing=Thing(Recall(name)), thing_last=False
        )  # "ask for her favourite fruit"
    about = question.parts.get("subject")
    if isinstance(about, Leaf) and about.slot in ("noun", "object"):  # "si la soupe est prête"
        if not names_people(d, about.start, about.end):
            d.scene = d.scene.speaking_of(Thing(Text(d.noun_words(about.start, about.end))))
    elif isinstance(about, Node) and any(each in about.parts for each in ("noun", "object")):
        start, end = without_little_words(d, about.start, about.end)
        d.scene = replace(d.scene, thing=Thing(Text(d.noun_words(start, end))), thing_last=False)
    if (lost := sought_after(d, question)) is not None:
        d.scene = d.scene.speaking_of(lost)
        return
    numbers = all(each.isdigit() for each in options)
    if "options" in question.parts and not numbers and d.scene.place != Recall(name):
        d.scene = replace(
            d.scene, thing=Thing(Recall(name)), thing_last=False
        )  # "what they want: tea or coffee"
    offer = bool(question.production.fixed.get("offer"))  # "offer him a coffee"
    having = rest is not None and says_having(d, rest.start)  # "whether they have got a pen"
    if rest is None or not (offer or having or {"verb", "aux"} & question.parts.keys()):
        return
    last = next((at for at in reversed(range(rest.start, rest.end)) if d.tokens[at].value), None)
    if options and last is not None and all(each.isdigit() for each in options):
        what = singular(d.noun_words(last + 1, rest.end), d.language)
        if what:  # "one, two or three boxes"
            d.scene = replace(d.scene, thing=Thing(Text(what)), thing_last=False)
        return
    if len(options) > 1 and not question.production.fixed.get("where"):
        yes_no = options == (d.language.phrase("yes"), d.language.phrase("no"))
        begin = rest.start if "verb" in question.parts else rest.start + 1  # "would like a coffee"
        start, end = without_little_words(d, begin, rest.end)
        little = d.language.words_called("how_much")
        while start < end - 1 and d.tokens[start].norm in little:
            start, _ = without_little_words(d, start + 1, end)  # "still need their computer"
        if not yes_no and d.scene.place != Recall(name):
            d.scene = replace(d.scene, thing=Thing(Recall(name)), thing_last=False)
        elif yes_no and not names_people(d, start, end):
            it = asked_about(d, start, end)
            d.scene = replace(d.scene, thing=it, thing_last=False)
            if it is not None and isinstance(it.value, Text):
                asks_who_has(d, question, it.value)


def sought_after(d: Discourse, question: Node) -> Thing | None:
    """The thing that somebody is asked the place of: "where the key is"."""
    words = question.parts.get("wh") or question.parts.get("aux")
    where = set(d.language.speech.get("asks_where", ()))
    if words is None or not where & set(d.norms(words.start, words.end)):
        return None
    about = question.parts.get("subject") or question.parts.get("rest")
    if about is None or d.tokens[about.start].norm in d.language.words_called("speakers"):
        return None
    first, definite = about.start, words_for(d.language).definite
    if not {"subject", "article", "aux"} & question.parts.keys():  # "where she put the key"
        at = [n for n in range(about.start, about.end - 1) if d.tokens[n].norm in definite]
        if not at:
            return None
        first = at[-1]
    start, end = without_little_words(d, first, about.end)
    if names_people(d, start, end) or people_named(d, start, end) or places_named(d, start, end):
        return None
    what = d.noun_words(start, end)
    return Thing(Text(what), noun=head_word(what, d.language)) if what else None


def asked_about(d: Discourse, start: int, end: int) -> Thing | None:
    """The thing that some words of a question speak of, and where it is said to be."""
    if set(d.norms(start, end)) <= d.language.words_called("it"):
        return d.scene.thing
    place, last = None, end
    for at in range(start + 1, end):
        if d.tokens[at].norm in d.language.words_called("after_options"):
            name = place_at_end(d, at + 1, end)
            place, last = (None, end) if name is None else (Text(name), at)
            break
    if not 0 < last - start <= LONGEST_OFFERED:
        return d.scene.thing
    what = d.noun_words(start, last)
    return Thing(Text(what), place, noun=head_word(what, d.language))


@meaning("question")
def question(d: Discourse, node: Node) -> str:
    """A direct question made of a reported one by its form: "Do you {verb} {rest}?"."""
    form: str = node.production.fixed["form"]
    if (inner := clause_within(d, node)) is not None:
        return with_clause(d, node, inner)
    if _reported_as_direct(d, node):
        return _put_directly(d, node)
    pronouns = d.language.speech.get("clause", {}).get("pronouns", ())
    alone = node.parts["rest"] if node.parts.keys() == {"aux", "rest"} else None
    if alone is not None and set(d.norms(alone.start, alone.end)) <= set(pronouns):
        words = d.words(node.start, node.end)  # "wie sie" is the beginning of one
        gap = (node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words), gap=gap)
    past = node.production.fixed.get("past")
    turned_each = d.answers.asking_each and "each" in node.production.fixed
    if turned_each:
        fixed = node.production.fixed
        form, past = str(fixed["each"]), fixed.get("each_past")
    asked = node.parts.get("asked")
    else_ = set(d.language.speech.get("somebody_else", ()))
    another = (
        "another" in node.production.fixed
        and asked is not None
        and bool(else_ & set(d.norms(asked.start, asked.end)))
        and d.answers.asking_one is not None
        and d.answers.asking_one.known
    )
    meant = meant_in(d, node, d.answers.asking_one)
    if meant.subject:
        past = past and about_another(d, str(past), meant)
        form = about_another(d, form, meant)
    values: dict[str, str] = {}
    you = "to_you_who" if "asked" in node.parts else "to_you"
    for name, part in node.parts.items():
        values[name] = turn_to_you(d, part.start, part.end, you, instead=meant.words)
    if to_each := of_each(d, node):
        values |= {"subject": "you", "aux": base_form(d, values.get("aux", ""))}
    values = {"rest": "", "adverb": "", **values}
    if "tail" not in values:
        values["tail"] = ""
    else:
        values["rest"] = f"{values['rest']} {values['tail']}"
    if "noun" in values:
        form, values["noun"] = one_each(d, form, values["noun"])
    if "verb" in values:
        verb, particle = parted(d, values["verb"])
        if verb.lower() in d.language.speech.get("no_question_verbs", ()):
            words = d.words(node.start, node.end)
            raise NotUnderstood(d.language.phrase("not_understood", part=words))
        goes_on = base_form(d, verb.lower()) in d.language.speech.get("asks_on", ())
        bare = (
            "rest" not in node.parts or set(values["rest"].split()) <= words_for(d.language).adverbs
        )
        if goes_on and bare and node.end < len(d.tokens) and d.tokens[node.end].norm == COMMA:
            words = d.words(node.start, node.end)  # "ob er weiß", and then what
            raise NotUnderstood(d.language.phrase("not_understood", part=words))
        base = past_base(d, verb) if past else None
        if base is None and past and in_past(d, node, verb):  # "where she put it"
            base = verb
        perfect = perfect_form(d, form, verb, values["rest"])
        if perfect is not None:
            form = perfect
        elif base is not None:
            form, verb = str(past), base
        elif base_form(d, verb) != verb and not (turned_each or to_each):
            form = str(node.production.fixed.get("third", form))
        as_it_is = node.production.fixed.get("as_it_is", False) and not turned_each
        if another:
            as_it_is, form = True, str(node.production.fixed["another"])
        values["verb"] = verb if as_it_is else base_form(d, verb)
        values["rest"] = f"{values['rest']} {particle}"
    rest = node.parts.get("rest")
    it = rest is not None and set(d.norms(rest.start, rest.end)) <= d.language.words_called("it")
    if it and d.scene.thing is not None and d.scene.thing.text:
        values["rest"] = the(
            d.called(d.scene.thing.text), d.language
        )  # who is asked did not hear of it
    one = rest is not None and " ".join(d.norms(rest.start, rest.end)) in d.language.words_called(
        "one_of_such"
    )
    if one and d.scene.thing is not None and d.scene.thing.text and not d.scene.thing.known:
        values["rest"] = some(
            d.called(d.scene.thing.text), d.language
        )  # "ask Clara if she has one"
    form = form if values["rest"].strip() else form.replace(" {rest},", ",")
    text = " ".join(form.format_map(values).split())
    for pattern, instead in d.language.speech.get("question_joined", ()):
        text = re.sub(pattern, instead, text)  # "Est-ce que Alice" -> "Est-ce qu'Alice"
    mark = d.language.speech.get("question_mark", "?")
    if d.answers.surveys and says_the_same(d, text):  # whoever is asked does not know as what
        words = d.words(node.start, node.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return capital(text.replace(" ?", mark).replace(" ,", ",").replace(" .", "."))


def clause_within(d: Discourse, node: Node) -> int | None:
    """The comma where another clause begins in a reported question whose verb stands last: "ob er
    weiß, wo Clara ist". Raises `NotUnderstood` where it is not known which verb is its own."""
    rules, verb = d.language.speech.get("clause"), node.parts.get("verb")
    words = words_for(d.language)
    if rules is None:
        return None
    unknown = NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    joins = d.language.speech["joins"]
    for at in range(node.start + 1, node.end - 1):
        if d.tokens[at].norm in joins and d.tokens[at + 1].norm in rules["subordinating"]:
            raise unknown  # "ob es ihm gut geht oder ob er Hilfe braucht"
    if verb is None or verb.end != node.end:
        return None
    forms = {*rules["finite"], *d.language.speech["base_forms"]}
    inner = {*rules["subordinating"], *rules["relative"], *words.asking}
    for at in range(node.start + 1, verb.start):
        before = d.tokens[at - 1]
        ends = before.norm in forms or words.finite_pattern.search(before.norm)
        if d.tokens[at].norm == COMMA and ends and not before.capital:
            return at
        if d.tokens[at].norm == COMMA and d.tokens[at + 1].norm in inner:
            raise unknown
    return None


def _reported_as_direct(d: Discourse, node: Node) -> bool:
    """Whether what was read as a direct question is a reported one: "warum er lacht"."""
    aux, rest = node.parts.get("aux"), node.parts.get("rest")
    words = words_for(d.language)
    if aux is None or rest is None or d.tokens[aux.start].norm not in words.asking:
        return False
    asked = d.language.speech.get("addressing_last", {}).get("you", ())
    return d.tokens[rest.start].norm in asked


def _put_directly(d: Discourse, node: Node) -> str:
    """ "warum er den Arm hebt" -> "Warum heben Sie den Arm?". Raises `NotUnderstood`."""
    aux, rest = node.parts["aux"], node.parts["rest"]
    last = d.tokens[rest.end - 1]
    forms = {*d.language.speech["clause"]["finite"], *d.language.speech["base_forms"]}
    ends = last.norm in forms or words_for(d.language).finite_pattern.search(last.norm)
    subject = d.norms(rest.start, rest.start + 1)[0]
    others = {COMMA, *d.language.speech["joins"]} & set(d.norms(rest.start, rest.end))
    subjects = d.language.speech["addressing_last"]["subjects"]
    if subject not in subjects or others or last.capital or not ends:
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    verb, particle = parted(d, d.words(rest.end - 1, rest.end))
    you = d.language.speech["to_you"][subject]
    between = turn_to_you(d, rest.start + 1, rest.end - 1)
    asked = f"{d.words(aux.start, aux.end)} {base_form(d, verb)} {you} {between} {particle}"
    return capital(f"{' '.join(asked.split())}?")


def with_clause(d: Discourse, node: Node, comma: int) -> str:
    """A reported question with another clause behind it, which is asked as it is. Raises
    `NotUnderstood` where somebody spoken of in it may be who is asked."""
    you: dict[str, str] = d.language.speech["to_you"]
    rest = node.parts.get("rest")
    behind = set(d.norms(comma, node.end))
    if rest is None or behind & (you.keys() | {*d.language.speech["or"]}):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(node.start, node.end)))
    parts: dict[str, Leaf | Node] = dict(node.parts)
    parts["verb"] = Leaf("verb", d.words(comma - 1, comma), comma - 1, comma)
    if rest.start < comma - 1:
        parts["rest"] = Leaf("remark", None, rest.start, comma - 1)
    else:
        del parts["rest"]
    first: str = question(d, replace(node, end=comma + 1, parts=parts))
    mark = first[-1:]
    return f"{first.removesuffix(mark)}, {d.words(comma + 1, node.end)}{mark}"


def _ends_phrase(d: Discourse, at: int, end: int) -> bool:
    """Whether no noun follows here."""
    token = d.tokens[at] if at < end else None
    if token is None or token.kind == "mark":
        return True
    words: tuple[str, ...] = tuple(d.language.speech.get("no_noun_begins", ()))
    return token.norm in d.language.closed or token.norm in words


def turn_to_you(
    d: Discourse,
    start: int,
    end: int,
    words: str = "to_you",
    to: Thing | None = None,
    instead: Mapping[int, str] = NOBODY_ELSE.words,
) -> str:
    """The original words with "they", "their", "her" ... turned to the person spoken to. Where
    that person is the subject, only what is theirs: "ob er ihn mag" asks about somebody else. `to`
    is who is spoken to, if that is known, for pronouns that stand for others to be told from;
    `instead` is what is said in the place of those that do (`grammar.meanings.pronouns`)."""
    you: dict[str, str] = d.language.speech.get(words) or d.language.speech.get("to_you", {})
    pieces: list[str] = []
    position, whole = start, False
    while position < end:
        first = d.tokens[position]
        last = position + 1
        while last < end and d.tokens[last].start < first.end:
            last += 1  # parts of one contraction
        original = d.text[first.start : d.tokens[last - 1].end]
        if original[:1] in ("'", "’"):  # "he'd": he would
            original = first.norm
        opened = " ".join(token.norm for token in d.tokens[position:last])
        if d.parted(position, last):  # "it" of "it's"
            original = opened
        of_another = to is not None and none_for(d, position, to)
        turned = d.owned_before(to, position) or (None if of_another else you.get(first.norm))
        other = d.one_before(to, position) if to is not None else None
        alone = d.language.speech.get(f"{words}_alone", {})
        if first.norm in alone and _ends_phrase(d, position + 1, end):
            turned = other or alone[first.norm]  # "better for her", but "her office"
        owned = d.language.speech.get("addressing_last", {}).get("possessives", {})
        if turned is not None and last < end and d.tokens[last].capital:
            turned = owned.get(first.norm, turned)  # "ihr Buch", but "gefällt ihr das Buch"
        if turned is not None and last < end and not of_another:
            turned = _robot_as_subject(d, position, last) or turned
        turned = instead.get(position, turned)
        if turned is not None:
            original = opened.replace(first.norm, turned, 1)
        elif other is not None:
            original = other
        before = d.text[d.tokens[position - 1].end : first.start] if pieces else ""
        if first.kind == "mark":
            pieces.append(original if not pieces else "\b" + original)
        elif before in ("'", "’") and whole:  # "s'asseoir": "vous asseoir"
            pieces.append(original)
        elif not before and original.startswith("'"):  # "the children's ward"
            pieces.append("\b" + original)
        elif before in ("'", "’", "-"):  # "d'aide", "rendez-vous"
            pieces.append("\b" + before + original)
        else:
            pieces.append(original)
        whole = turned is not None and len(turned) > 1
        position = last
    return " ".join(pieces).replace(" \b", "").strip(" ,.?!:()")


def _robot_as_subject(d: Discourse, at: int, verb: int) -> str | None:
    """How the robot speaks of itself where it is who does something: "I" in "so you can get past".
    Raises `NotUnderstood` where the verb has other forms then: "if he thinks you are nice"."""
    words, before = words_for(d.language), d.tokens[at].norm
    behind = d.tokens[verb].norm
    if before not in d.language.speech.get("robot_pronouns", ()) or behind not in words.finite:
        return None
    if behind not in words.modals:
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(at, verb + 1)))
    itself: str | None = d.language.speech.get("of_robot", {}).get(before)
    return itself


@meaning("ask_in")
def ask_in(d: Discourse, node: Node) -> Steps:
    """ "take a poll in the cafeteria": everybody there is asked."""
    going = go(d, d.get(node, "place"))
    everybody = Thing(Text(ANYONE), person=True, plural=True, here=True)
    return [*going, *ask_one(d, node, everybody)]


@meaning("quoted")
def quoted(d: Discourse, node: Node) -> str:
    text = str(d.get(node, "quote"))
    return text if text[-1:] in ".?!" else f"{text}?"
