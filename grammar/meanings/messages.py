"""What is passed on to somebody is said to them: "tell Bob that he is late" becomes "You are late."

A pronoun of the third person means the one who is spoken to, unless somebody else whom it could
mean was spoken of in a clause before it ("tell Alice that her patient is here and he is waiting").
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing, capital
from grammar.errors import NotUnderstood
from grammar.meanings.about_guests import guest_in, guest_spoken_of, host_told, others_spoken_of
from grammar.meanings.finding import go, speak_to
from grammar.meanings.genders import gender_of_thing
from grammar.meanings.news import back_to_speaker
from grammar.meanings.options import people_named
from grammar.meanings.persons import guest_for, is_me, person_me
from grammar.meanings.questions import turn_to_you
from grammar.meanings.references import answers_in
from grammar.meanings.registry import meaning
from grammar.meanings.rooms import in_words, room_spoken_of
from grammar.meanings.speaking import put_for, sentence_form
from grammar.meanings.verb_forms import base_form
from grammar.names import names_of
from grammar.plan import Call, Recall, Text
from grammar.reminders.reminded import note_reminder
from grammar.texts.words import words_for
from grammar.tokens import COMMA, STOP, Token
from grammar.wordorder import direct_clause, is_direct

CHANGED: Final = "\0"
"""Marks a word of a message that stands in the place of another, until the words are joined."""

NOBODY_ELSE: Final[dict[str, Any]] = {
    "objects": {},
    "possessives": {},
    "reflexives": {},
    "impersonal": (),
}
"""What is only asked of words that may speak of a third person."""


@meaning("say_that")
def say_that(d: Discourse, node: Node) -> Steps:
    """ "tell her that lunch is ready" -> "Lunch is ready."; to somebody, "they" becomes "you"."""
    part = node.parts["text"]
    guest = guest_spoken_of(d)
    others = others_spoken_of(d)
    d.people = replace(d.people, guest=guest, others=others)
    host_told(d, node)
    person: Thing | None = guest_for(d, node.parts.get("person_ref"), d.get(node, "person_ref"))
    d.answers = replace(d.answers, message=node)
    if node.production.fixed.get("to_me"):
        person = person_me(d, node)
    note_reminder(d, node, person, "fact")
    if isinstance(part, Leaf) and part.slot == "quote":
        text = str(part.value)
    elif node.production.fixed.get("to_you"):
        text = sentence_form(turn_to_you(d, part.start, part.end))
    else:
        text = told_to(d, part, person)
    end = part.end
    more = node.parts.get("more")  # "that the doctor is here and that she can come in"
    if more is not None:
        text, end = f"{text} {told_to(d, more, person)}", more.end
    d.has_named(*people_named(d, part.start, end))
    saying = Call("say", {"text": answers_in(d, text, part.start, end)})
    if is_me(person):
        return [*back_to_speaker(d), saying]
    return speak_to(d, person, [saying])


@meaning("say_there")
def say_there(d: Discourse, node: Node) -> Steps:
    """ "tell the kitchen that two meals are missing": whoever is there."""
    going = go(d, d.get(node, "place"))
    return [*going, Call("say", {"text": Text(told_to(d, node.parts["text"], None))})]


@meaning("show_that")
def show_that(d: Discourse, node: Node) -> Steps:
    """ "write on the screen that we are closed" -> "We are closed."."""
    return [Call("show", {"text": Text(told_to(d, node.parts["text"], None))})]


def with_its_subject(d: Discourse, part: Leaf | Node) -> Leaf | Node:
    """A clause with the "that" before it, where that is not what joins it but what it is about:
    "tell him that is wrong"."""
    words = words_for(d.language)
    before, first = d.tokens[part.start - 1].norm, d.tokens[part.start].norm
    about_that = before in words.that & words.objects and first in words.finite
    return replace(part, start=part.start - 1) if about_that else part


def told_to(d: Discourse, part: Leaf | Node, person: Thing | None) -> str:
    """A reported clause as a sentence to its receiver."""
    part = with_its_subject(d, part)
    room = room_spoken_of(d, part.start, part.end)
    if room:
        return sentence_form(in_words(d, part.start, part.end, room))
    changed = {**indirect(d, part), **turned(d, part.start, part.end, person)}
    ordered = direct_clause(d, part.start, part.end, changed)
    said = d.words(part.start, part.end)
    if ordered == said:
        ordered = addressed(d, part.start, part.end, person)
    reports = d.tokens[part.start - 1].norm in d.language.speech.get("reporting", ())
    of_robot = d.tokens[part.start].norm in d.language.speech.get("robot_pronouns", ())
    of_receiver = ordered != said and person is not None and not person.me
    if (
        of_robot and of_receiver
    ):  # "that you agree with him": the receiver is "him", and so no "you"
        return sentence_form(_said_of_itself(d, part, ordered))
    before = d.tokens[part.start - 1].kind
    if of_robot and not reports and before == "word" and person is not None and not person.me:
        # "tell Noah you are a robot": who is?
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(part.start, part.end)))
    if of_robot and reports:
        ordered = _said_by_robot(d, ordered)
    unsure = d.language.speech.get("unsure_told")
    if unsure and person is not None and not person.me and re.search(unsure, ordered):
        raise NotUnderstood(d.language.phrase("not_understood", part=said))
    return sentence_form(ordered)


def _said_of_itself(d: Discourse, part: Leaf | Node, clause: str) -> str:
    """What can only be said of the robot, as it says it. Raises `NotUnderstood` where the language
    does not tell how."""
    own = _said_by_robot(d, clause)
    if own != clause:
        return own
    first, _, rest = clause.partition(" ")
    itself: str | None = d.language.speech.get("of_robot", {}).get(first.lower())
    if itself is None:
        words = d.words(part.start, part.end)
        raise NotUnderstood(d.language.phrase("not_understood", part=words))
    return f"{itself} {rest}"


def indirect(d: Discourse, part: Leaf | Node) -> dict[int, str]:
    """The verbs of a reported clause as they are in a direct one: "die Sitzung sei verschoben"."""
    data: dict[str, str] = d.language.speech.get("indirect", {})
    norms = d.norms(part.start, part.end)
    if not data or "ich" in norms:
        return {}
    said = enumerate(norms)  # but "Komme gleich" is said of oneself
    return {part.start + at: data[norm] for at, norm in said if at and norm in data}


def _said_by_robot(d: Discourse, clause: str) -> str:
    """ "you are late", said of the robot, as it says it of itself: "I am late". What anybody may do
    ("that you can sit down") is left as it is."""
    own: dict[str, str] = d.language.speech.get("of_robot", {})
    verbs = [each for each in own if " " in each or "'" in each]
    begun = [each for each in verbs if f"{clause.lower()} ".startswith(f"{each} ")]
    longest = max(begun, key=len, default="")
    return own.get(longest, "") + clause[len(longest) :]


def addressed(d: Discourse, start: int, end: int, person: Thing | None) -> str:
    """The words of a message as its receiver hears them. Unchanged where nobody receives it, and in
    languages without `addressing` in their data."""
    data = d.language.speech.get("addressing")
    if not data:
        return d.words(start, end)
    if person is None or (person.me and "speaker" not in data):
        return _joined(d.words(start, end), data)
    if person.me:  # "remind me that I have an appointment": "I" is who will hear it
        data = {**data, **NOBODY_ELSE, **data["speaker"]}
    guests = guest_in(d, person, start, end)
    pieces: list[str] = []
    subject = subject_of_clause = False
    for at, original, space in _written(d, start, end):
        tokens = [token.norm for token in d.tokens[at : at + _parts(d, at, end)]]
        changed = list(tokens)
        for number, word in enumerate(tokens):
            if subject and word not in data["between"]:
                spelled = d.tokens[at + number].spelled or word
                turned = data.get("verbs", {}).get(word) or base_form(d, spelled)
                changed[number] = word if word in data["unchanged"] else turned
                subject = False
            clitic = at > start and _before_verb(d, at, end, data)
            if d.tokens[at].norm in data["clause_joins"] or d.tokens[at].kind == "mark":
                subject_of_clause = False
            # "il se lave", "il doit se laver"
            of_you = subject or (
                subject_of_clause and _infinitive_follows(d, at + number + 1, data)
            )
            reflexive = data.get("reflexives", {}).get(word) if of_you else None
            you = (
                reflexive
                or data["you"].get(word)
                or (data.get("objects", {}).get(word) if clitic else None)
            )
            noun = not clitic and _noun_follows(d, at + 1, end, data)
            possessed = word in data["possessives"] and noun
            impersonal = _begins(d, at, end, data.get("impersonal", ()))
            another = not person.me and (
                _of_another(d, start, at, possessed, data) or _of_thing(d, start, at, end, data)
            )
            named = not (person.me or impersonal or another)
            before = d.one_before(person, at + number) if named else None
            if at + number in guests:
                changed[number] = guests[at + number]
                continue
            if before and not possessed and before not in pieces:
                changed[number] = before
            elif (
                before
                and possessed
                and "owned" in data
                and not any(before in piece for piece in pieces)
            ):
                changed[number] = data["owned"].format(name=before)
            another = (
                another
                or before is not None
                or not_of(d, person, at + number)
                or (not person.me and _of_others(d, person, word, data))
            )
            if you and not impersonal and not another:
                changed[number] = data["possessives"][word] if possessed else you
                before_it = d.tokens[at + number - 1].norm
                stands_alone = before_it in data.get("prepositions", ())  # "chez elle ce soir"
                subject = subject or (word in data["subjects"] and not stands_alone)
                subject_of_clause = subject_of_clause or subject
        words = " ".join(changed)
        if begins_sentence(d, start, at):
            words = capital(words)
        pieces.append(space + (original if changed == tokens else CHANGED + words))
    return _joined("".join(pieces), data)


def not_of(d: Discourse, person: Thing, at: int) -> bool:
    """Whether a pronoun is none for somebody of this name: "tell Alice that he is early"."""
    gender = d.gender(at, at + 1)
    return gender is not None and person.known and not d.may_have(person, gender)


def _joined(text: str, data: Mapping[str, Any]) -> str:
    """The words joined as the language does: "qu'vous" -> "que vous"."""
    for pattern, instead in data.get("seams", ()):
        text = re.sub(pattern, instead, text)
    return text.replace(CHANGED, "").strip()


def _begins(d: Discourse, at: int, end: int, phrases: Sequence[str]) -> bool:
    """Whether one of some phrases begins here, "#" standing for any number: "il est #"."""
    return any(
        len(words) <= end - at
        and all(
            d.tokens[at + number].norm == word
            or (word == "#" and d.tokens[at + number].value is not None)
            for number, word in enumerate(words)
        )
        for words in (phrase.split() for phrase in phrases)
    )


def turned(d: Discourse, start: int, end: int, person: Thing | None) -> dict[int, str]:
    """What the words of a reported clause become for its receiver where the verb stands last: "dass
    er spät ist" -> "Sie", "sind". After a comma a pronoun may mean anything."""
    data = d.language.speech.get("addressing_last")
    changed: dict[int, str] = {}
    if person is None or not data or (person.me and "speaker" not in data):
        return changed
    if person.me:  # "remind me that I have an appointment": "I" is who will hear it
        data = {**data, **data["speaker"]}
    stands = {d.tokens[at].norm for at in range(start, end)} & set(data["stands"])
    if (
        d.scene.thing is not None and stands
    ):  # "put the box there and tell Bob that it stands there"
        return changed
    last = next((at for at in range(start, end) if d.tokens[at].norm in data["ends"]), end)
    for at in range(start, last):
        word = d.tokens[at].norm
        is_verb = word in data.get("verbs_too", ()) and at + 1 == last
        if word not in data["you"] or is_verb:
            continue
        owned = word in data["possessives"] and at + 1 < last and d.tokens[at + 1].capital
        other = None if person.me else d.one_before(person, at)
        if other is None and not person.me and not_of(d, person, at):
            continue
        if other is not None:  # "ask Bob whether he has time and tell Clara that he has time"
            if word in data["subjects"] and other not in changed.values():
                changed[at] = other
            continue
        changed[at] = data["possessives" if owned else "you"][word]
        if at == start and word in data["subjects"]:
            verb = min(start + 1, last - 1) if is_direct(d, start) else last - 1
            changed[verb] = base_form(d, d.words(verb, verb + 1))
    if not person.me:
        _turn_later(d, start, last, end, person, changed)
    return changed


def _turn_later(
    d: Discourse, start: int, first: int, end: int, person: Thing, changed: dict[int, str]
) -> None:
    """What the words of the clauses behind the first become: "..., bevor er operiert wird" ->
    "Sie", "werden". Raises `NotUnderstood` where a pronoun may mean who is told or another."""
    data = d.language.speech["addressing_last"]
    subject = start in changed and d.tokens[start].norm in data["subjects"]
    ends = [
        at
        for at in range(first, end)
        if d.tokens[at].kind == "mark" or d.tokens[at].norm in d.language.speech["joins"]
    ]
    relative = d.language.speech["clause"]["relative"]
    for mark, behind in itertools.pairwise([*ends, end] if ends else []):
        begin = mark + 1
        if begin >= behind or d.tokens[mark].norm == STOP:
            continue
        joined, own = d.tokens[mark].kind != "mark", False
        direct = is_direct(d, start) and joined
        for at in range(begin, behind):
            word = d.tokens[at].norm
            own = own or word in data["subjects"]
            last_sein = word in data.get("verbs_too", ()) and at + 1 == behind
            if word not in data["you"] or last_sein or not_of(d, person, at):
                continue
            if d.gender(at, at + 1) is None or d.one_before(person, at) is not None:
                continue
            is_subject = word in data["subjects"] and at <= begin + 1
            verb = _verb_behind(d, at, end, direct or (at == begin and is_direct(d, start)))
            if _another_meant(d, start, at, data):
                duty = verb is not None and d.tokens[verb].norm in data["duties"]
                other = is_subject and (duty or d.tokens[at - 1].norm in relative)
                if subject or other or _unknown_named(d, start, at):
                    words = d.words(start, end)
                    raise NotUnderstood(d.language.phrase("not_understood", part=words))
                continue
            owned = word in data["possessives"] and at + 1 < end and d.tokens[at + 1].capital
            changed[at] = data["possessives" if owned else "you"][word]
            if is_subject:
                if verb is None:
                    words = d.words(start, end)
                    raise NotUnderstood(d.language.phrase("not_understood", part=words))
                changed[verb] = base_form(d, d.words(verb, verb + 1))
        if subject and joined and not own:  # "dass er krank ist und heute nicht kommt"
            verb = begin if is_direct(d, start) else behind - 1
            if _finite(d, verb) and not d.tokens[begin].capital:
                changed[verb] = base_form(d, d.words(verb, verb + 1))


def _finite(d: Discourse, at: int) -> bool:
    """Whether a verb of a clause stands here, by its form."""
    token, words = d.tokens[at], words_for(d.language)
    form = token.norm in words.finite or words.finite_pattern.search(token.norm) is not None
    return form and not token.capital


def _verb_behind(d: Discourse, at: int, end: int, direct: bool) -> int | None:
    """The verb of the clause whose subject stands here: right behind it, or last."""
    joins = d.language.speech["joins"]
    places = range(at + 1, min(at + 2, end)) if direct else range(at + 1, end)
    for place in places:
        last = place + 1 == end or d.tokens[place + 1].kind == "mark"
        last = last or d.tokens[place + 1].norm in joins
        if (direct or last) and _finite(d, place):
            return place
    return None


def _unknown_named(d: Discourse, start: int, at: int) -> bool:
    """Whether somebody was named of whom nobody knows whether it is a man."""
    return any(
        _is_somebody(d, token, {"somebody": ()}) and not d.gender_of(token.norm)
        for token in d.tokens[start:at]
    )


def _another_meant(d: Discourse, start: int, at: int, data: Mapping[str, Any]) -> bool:
    """Whether a pronoun may mean somebody or something else that a message has spoken of."""
    gender = d.gender(at, at + 1)
    articles = data["articles"].get(gender, ())
    for place in range(start, at - 1):
        token = d.tokens[place]
        somebody = _is_somebody(d, token, {"somebody": ()})
        if somebody and d.gender_of(token.norm, gender or "") == gender:
            return True
        if token.norm in articles and any(each.capital for each in d.tokens[place + 1 : place + 3]):
            return True
    return False


def begins_sentence(d: Discourse, start: int, at: int) -> bool:
    """Whether a sentence of a message begins with this token."""
    return at > start and d.tokens[at - 1].norm == STOP


def _written(d: Discourse, start: int, end: int) -> list[tuple[int, str, str]]:
    """Each written word: its first token, how it is written, what stands before it."""
    found: list[tuple[int, str, str]] = []
    at = start
    while at < end:
        last = at + _parts(d, at, end) - 1
        before = d.text[d.tokens[at - 1].end : d.tokens[at].start] if at > start else ""
        found.append((at, d.text[d.tokens[at].start : d.tokens[last].end], before))
        at = last + 1
    return found


def _parts(d: Discourse, at: int, end: int) -> int:
    """How many tokens a written word is: two in "he's"."""
    last = at + 1
    while last < end and d.tokens[last].start < d.tokens[at].end:
        last += 1
    return last - at


def _of_another(
    d: Discourse, start: int, at: int, possessed: bool, data: Mapping[str, Any]
) -> bool:
    """Whether the pronoun here may mean somebody spoken of before it in the message: in another
    clause, or as the owner of something in the same."""
    boundary = False
    for position in range(at - 1, start - 1, -1):
        token = d.tokens[position]
        boundary = boundary or token.norm == COMMA or token.norm in data["clause_joins"]
        if (boundary or possessed) and _is_somebody(d, token, data):
            gender = d.gender(at, at + 1)
            return gender is None or d.gender_of(token.norm, gender) == gender
    return False


def _of_thing(d: Discourse, start: int, at: int, end: int, data: Mapping[str, Any]) -> bool:
    """Whether the pronoun here may mean a thing that a clause before it is about, by the gender of
    its article: "la réunion est annulée et elle aura lieu demain"; who must or can do something is
    somebody."""
    genders: Mapping[str, str] = data.get("articles", {})
    gender = d.gender(at, at + 1)
    verb = next((each for each in d.norms(at + 1, end) if each not in data["between"]), "")
    if gender is None or verb in data.get("duties", ()):
        return False
    # "put the parcel there and tell Bob that it has arrived"
    said = {each.spelled or each.norm for each in d.tokens[at + 1 : end]}
    of_thing = verb in data.get("being", ()) and said & set(data.get("of_things", ()))
    if of_thing and d.scene.thing is not None:
        return gender_of_thing(d, d.scene.thing) == gender
    begins = [start]
    for position in range(start, at):
        word = d.tokens[position].norm
        if position == begins[-1] and word in data["clause_joins"]:
            begins[-1] = position + 1  # "qu'il ..."
        elif word == COMMA or word in data["clause_joins"]:
            begins.append(position + 1)
    return any(genders.get(d.tokens[each].norm) == gender for each in begins if each < at)


def _before_verb(d: Discourse, at: int, end: int, data: Mapping[str, Any]) -> bool:
    """Whether the word here is an object before its verb, and no article: "Bob la cherche", "le
    médecin va la recevoir"."""
    before = d.tokens[at - 1].norm
    if before in data.get("negations", ()):  # "je ne peux pas l'aider"
        before = d.tokens[at - 2].norm
    if before in data.get("subjects_before", ()):
        return True
    if d.tokens[at].norm not in data.get("objects", {}) or at + 1 >= end:
        return False
    if before in data.get("modals", ()):
        infinitive = d.tokens[at + 1].norm
        is_noun = infinitive in data.get("nouns_in_er", ())  # "veut le dossier"
        return not is_noun and re.search(d.language.speech["infinitive"], infinitive) is not None
    if _is_somebody(d, d.tokens[at - 1], data):
        return True
    finite = d.language.speech.get("base_forms", {})  # "le patient de la chambre 3 l'appelle"
    here, after = d.tokens[at - 1], d.tokens[at + 1]
    verb = (after.spelled or after.norm) in finite and after.norm not in data.get("nouns_too", ())
    return verb and here.kind != "mark" and before not in d.language.closed


def _infinitive_follows(d: Discourse, at: int, data: Mapping[str, Any]) -> bool:
    """Whether an infinitive stands here, with at most little words before it: "s'en aller"."""
    while at < len(d.tokens) and d.tokens[at].norm in data["between"]:
        at += 1
    pattern = d.language.speech.get("infinitive")
    return (
        pattern is not None and at < len(d.tokens) and bool(re.search(pattern, d.tokens[at].norm))
    )


def _of_others(d: Discourse, person: Thing, word: str, data: Mapping[str, Any]) -> bool:
    """Whether a pronoun stands for several who were asked before, or somebody whom nobody knows:
    "tell Alice that they agree", "wait for a visitor and tell Alice that they are here"."""
    several = word in data.get("plural", ())
    alone = person.known and person.group is None and not person.plural
    if alone and word in data.get("never_one", ()):
        return True
    asked = [each.who for each in d.answers.surveys if isinstance(each.who, Recall)]
    others = (
        d.people.others or d.people.visitor is not None or any(who != person.value for who in asked)
    )
    return several and alone and others


def _is_somebody(d: Discourse, token: Token, data: Mapping[str, Any]) -> bool:
    names = names_of(d.language, d.lexicon)
    return token.norm in data["somebody"] or any(
        token.norm in names.tries[slot].branches
        for slot in ("person", "person_kind")
        if slot in names.tries
    )


def _noun_follows(d: Discourse, at: int, end: int, data: Mapping[str, Any]) -> bool:
    if at >= end or d.tokens[at].kind != "word":
        return False
    word = d.tokens[at].norm
    return word not in d.language.closed and word not in data["after_object"]


@meaning("remind")
def remind(d: Discourse, node: Node) -> Steps:
    """ "remind me of the meeting", "remind Bob in ten minutes to come"."""
    delay: Steps = d.get(node, "delay") or []
    guest = guest_spoken_of(d)
    d.people = replace(d.people, guest=guest)
    person: Thing | None = d.get(node, "person_ref")
    part = node.parts["text"]
    phrase = str(node.production.fixed.get("phrase", "reminder"))
    note_reminder(d, node, person, "thing" if phrase == "reminder" else "fact")
    if is_me(person):
        what = put_for(d, "of_speaker", d.words(part.start, part.end))
    elif phrase == "only":  # "remind her at noon that she has a visitor"
        what = told_to(d, part, person)
    else:
        what = turn_to_you(d, part.start, part.end)
    words = d.sentence(phrase, what=what, value=sentence_form(what))
    return [*delay, *speak_to(d, person, [Call("say", {"text": words})])]


@meaning("said_with")
def said_with(d: Discourse, node: Node) -> Steps:
    """Say some words as part of a phrase: "invite them to the party"."""
    part = node.parts["text"]
    person: Thing | None = d.get(node, "person_ref")
    robot = words_for(d.language).addressing & set(d.language.speech.get("addressed_robot", ()))
    if robot & set(d.norms(part.start, part.end)):  # "invite them to follow you": no fixed words
        phrase = d.language.phrase("cannot_say", part=d.words(part.start, part.end))
        raise NotUnderstood(phrase, gap=(part.start, part.end))
    words = addressed(d, part.start, part.end, person)
    return speak_to(d, person, [d.say(str(node.production.fixed["phrase"]), what=words)])
