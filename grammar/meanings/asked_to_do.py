"""Asking people to do something: "ask them to wait" becomes "Please wait."."""

from __future__ import annotations

from dataclasses import replace

from grammar.chart import Leaf, Node
from grammar.discourse import Discourse, Steps, Thing
from grammar.errors import NotUnderstood
from grammar.meanings.finding import speak_to
from grammar.meanings.messages import told_to
from grammar.meanings.persons import guest_for, is_me, person_me
from grammar.meanings.questions import turn_to_you
from grammar.meanings.references import answers_in
from grammar.meanings.registry import meaning
from grammar.meanings.requested import Request
from grammar.plan import Call, Text
from grammar.reminders.reminded import note_reminder
from grammar.texts.judging import Judge
from grammar.tokens import COMMA
from grammar.wordorder import asked_of_you


@meaning("ask_to")
def ask_to(d: Discourse, node: Node) -> Steps:
    """ "ask them to wait" -> "Please wait."."""
    part = node.parts.get("text")
    # Whoever else is spoken of is not the one who is asked: "sie soll ihn mir bringen".
    person: Thing | None = guest_for(d, node.parts.get("person_ref"), d.get(node, "person_ref"))
    d.answers = replace(d.answers, message=node)
    if (clause := no_request(d, node)) is not None:
        return speak_to(d, person, [Call("say", {"text": Text(told_to(d, clause, person))})])
    within = set(d.language.speech.get("clause", {}).get("subordinating", ()))
    if part is not None and (verb_never(d, part.start) or _clause_begins(d, part, within)):
        raise NotUnderstood(d.language.phrase("not_understood", part=d.words(part.start, part.end)))
    if node.production.fixed.get("to_me"):
        person = person_me(d, node)
    # "remind me to take my pills": what is mine is theirs who will hear it
    of_speaker = ["to_you_speaker"] if is_me(person) else []
    kinds = [*of_speaker, "to_you_asked", "to_you_who", "to_you"]
    you = next(each for each in kinds if each in d.language.speech)
    text = _asked(d, part, you, person) if part is not None else ""
    if "wished" in node.parts:  # "qu'elle vienne ici"
        text = f"{d.get(node, 'wished')} {text}".strip()
    verb = node.parts.get("verb")
    how = manner_within(d, node, verb)  # "ask them to speak quietly"
    text = f"{text} {how}".strip()
    if verb is not None:  # "hier zu warten": the verb stands last
        text = f"{text} {_infinitive(d, verb)}".strip()
    without = d.language.speech.get("please_without", ())
    text = " ".join(word for word in text.split() if word not in without)
    direct = text if verb is None else asked_of_you(d, text)
    also = node.parts.get("also_verb")
    if also is not None:  # "in die Küche zu kommen und dort zu warten"
        more = node.parts.get("also_text")
        second = turn_to_you(d, more.start, more.end, you, person) if more is not None else ""
        second = f"{second} {_infinitive(d, also)}".strip()
        joint = f" {d.language.speech['clause']['and'][0]} "
        text, direct = text + joint + second, direct + joint + asked_of_you(d, second)
    if "why" in node.parts:
        why = d.words(node.parts["why"].start, node.parts["why"].end)
        text, direct = text + why, direct + why
    first = node.parts.get("text") or node
    words, what = (answers_in(d, each, first.start, first.end) for each in (text, direct))
    request = d.sentence(str(node.production.fixed.get("phrase", "please_do")), what=what)
    saying = Call("say", {"text": request})
    steps = speak_to(d, person, [saying])
    note_reminder(d, node, person, "fact" if "phrase" in node.production.fixed else "deed")
    if "phrase" not in node.production.fixed and isinstance(words, Text):
        d.answers = replace(d.answers, request=Request(saying, words.value, person))
    return steps


def _clause_begins(d: Discourse, part: Leaf | Node, words: set[str]) -> bool:
    """Whether another clause stands within a request: "er soll, wenn er kommt, ..."."""
    first = range(part.start, part.end)
    return any(d.tokens[at].norm in words and d.tokens[at - 1].norm == COMMA for at in first)


def no_request(d: Discourse, node: Node) -> Leaf | None:
    """What is only said of somebody: who may come, or does not have to, is not asked to come."""
    duty = node.parts.get("duty")
    if duty is None:
        return None
    start, end = node.parts["person_ref"].end, max(node.parts["verb"].end, duty.end)
    words, modal = set(d.norms(start, end)), d.tokens[duty.end - 1]
    negated = not words.isdisjoint(d.language.speech["weighty"]["negations"])
    requests = d.language.speech["requesting"]["negated" if negated else "plain"]
    subjects = d.language.speech["addressing_last"]["subjects"]
    why = node.parts.get("why")
    whose = why is not None and bool({*d.norms(why.start, why.end)} & {*subjects})
    if (modal.spelled or modal.norm) in requests and not whose:
        return None
    first = (at for at in range(start, end) if d.tokens[at].norm in subjects)
    return Leaf("remark", None, next(first, start), end if why is None else why.end)


def _asked(d: Discourse, part: Leaf | Node, you: str, person: Thing | None) -> str:
    """What somebody is asked to do, as one request: "to wait and to call" is "wait and call"."""
    judge = Judge(d.tokens, d.language)
    again = [at for at in range(part.start + 1, part.end) if judge.asked_again(at)]
    begins, ends = [part.start, *(at + 1 for at in again)], [*again, part.end]
    pieces = zip(begins, ends, strict=True)
    return " ".join(turn_to_you(d, start, end, you, person) for start, end in pieces)


def verb_never(d: Discourse, at: int) -> bool:
    """Whether no request begins with this word: "tell the man to the left a joke"."""
    return d.norms(at, at + 1)[0] in d.language.speech.get("requests_never_begin", ())


def _infinitive(d: Discourse, verb: Leaf | Node) -> str:
    """The verb of what somebody is asked to do, without a "zu" before it or in it: "anzurufen"."""
    while isinstance(verb, Node) and len(verb.parts) == 1:
        (verb,) = verb.parts.values()
    if isinstance(verb, Leaf) and verb.slot == "zu_infinitive":
        return str(verb.value)
    return d.words(verb.end - 1, verb.end)  # words may have been passed over before it


def manner_within(d: Discourse, node: Node, verb: Leaf | Node | None) -> str:
    """Words for how loud something is to be done that were passed over behind the text, or before a
    verb that stands last, as a part of what is asked."""
    part = node.parts.get("text")
    begun = [each.end for name, each in node.parts.items() if name in ("text", "person_ref")]
    last = max(begun, default=node.start) if verb is None else verb.end - 1
    if part is None and verb is None:
        return ""
    for way in d.language.speech.get("volumes", ()):
        words = tuple(d.language.tokens_of(way))
        for at in range(max(begun, default=node.start), last + 1):
            if tuple(d.norms(at, min(at + len(words), len(d.tokens)))) == words:
                d.resolve(range(at, at + len(words)))
                return d.words(at, at + len(words))
    return ""
