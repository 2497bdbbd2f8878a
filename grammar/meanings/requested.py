"""A request whose answer matters afterwards is put as a question: "ask Bob to come; if he can't,
ask Alice" asks "Could you come?" instead of saying "Please come."."""

from __future__ import annotations

from dataclasses import dataclass

from grammar.discourse import Discourse, Thing
from grammar.meanings.asking import asked, remember_answer
from grammar.meanings.surveys import exchanged
from grammar.plan import Ask, Call, Holds, If, Items, Step, Text, Value


@dataclass(frozen=True)
class Request:
    """What somebody was asked to do last."""

    saying: Call
    what: str
    person: Thing | None


def put_as_question(d: Discourse) -> None:
    """Make a question of the request that the clause just before has made."""
    request: Request | None = d.answers.request
    last = d.done[-1] if d.done else None
    if request is None or last is None or not _ends_with(last, request.saying):
        return
    options = (d.language.phrase("yes"), d.language.phrase("no"))
    arguments: dict[str, Value] = {
        "question": d.sentence("could_you", what=request.what),
        "options": Items(tuple(map(Text, options))),
    }
    who = request.person.value if request.person is not None and request.person.known else None
    if who is not None:
        arguments["person"] = who
    name = remember_answer(d, options, "answer")
    question = asked(d, Call("ask", arguments, save_as=name), options, who)
    d.done[-1:] = exchanged([last], request.saying, [question])


def _ends_with(step: Step, saying: Call) -> bool:
    """Whether a step is that request, or makes it of whoever was found."""
    if step is saying:
        return True
    match step:
        case If(condition=Holds(value=Ask(method="find")), then=[*_, last]):
            return last is saying
        case _:
            return False
