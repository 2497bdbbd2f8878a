"""What somebody has said who was asked further only because of an answer: "ask Bob if he is coming.
If so, ask him when. Tell me what he said": yes and when, or no.
"""

from __future__ import annotations

from grammar.discourse import Discourse, Steps
from grammar.meanings.surveys import Survey, asked_so_far, in_line, in_loop, is_in, note
from grammar.plan import Call, Recall, Remember, Sentence, Text, Value
from grammar.tidy import mentions


def said_in_all(d: Discourse) -> Value:
    """What was answered to the last question, or to the one that it hangs on where it was not
    asked."""
    assert d.answers.last is not None
    first = _hangs_on(d)
    return Recall(d.answers.last) if first is None else _noted(d, first)


def _hangs_on(d: Discourse) -> Survey | None:
    """The question to the same person that was asked in any case, if the last one was not."""
    asked, surely = asked_so_far(d), in_line(d)
    last = asked[-1] if asked else None
    if last is None or last.call.save_as != d.answers.last or in_loop(d, last.call):
        return None
    if (
        not surely
        or any(each is last for each in surely)
        or surely[-1].call.save_as == d.answers.last
    ):
        return None
    first = surely[-1]
    same = first.who is not None and first.who == last.who
    return first if same and not in_loop(d, first.call) else None


def _noted(d: Discourse, first: Survey) -> Value:
    key = ("said in all", id(first.call))
    if key not in d.answers.notes:
        d.keep_note(key, d.variable("said"))
        note(d, first.call, [Remember(d.answers.notes[key], _answer(first.call))], [])
    said = d.answers.notes[key]
    for each in asked_so_far(d):
        further = ("said further", id(each.call))
        if each is first or each.who != first.who or further in d.answers.notes:
            continue
        d.keep_note(further, said)
        both = Sentence((_answer(first.call), Text(", "), _answer(each.call)))
        note(d, each.call, [Remember(said, both)], [])
    return Recall(said)


def _answer(call: Call) -> Recall:
    return Recall(str(call.save_as))


def said_one_by_one(d: Discourse) -> Steps:
    """What the one who was asked several questions has answered to each, with the question; nothing
    if that was only one, or if something was done with the first answers."""
    untold = _untold(d)
    theirs = [each for each in untold if each.who == untold[-1].who]
    return [_with_question(each) for each in theirs] if len(theirs) > 1 else []


def asked_one_after_the_other(d: Discourse) -> bool:
    """Whether several were asked in turn, each something else, and nothing was done yet with what
    they said: "ask Alice what time suits her, and Bob whether he comes, too, and tell me"."""
    people = [each.who for each in _untold(d)]
    return len(set(people)) > 1 and None not in people


def _untold(d: Discourse) -> list[Survey]:
    """The questions up to the last one that were asked in any case, each once, and that nothing was
    done with; in a branch, only those asked there: the others may be what it hangs on."""
    surely = [each for each in in_line(d) if any(is_in(step, each.call) for step in d.done)]
    last = surely[-1] if surely else None
    if last is None or last.call.save_as != d.answers.last or in_loop(d, last.call):
        return []
    untold = [
        each
        for each in surely
        if each.call.save_as is not None
        and not in_loop(d, each.call)
        and not mentions(tuple(d.done), Recall(each.call.save_as))
    ]
    names = {each.call.save_as for each in untold}
    return untold if last in untold and len(names) == len(untold) else []


def _with_question(survey: Survey) -> Call:
    """An answer behind its question."""
    question = survey.call.arguments["question"]
    answer = Recall(str(survey.call.save_as))
    first = Text(f"{question.value} ") if isinstance(question, Text) else question
    parts: tuple[Value, ...] = (first, answer, Text("."))
    return Call("say", {"text": Sentence(parts)})
