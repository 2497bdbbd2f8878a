"""What is known while a sentence is turned into a plan, clause by clause from left to right.

The discourse remembers what was spoken of last, so that "it", "there", "her" and "come back" mean
something; `grammar.meanings` holds a small function for every meaning that the rules name.
"""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.doubts import Ambiguous, NotUnderstood
from grammar.language import Language
from grammar.lexicon import Lexicon, Name
from grammar.meanings.registry import MEANINGS
from grammar.naming import joined_up, naming
from grammar.plan import Ask, Call, Number, Recall, Remember, Sentence, Step, Text, Value
from grammar.referents import Branched, Claim, Meeting, Round, Thing, Where
from grammar.tokens import Token
from robot_api.methods import METHODS

START: Final = "start"
"""The variable that holds the place where the command was given."""
SETTING: Final = "setting"
"""The part of a command that says where or when it is to be done."""
EACH: Final = "each_spoken_of"
"""The meaning by which commands are made: once for each of several that one speaks of
(`grammar.meanings.quantifiers`)."""
COMMANDS: Final = frozenset({"command", "place_corrected"})
"""Rules whose noun phrases may speak of several."""
ANYONE: Final = "person"
"""What the robot looks for when it is anybody's turn."""

__all__ = ["Branched", "Claim", "Meeting", "Round", "Thing", "Where"]

Steps = list[Step]


ONE_ONLY: Final = frozenset({"person_ref", "thing", "place"})
"""Parts that are a single one wherever a meaning asks for them."""


SCENE: Final = (
    "thing",
    "person",
    "person_on_arrival",
    "thing_last",
    "place",
    "at",
    "away",
    "looked_in",
    "with_person",
    "led",
    "left",
    "holding",
    "delivered",
    "at_pick_up",
    "at_furniture",
    "group",
    "missing",
    "lacking",
    "now_at",
)
"""What the robot and the speaker have before them; each branch of a condition begins with the same
scene."""


@dataclass
class Discourse:
    language: Language
    lexicon: Lexicon
    tokens: tuple[Token, ...]
    text: str
    depth: int = 0
    """How many sequences the present one is in, itself included."""
    done: Steps = field(default_factory=list)
    """The steps so far of the sequence that is being made."""
    begins: list[int] = field(default_factory=list)
    """Where among them each clause so far begins."""
    around: list[Steps] = field(default_factory=list)
    """Those of the sequences around it, the outermost first."""
    needs_start: bool = False
    thing: Thing | None = None
    person: Thing | None = None
    person_on_arrival: Thing | None = None
    """Who was spoken of when the robot went to where it is: whoever's place that is, is nearer."""
    last_named: Thing | None = None
    """Who was named last, in whichever branch: "him" is one person."""
    genders: dict[str, str] = field(default_factory=dict)
    """What people were called after they were named: "ask Bob whether he ..." makes Bob a "he"."""
    named: list[str] = field(default_factory=list)
    """Who was named so far."""
    thing_last: bool = False
    """Whether a thing was spoken of after the last person."""
    place: Value | None = None
    place_before: Value | None = None
    """The place that was spoken of before the command that is made."""
    at: Value | None = None
    """Where the robot is by now; None where the command was given."""
    away: bool = False
    """Whether the robot may be anywhere by now: something was looked for in several places."""
    looked_in: Value | None = None
    """That place, if a condition was checked there and for nothing else: others are not there."""
    with_person: Value | None = None
    led: Thing | None = None
    """Whom the robot has led to where it is."""
    holding: Value | None = None
    origin: str | None = None
    """Where it was before the command before this was carried out."""
    source: Value | None = None
    """Where a thing was taken from in the command before: "put it back"."""
    now_at: dict[Value, Value] = field(default_factory=dict)
    """Where things are by now that were put down somewhere."""
    delivered: Value | None = None
    """A thing that was brought to the speaker without their saying where to."""
    at_pick_up: Value | None = None
    """Where it was picked up."""
    in_loop: bool = False
    at_furniture: str | None = None
    """The furniture that a command is about: "on the table, ..."."""
    at_place: Value | None = None
    """The place that a question is about: "in the kitchen, ..."."""
    answer: str | None = None
    """The variable with the last answer."""
    answer_options: tuple[str, ...] = ()
    asked_for: Text | None = None
    """The thing that somebody was asked for, and that is still with them: "ask her for the key"."""
    held: Text | None = None
    """The thing that somebody was asked whether they have it."""
    says_so: bool = False
    """Whether what is said is done with whoever says that they have it."""
    taking: Any = None
    """How it is taken from whoever has it, before it is said where to."""
    wondered: tuple[Step, ...] = ()
    """The steps that ask what the speaker would like to know, before it is said whom to ask."""
    wonder: tuple[str, Thing | None] | None = None
    """The variable with the answer."""
    brought: tuple[Step, ...] = ()
    """How a thing was handed over last, if nobody was named to bring it to."""
    agreed: tuple[Any, Value] | None = None
    """The call that asked several who were found to say the same, and what they said."""
    resolved: set[int] = field(default_factory=set)
    """The tokens of free texts that stand for what is only known when the program runs."""
    claimed_question: Any = None
    """The step that answers somebody of whom it was only said that they have a question."""
    code: str | None = None
    heard: str | None = None
    surveys: list[Any] = field(default_factory=list)
    """What was asked so far (`grammar.meanings.surveys.Survey`)."""
    put: Any = None
    """The last question (`Survey`) that the speaker put themselves, and waits to have answered."""
    pending: Steps = field(default_factory=list)
    """Steps that a condition needs before it can be checked."""
    awaited: Any = None
    """The step that waited for somebody last (`grammar.meanings.in_time.Awaited`)."""
    announced: Any = None
    """A guest who is expected (`grammar.meanings.strangers.Announced`)."""
    came: Thing | None = None
    """Whichever of several has come who were waited for."""
    left: dict[Value, Value] = field(default_factory=dict)
    """Where people were led to."""
    visitor: Thing | None = None
    """Somebody nobody knows who was met or waited for: "they", told to somebody by name."""
    guest: Thing | None = None
    """Who without a name was spoken of before the receiver of the message that is made."""
    others: bool = False
    """Whether several people were spoken of before the message that is made."""
    host: Thing | None = None
    """Whom a guest was said to be for."""
    on_duty: str = ""
    """Whether the robot is to "guard" a place or to "stay" there: "when somebody comes" is then
    each time, or only "if anybody comes"."""
    met: Meeting | None = None
    """Who or what the last condition was about."""
    room: Value | None = None
    """The room of which something was looked at: "if it is free"."""
    branched: Branched | None = None
    """The last condition that was followed by what is done then."""
    missing: Thing | None = None
    """What was looked for in vain: "if not, look in the kitchen"."""
    lacking: Thing | None = None
    """What is not where it should be: "if there is none, bring one" is for that place."""
    message: Node | None = None
    """The command that told somebody something, or asked, last."""
    request: Any = None
    """What somebody was asked to do last (`grammar.meanings.requested.Request`)."""
    undelivered: Any = None
    """That of somebody who is not there, and what was known then (`grammar.meanings.absences`)."""
    instead_of: str | None = None
    """The variable with the answer of somebody who, in this branch, is not there to give it."""
    delivery: Any = None
    """What was brought to somebody last (`grammar.meanings.deliveries.Delivery`)."""
    destined: Any = None
    """That of a thing that was only said to be for somebody."""
    so_many: Step | None = None
    """The step that brings as many as somebody has answered."""
    meant_for: Any = None
    """Whom, or the place that, things are brought to where it is not said."""
    moments: Steps = field(default_factory=list)
    """The waits whose length was not said."""
    claim: Claim | None = None
    """What is so in this branch of a condition."""
    counting: Any = None
    """The answers that the loop around has to count."""
    group: Value | None = None
    """Several people spoken of together: "both", "each of them"."""
    report: Any = None
    """What was told last (`grammar.meanings.reports.Report`), so that it can be told to others."""
    fetched: Step | None = None
    """The last step, if it brings somebody here for no other reason than that they were fetched."""
    notes: dict[tuple[Any, ...], str] = field(default_factory=dict)
    """The variables with what is noted of a poll, by what that is (`grammar.meanings.polls`)."""
    said: Any = None
    """The answer that was last told of (`grammar.meanings.answers.Wanted`): "... that is"."""
    news: Any = None
    """What was told last of a poll or a round (`grammar.meanings.news.News`)."""
    round: Round = field(default_factory=Round)
    """What is known of the round of places that is made."""
    polled_for: str | None = None
    """What the last poll was to find out: "who", "many"."""
    taken_from: Where | None = None
    """Where the things of a command are taken from, if that is said of no noun phrase."""
    said_to_be: list[Thing] = field(default_factory=list)
    """Things that were said to be somewhere (`grammar.meanings.sources`)."""
    fetching: Any = None
    """The last command that takes things of which nobody has said where they are."""
    asking_one: Thing | None = None
    """To whom a question is put by name: whether anybody has called is about others."""
    asking_each: bool = False
    """Whether a question is put to each of several: who wants tea is then whether they do."""
    checked: str | None = None
    """The variable with what was checked last."""
    report_counts: bool = False
    """Whether the last report is a count that nobody was named to be told of."""
    report_open: bool = False
    """Whether nobody was named whom to tell the last report."""
    last_counted: Thing | None = None
    """What was counted last: "how many people are here, and how many in the lobby?"."""
    counted: Any = None
    """The step that counts in the last round, the place it is at, and what is counted."""
    after_round: tuple[Thing | None, str] | None = None
    """Who is told, when a round is done, what was counted at each place (None for the speaker), and
    whether that is each number or the "total"."""
    told: Step | None = None
    """The last step, if it has told the speaker all there is to tell."""
    report_step: Step | None = None
    """The step that tells it."""
    report_asked: Any = None
    """The report as it was asked for, before it was known how it is told."""
    bound: dict[int, Any] = field(default_factory=dict)
    """What noun phrases that speak of several stand for within their loop, by their `id`."""
    taking_apart: bool = False
    """Whether a noun phrase that speaks of several is made for the loop over them."""
    found_already: bool = False
    """Whether what a command is about was looked for by the steps around it."""
    stop: Value | None = None
    """The place of the loop around, if it is one over places."""
    mislaid: Value | None = None
    """What somebody was said to wait or to look for: where "it" is then tells of that."""
    at_people: bool = False
    """Whether the robot is where it is to meet people, so that things need not be there, too."""
    loops: dict[str, Value] = field(default_factory=dict)
    """The places that loops go round, by their variables."""
    listed_last: Steps = field(default_factory=list)
    """The last steps that look for several things and tell which there are."""
    collected: Thing | None = None
    """Several things that are to be collected, before it was said where to."""
    shown: Value | None = None
    """What somebody was only to see or to sign, and is still in the robot's hand."""
    offers: list[Any] = field(default_factory=list)
    """What was offered to somebody so far (`grammar.meanings.offers.Offer`)."""
    listed_before: tuple[Thing, ...] = ()
    """The things of the last list."""
    only_fetches: bool = False
    """Whether a command fetches things without a word to whom or where to."""
    fetched_list: Any = None
    """The list of things that was fetched so (`grammar.meanings.thing_lists.FetchedList`)."""
    delivered_in: Step | None = None
    """The loop that brings several things to the speaker without their saying where to."""
    variables: set[str] = field(default_factory=set)
    background: list[str] = field(default_factory=list)
    """What was said besides, in its words, and asks for nothing."""
    assumptions: list[str] = field(default_factory=list)
    """What was assumed without being said; each lowers the confidence."""

    # --- parts of the parse

    def build(self, part: Leaf | Node) -> Any:
        """What a part of the parse means."""
        if isinstance(part, Leaf):
            return self._leaf(part)
        if id(part) in self.bound:
            return self.bound[id(part)]
        if SETTING in part.parts:
            return MEANINGS[EACH](self, part)
        meaning = MEANINGS.get(part.means)
        if part.production.rule in COMMANDS and (meaning or part.means in METHODS):
            self.place_before = self.place
            return MEANINGS[EACH](self, part)
        if meaning is not None:
            return meaning(self, part)
        if part.means in METHODS:
            return [self.call_of(part)]
        if part.production.means is None:  # it stands for its only part, or for its words
            inner = [each for each in part.parts.values() if isinstance(each, Node)]
            return self.build(inner[0]) if inner else self.words(part.start, part.end)
        raise LookupError(f"no meaning is called {part.means!r}")

    def tried(self, part: Leaf | Node) -> Any:
        """What a part of the parse would mean here, and nothing else is changed."""
        before = {
            name: copy.copy(value) if isinstance(value, list | dict | set) else value
            for name, value in vars(self).items()
        }
        known = dict(vars(self))
        try:
            return self.build(part)
        finally:
            vars(self).update(known)
            for name, value in before.items():
                if isinstance(value, list):
                    known[name][:] = value
                elif isinstance(value, dict | set):
                    known[name].clear()
                    known[name].update(value)

    def one_command(self, node: Node) -> Steps:
        """A command, where its noun phrases stand for one each."""
        meaning = MEANINGS.get(SETTING if SETTING in node.parts else node.means)
        return [self.call_of(node)] if meaning is None else meaning(self, node)

    def get(self, node: Node, name: str, default: Any = None) -> Any:
        """What the part of this name means, or the fixed value of this name, or the default."""
        part = node.parts.get(name)
        if part is None:
            return node.production.fixed.get(name, default)
        value = self.build(part)
        if name in ONE_ONLY and isinstance(value, list):
            # Only commands are done for one after the other (`grammar.meanings.quantifiers`).
            raise NotUnderstood(self.language.phrase("one_person"))
        return value

    def _leaf(self, leaf: Leaf) -> Any:
        if leaf.slot in ("place", "place_short"):
            return Text(self.one_of(leaf).name)
        if isinstance(leaf.value, tuple):
            first = leaf.value[0]
            return first.name if isinstance(first, Name) else first
        if leaf.value is None:
            return self.words(leaf.start, leaf.end)
        return leaf.value

    def one_of(self, leaf: Leaf) -> Name:
        """The name a slot matched. Raises `Ambiguous` if several go by it."""
        names: tuple[Name, ...] = leaf.value
        if len(names) == 1:
            return names[0]
        raise self.which(leaf.start, leaf.end, tuple(name.name for name in names))

    def which(self, start: int, end: int, choices: tuple[str, ...]) -> Ambiguous:
        """The question which of several was meant."""
        choices = tuple(map(self.called, choices))
        question = self.language.phrase(
            "which_one", what=self.words(start, end), choices=self.listed(choices)
        )
        return Ambiguous(question, start, end, choices)

    def listed(self, names: tuple[str, ...]) -> str:
        """ "a, b or c"."""
        if len(names) < 2:
            return "".join(names)
        joiner = self.language.phrase("or")
        return f"{', '.join(names[:-1])} {joiner} {names[-1]}"

    def words(self, start: int, end: int) -> str:
        """The original words of some tokens."""
        if start >= end:
            return ""
        return self.text[self.tokens[start].start : self.tokens[end - 1].end]

    def parted(self, start: int, end: int) -> bool:
        """Whether some tokens are only a part of a contraction: "it" of "it's"."""
        first, last = self.tokens[start], self.tokens[end - 1]
        begun = start > 0 and self.tokens[start - 1].end > first.start
        return begun or (end < len(self.tokens) and self.tokens[end].start < last.end)

    def called(self, name: str) -> str:
        """What speakers call something that a plan has a name for."""
        return naming(self.lexicon, self.language).called(name)

    def norms(self, start: int, end: int) -> list[str]:
        return [token.norm for token in self.tokens[start:end]]

    def is_plural(self, node: Node) -> bool:
        """Whether a pronoun speaks of several: "them"."""
        words = self.language.speech.get("plural_pronouns", ())
        return any(word in words for word in self.norms(node.start, node.end))

    def gender(self, start: int, end: int) -> str | None:
        """The gender of the first pronoun among some tokens that tells one."""
        pronouns = self.language.speech.get("pronoun_genders", {})
        return next((pronouns[norm] for norm in self.norms(start, end) if norm in pronouns), None)

    def called_so(self, person: Thing, start: int, end: int) -> None:
        """Some tokens speak of a person by a pronoun: now it is known which."""
        gender = self.gender(start, end)
        if gender is not None and person.known and person.text:
            self.genders.setdefault(person.text, gender)

    def may_be(self, person: Thing, start: int, end: int) -> bool:
        """Whether a pronoun may stand for a person, by how that person was spoken of before."""
        objects = self.language.speech.get("object_genders", {})  # "va la chercher": no article
        alone = objects.get(self.tokens[start].norm) if end - start == 1 else None
        gender = self.gender(start, end) or alone
        return gender is None or self.may_have(person, gender)

    def may_have(self, person: Thing, gender: str) -> bool:
        """Whether a person may be spoken of as a "he" or a "she"."""
        return self.gender_of(person.text, gender) == gender

    def one_called(self, start: int, end: int) -> Thing | None:
        """The last of those who were named whom a pronoun may stand for."""
        others = (Thing(Text(name), known=True, person=True) for name in reversed(self.named))
        return next((each for each in others if self.may_be(each, start, end)), None)

    def gender_of(self, name: str, otherwise: str = "") -> str:
        """Whether somebody is a "he" or a "she": as was said, or as most of that name are."""
        if name in self.genders:
            return self.genders[name]
        first = name.lower().split()[0] if name else ""
        names = self.language.speech.get("given_names", {})
        return next((each for each, known in names.items() if first in known), otherwise)

    def one_before(self, person: Thing, at: int) -> str | None:
        """Whom but the person spoken to the pronoun here stands for: "ask Bob whether he is coming
        and tell Alice that he is"."""
        gender = self.gender(at, at + 1)
        if gender is None or self.gender_of(person.text) == gender:
            return None
        others = [name for name in self.named if self.gender_of(name) == gender]
        return next((self.called(name) for name in reversed(others) if name != person.text), None)

    def owned_before(self, person: Thing | None, at: int) -> str | None:
        """What is somebody else's than the person's who is spoken to: "ask Clara whether she is in
        and tell Bob to go to her office"."""
        data = self.language.speech.get("addressing", {})
        if person is None or "owned" not in data:
            return None
        owner = self.one_before(person, at) if self.tokens[at].norm in data["possessives"] else None
        return None if owner is None else str(data["owned"].format(name=owner))

    def noun_words(self, start: int, end: int) -> str:
        """Some tokens as the words of a noun phrase that things are looked for by: in lower case,
        but for languages that write nouns with capitals."""
        keep = bool(self.language.speech.get("capital_nouns"))
        words = ""
        before = 0
        for token in self.tokens[start:end]:
            if words:
                elided = self.text[before : token.start] in ("'", "’")  # "verre d'eau"
                words += "'" if elided else " "
            whole = keep and token.kind == "word"
            words += self.text[token.start : token.end] if whole else token.spelled or token.norm
            before = token.end
        return words

    def described_by(self, part: Leaf | Node) -> str:
        """The words for what a part says of a thing: from a list where one has them, else as they
        were said."""
        if isinstance(part, Node):
            words: str = self.build(part)
            return words
        if isinstance(part.value, tuple):
            first = part.value[0]
            return first.name if isinstance(first, Name) else str(first)
        return self.noun_words(part.start, part.end)

    # --- making steps

    def call_of(self, node: Node, name: str = "") -> Call:
        """A rule named after a robot method: its slots are the parameters."""
        method = METHODS[name or node.means]
        names = {parameter.name for form in method.forms for parameter in form}
        arguments = {
            name: as_value(self.get(node, name))
            for name in dict.fromkeys((*node.production.fixed, *node.parts))
            if name in names or method.extra
        }
        return Call(method.name, arguments)

    def start(self) -> Recall:
        """The place where the command was given."""
        self.needs_start = True
        return Recall(START)

    def sentence(self, phrase: str, /, **values: Value | str) -> Value:
        """A phrase of the language with values put in: a text, or one made when it is spoken."""
        return self.filled(self.language.phrases[phrase], **values)

    def filled(self, pattern: str, /, **values: Value | str) -> Value:
        parts: list[Value] = []
        text = ""
        rest = pattern
        while rest:
            before, brace, after = rest.partition("{")
            text += before
            if not brace:
                break
            name, _, rest = after.partition("}")
            value = values[name]
            if isinstance(value, str):
                text += value
            elif isinstance(value, Text):
                text += value.value
            else:
                if text:
                    parts.append(Text(text))
                    text = ""
                parts += value.parts if isinstance(value, Sentence) else (value,)
        if not parts:
            return Text(capital(joined_up(text, self.language)))
        if text:
            parts.append(Text(text))
        parts = [
            Text(joined_up(each.value, self.language)) if isinstance(each, Text) else each
            for each in parts
        ]
        return Sentence(tuple(parts))

    def say(self, phrase: str, /, **values: Value | str) -> Call:
        return Call("say", {"text": self.sentence(phrase, **values)})

    def variable(self, name: str) -> str:
        """A name for a new variable: `name`, or `name2` if that is taken."""
        candidate, number = name, 1
        while candidate in self.variables:
            number += 1
            candidate = f"{name}{number}"
        self.variables.add(candidate)
        return candidate

    def went(self, place: Value) -> None:
        """The robot is at this place now."""
        self.at = self.place = place
        if self.person is not None and self.person.known and self.person.here:
            self.person = replace(self.person, here=False)  # who is left behind
        self.person_on_arrival = self.person
        self.away = False
        self.looked_in = None
        self.at_furniture = None
        self.with_person = self.led = None

    def came_back(self) -> None:
        """The robot has gone back to the speaker by itself: "there" is still where it was."""
        place = self.place
        self.went(self.start())
        self.place = place

    def scene(self) -> dict[str, Any]:
        """Where everything is by now, to go back to it with `set_scene`."""
        return {name: getattr(self, name) for name in SCENE}

    def known_by_now(self) -> tuple[Any, ...]:
        """What could be told: the last answer, code and report."""
        return (self.answer, self.code, self.report)

    def set_scene(self, scene: dict[str, Any]) -> None:
        for name, value in scene.items():
            setattr(self, name, value)

    def prologue(self) -> Steps:
        if not self.needs_start:
            return []
        return [Remember(START, Ask("location"))]

    def sequence(self, make: Callable[[], None]) -> Steps:
        """The steps that `make` adds to `done`, as a sequence of their own."""
        outer, self.done = self.done, []
        begins, self.begins = self.begins, []
        self.around.append(outer)
        self.depth += 1
        try:
            make()
            return self.done
        finally:
            self.done, self.begins = self.around.pop(), begins
            self.depth -= 1


def as_value(value: Any) -> Value:
    """Plain data as a value of a plan."""
    if isinstance(value, str):
        return Text(value)
    if isinstance(value, int | float):
        whole = int(value) if float(value).is_integer() else round(value, 4)
        return Number(whole)
    if isinstance(value, Thing):
        return value.value
    result: Value = value
    return result


def capital(text: str) -> str:
    return text[:1].upper() + text[1:]
