"""What came of a run, for whoever asked for it, in the sentences of a colleague who comes back.

    "Tom: yes." "Rosa: no." "These are the answers: yes: 1, no: 1."

They are made of what really happened, as the log has it, and of nothing else; terminal, console
and voice only show them. What the robot said where it was sent from is the answer in its own words.
What it said elsewhere was meant for others: it is told with where it was said. What it counted, saw
and found is told where it did not do so itself.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any, Final

import msgspec

from grammar import plan as p
from grammar.explain import explain_steps
from grammar.language import Language, load_language
from grammar.lexicon import Lexicon
from grammar.naming import joined_up, listed, place_called
from nl2robot.knowledge import Knowledge
from nl2robot.run.history import ASKING, FINDING, NOTES, Done, Record, Witness, done_calls
from nl2robot.run.runlog import RunLog
from nl2robot.run.trouble import error_told

_LISTS_NOTHING: Final = re.compile(r"(\s*:)\s*\.$")
"""How a report ends whose list is empty: "These are the answers: ."."""
MOST: Final = 30
"""Sentences; the run's page has them all."""
AWAY: Final = frozenset({"find", "guide", "follow", "dock"})
"""What takes the robot away from whoever sent it, beside `goto`."""
SPEAKING: Final = ASKING | {"say", "guide"}
PERSON: Final = "person"
"""The thing that stands for anybody."""


class Sentence(msgspec.Struct, frozen=True):
    """A sentence of an answer."""

    text: str
    spoken: bool = False
    """Whether the robot has said just this aloud to whoever asked."""


def answer(log: RunLog, knowledge: Knowledge, run: int, language: str) -> list[Sentence]:
    """What came of a run of the log, so far; nothing of one that there is not. Raises
    `LookupError` for a language that there is not."""
    logged = log.run(run)
    if logged is None:
        return []
    record = Record(logged, logged.going_on, None, done_calls(log.calls(run)))
    pack = load_language(language)
    return answered(record, log.output(run), knowledge.lexicon(language), pack)


def answered(
    record: Record, printed: Sequence[str], lexicon: Lexicon, pack: Language
) -> list[Sentence]:
    """The same of a record, with what the program printed."""
    account = _Account(record, lexicon, pack)
    sentences = [*account.sentences(), *(Sentence(text.rstrip()) for text in printed)]
    sentences = [each for each in dict.fromkeys(sentences) if each.text]
    if len(sentences) <= MOST:
        return sentences
    more = pack.phrase("more_happened", number=len(sentences) - MOST)
    return [*sentences[:MOST], Sentence(more)]


@dataclass
class _Happened:
    """What is told of a run, in the order in which it came about."""

    reports: list[str] = field(default_factory=list)
    """Said where the robot was sent from."""
    sayings: dict[str, list[str]] = field(default_factory=dict)
    """Said elsewhere, with where; "" stands for on the way."""
    questions: dict[str, list[tuple[str, str, str]]] = field(default_factory=dict)
    """What was asked, with who answered what, and where."""
    findings: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    empty: dict[str, None] = field(default_factory=dict)
    """Where it saw nobody, and nobody was asked either."""
    troubles: list[str] = field(default_factory=list)
    """What did not work, though the program went on."""


class _Account:
    def __init__(self, record: Record, lexicon: Lexicon, pack: Language) -> None:
        self.record = record
        self.lexicon = lexicon
        self.pack = pack
        self.witness = Witness(record, lexicon, pack)

    def sentences(self) -> Iterator[Sentence]:
        happened = self._happened()
        yield from map(Sentence, happened.troubles)
        if not happened.reports:
            yield from map(Sentence, happened.findings)
        yield from map(Sentence, self._said_to_others(happened))
        yield from map(Sentence, self._answers(happened))
        yield from map(Sentence, self._nobody(happened))
        for text in happened.reports:
            yield Sentence(text, spoken=True)
        nothing_else = (happened.reports, happened.sayings, happened.questions, happened.findings)
        if not any(nothing_else) and not self.record.moved:
            yield from map(Sentence, happened.notes)

    def _happened(self) -> _Happened:
        happened, where = _Happened(), _Where()
        found = {thing for thing, so in self.witness.sought() if so}
        spoke = any(call.method in SPEAKING for call in self.record.calls)
        met = {PERSON} & found if spoke else set()  # what was said tells of that
        met |= found & self._used()
        for call in self.record.calls:
            if call.arguments.get("thing") not in met and not (spoke and call.method == "people"):
                self._note(call, where.place, found, happened)
            _note_who_is_there(call, where.place, happened)
            where.follow(call)
        return happened

    def _used(self) -> set[Any]:
        """Whom and what something was done with: that they were found goes without saying."""
        did = [each for each in self.record.calls if each.error is None]
        return {
            each.arguments.get(name)
            for each in did
            for name in ("thing", "person")
            if each.method not in FINDING
        }

    def _note(self, call: Done, place: str | None, found: set[str], happened: _Happened) -> None:
        text = str(call.arguments.get("text") or "")
        if call.error is not None and not (call.method in ASKING and _kind(call) == "TimedOut"):
            if self._went_on_after(call):
                happened.troubles.append(self._trouble(call))
        elif call.method == "say" and place == "":
            if _LISTS_NOTHING.search(text):
                text = self.pack.phrase("none_of_it", text=_LISTS_NOTHING.sub(r"\1", text))
            happened.reports.append(text)
        elif call.method == "say":
            happened.sayings.setdefault(text, []).append(place or "")
        elif call.method in ASKING:
            asked = str(call.arguments.get("question") or call.arguments.get("prompt") or "")
            said = str(call.result or "") if call.error is None else ""
            who = str(call.arguments.get("person") or "")
            happened.questions.setdefault(asked, []).append((who, place or "", said))
        elif call.method in NOTES:
            happened.notes.append(self._noted(call))
        else:
            happened.findings.extend(self._found(call, place or "", found))

    # --- what was said and heard

    def _said_to_others(self, happened: _Happened) -> Iterator[str]:
        for text, places in happened.sayings.items():
            called = self.witness.naming.called
            names = list(dict.fromkeys(called(place) for place in places if place))
            if names:
                yield self.pack.phrase("said_there", text=text, places=", ".join(names))
            else:
                yield self.pack.phrase("said_so", text=text)

    def _answers(self, happened: _Happened) -> Iterator[str]:
        reported = " ".join(happened.reports).lower()
        every = [each for answers in happened.questions.values() for each in answers]
        if len(every) == 1 and every[0][2] and every[0][2].lower() in reported:
            return  # the report says it
        for asked, answers in happened.questions.items():
            if len(happened.questions) > 1 and asked:
                yield self.pack.phrase("was_asked", question=asked)
            for who, place, said in answers:
                name = self._speaker(who, place)
                if said:
                    yield self.pack.phrase("answer_of", person=name, answer=said)
                else:
                    yield self.pack.phrase("silence_of", person=name)

    def _nobody(self, happened: _Happened) -> Iterator[str]:
        """Where there was nobody to ask, of a round that asks."""
        if happened.empty and happened.questions:
            there = [
                self.pack.phrase("in_place", place=self._place(each)) for each in happened.empty
            ]
            yield self._joined("nobody_was", places=listed(there, self.pack))

    def _speaker(self, who: str, place: str) -> str:
        """Whoever answered: by name, else by where they are."""
        known = any(each.name.lower() == who.lower() for each in self.lexicon.people)
        if place and not known:
            return _capital(self.witness.naming.called(place))
        return self.witness.person(who)

    def _place(self, name: str) -> str:
        return joined_up(place_called(name, self.lexicon, self.pack), self.pack)

    # --- what was seen

    def _found(self, call: Done, place: str, found: set[str]) -> Iterator[str]:
        """What a look or a search came to, unless it is nothing to tell of."""
        phrase, result = self.pack.phrase, call.result
        thing = str(call.arguments.get("thing") or "")
        match call.method:
            case method if method in FINDING and (result or thing not in found):
                yield self._joined("was_found" if result else "not_found", thing=self._thing(thing))
            case "count":
                people = thing == PERSON
                things = phrase("people") if people else self.witness.naming.called(thing)
                if place:
                    yield self._joined(
                        "counted_at", things=things, place=self._place(place), value=result
                    )
                else:
                    yield self._joined("counted", things=things, value=result)
            case "people" | "objects" if not result:
                yield phrase("nobody_there" if call.method == "people" else "nothing_seen")
            case "people" | "objects":
                names = ", ".join(self.witness.naming.called(str(each)) for each in result)
                yield phrase(f"{call.method}_seen", value=names)
            case "describe" | "answer":
                yield str(result)
            case "scan":
                yield phrase("code_is", value=result)
            case "read_text":
                yield phrase("it_says", value=result)
            case _:
                pass

    def _thing(self, thing: str) -> str:
        return self.pack.phrase("somebody") if thing == PERSON else self.witness.thing(thing)

    def _noted(self, call: Done) -> str:
        """What a look at the clock or the battery came to."""
        phrase, result = self.pack.phrase, call.result
        match call.method:
            case "clock":
                return phrase("time_is", value=result["time"])
            case "battery":
                return phrase("battery_is", value=result)
            case "location":
                place = result.get("place")
                point = f"{result['x']:.1f}, {result['y']:.1f}"
                return phrase("i_am_at", value=self._place(place) if place else point)
            case "places":
                names = ", ".join(self.witness.naming.called(each) for each in result)
                return phrase("places_are", value=names) if result else phrase("nothing_seen")
            case _:
                return "\n".join(map(str, result)) or phrase("nothing_seen")

    def _joined(self, name: str, **values: Any) -> str:
        return joined_up(self.pack.phrase(name, **values), self.pack)

    # --- what did not work

    def _went_on_after(self, call: Done) -> bool:
        """Whether an error did not end the run, whose own message tells of that."""
        over = self.record.failed and call is self.record.calls[-1]
        return not over and _kind(call) != "Stopped"

    def _trouble(self, call: Done) -> str:
        why = error_told(call.error or "", self.pack.code, self.lexicon)
        if call.method in ASKING and call.arguments.get("person"):
            who = self.witness.person(str(call.arguments["person"]))
            return self.pack.phrase("answer_of", person=who, answer=why)
        called = self.witness.naming.called
        deed = p.Call(call.method, {k: _value(v) for k, v in call.arguments.items() if v})
        [(_, what), *_] = explain_steps(p.Plan((deed,), self.pack.code), self.pack.code, called)
        return self.pack.phrase("did_not_work", what=what, why=why)


def _note_who_is_there(call: Done, place: str | None, happened: _Happened) -> None:
    """Whether there is anybody at this place, by what came of a call there."""
    looks = call.method == "people" or call.arguments.get("thing") == PERSON
    if not place or call.error is not None:
        return
    if call.method in ASKING or (looks and call.result):
        happened.empty.pop(place, None)
    elif looks and call.method in ("people", "sees", "find", "wait_for"):
        happened.empty[place] = None


class _Where:
    """Where the robot is on its way: "" where it was sent from, None where nobody knows."""

    def __init__(self) -> None:
        self.place: str | None = ""
        self._start: Any = None

    def follow(self, call: Done) -> None:
        if call.error is not None:
            return
        if call.method == "location" and self.place == "":
            self._start = call.result
        elif call.method == "location" and self.place is None:
            self.place = call.result.get("place")
        elif call.method == "goto":
            target = call.arguments.get("place")
            if isinstance(target, dict):
                self.place = "" if _same(target, self._start) else target.get("place")
            else:
                self.place = target
        elif call.method in AWAY:
            self.place = call.arguments.get("place") or call.arguments.get("to")


def _same(one: Any, other: Any) -> bool:
    return other is not None and (one["x"], one["y"]) == (other["x"], other["y"])


def _kind(call: Done) -> str:
    """The name of the error that a call ended with."""
    return (call.error or "").partition(":")[0]


def _value(value: Any) -> p.Value:
    """An argument as a value of a plan."""
    match value:
        case bool():
            return p.Truth(value)
        case int() | float():
            return p.Number(value)
        case list():
            return p.Items(tuple(map(_value, value)))
        case dict():
            return p.Text(str(value.get("place") or f"{value.get('x')}, {value.get('y')}"))
        case _:
            return p.Text(str(value))


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
