"""What is known while a sentence is turned into a plan, clause by clause from left to right.

The discourse remembers what was spoken of last, so that "it", "there", "her" and "come back" mean
something, in rooms by what that is about (`grammar.memory`); `grammar.meanings` holds a small
function for every meaning that the rules name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Any, Final

from grammar.chart import Leaf, Node
from grammar.errors import Ambiguous, NotUnderstood
from grammar.language import Language
from grammar.lexicon import Lexicon, Name
from grammar.meanings.registry import MEANINGS
from grammar.memory import (
    Answers,
    Branch,
    Branched,
    Command,
    Deliveries,
    Loops,
    People,
    Reports,
    Round,
    Scene,
)
from grammar.naming import joined_up, naming
from grammar.plan import Ask, Call, Number, Recall, Remember, Sentence, Step, Text, Value
from grammar.referents import Claim, Meeting, Thing, Where
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


@dataclass
class Discourse:
    """The sentence, what it has spoken of so far, and the steps that were made of it so far."""

    language: Language
    lexicon: Lexicon
    tokens: tuple[Token, ...]
    text: str
    scene: Scene = field(default_factory=Scene)
    people: People = field(default_factory=People)
    answers: Answers = field(default_factory=Answers)
    deliveries: Deliveries = field(default_factory=Deliveries)
    reports: Reports = field(default_factory=Reports)
    branch: Branch = field(default_factory=Branch)
    loops: Loops = field(default_factory=Loops)
    round: Round = field(default_factory=Round)
    command: Command = field(default_factory=Command)
    depth: int = 0
    """How many sequences the present one is in, itself included."""
    done: Steps = field(default_factory=list)
    """The steps so far of the sequence that is being made."""
    begins: list[int] = field(default_factory=list)
    """Where among them each clause so far begins."""
    around: list[Steps] = field(default_factory=list)
    """Those of the sequences around it, the outermost first."""
    needs_start: bool = False
    variables: frozenset[str] = frozenset()
    background: tuple[str, ...] = ()
    """What was said besides, in its words, and asks for nothing."""
    whereabouts: tuple[tuple[str, Value], ...] = ()
    """What of it says no more than where somebody or something is, and that place."""
    assumptions: tuple[str, ...] = ()
    """What was assumed without being said; each lowers the confidence."""

    # --- parts of the parse

    def build(self, part: Leaf | Node) -> Any:
        """What a part of the parse means."""
        if isinstance(part, Leaf):
            return self._leaf(part)
        if id(part) in self.loops.bound:
            return self.loops.bound[id(part)]
        if SETTING in part.parts:
            return MEANINGS[EACH](self, part)
        meaning = MEANINGS.get(part.means)
        if part.production.rule in COMMANDS and (meaning or part.means in METHODS):
            self.command = replace(self.command, place_before=self.scene.place)
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
        before = dict(vars(self))
        self.done, self.begins = self.done.copy(), self.begins.copy()
        self.around = [steps.copy() for steps in self.around]
        try:
            return self.build(part)
        finally:
            vars(self).update(before)

    def bind(self, part: Leaf | Node, meant: Any) -> None:
        """From now on a part of the parse means this."""
        self.loops = replace(self.loops, bound={**self.loops.bound, id(part): meant})

    @contextmanager
    def bound(self, part: Leaf | Node, meant: Any) -> Iterator[None]:
        """Within, a part of the parse means this."""
        outer = self.loops.bound
        self.bind(part, meant)
        try:
            yield
        finally:
            bound = {of: each for of, each in self.loops.bound.items() if of != id(part)}
            if id(part) in outer:
                bound[id(part)] = outer[id(part)]
            self.loops = replace(self.loops, bound=bound)

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
            genders = {person.text: gender, **self.people.genders}
            self.people = replace(self.people, genders=genders)

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
        others = (
            Thing(Text(name), known=True, person=True) for name in reversed(self.people.named)
        )
        return next((each for each in others if self.may_be(each, start, end)), None)

    def gender_of(self, name: str, otherwise: str = "") -> str:
        """Whether somebody is a "he" or a "she": as was said, or as most of that name are."""
        if name in self.people.genders:
            return self.people.genders[name]
        first = name.lower().split()[0] if name else ""
        names = self.language.speech.get("given_names", {})
        return next((each for each, known in names.items() if first in known), otherwise)

    def one_before(self, person: Thing, at: int) -> str | None:
        """Whom but the person spoken to the pronoun here stands for: "ask Bob whether he is coming
        and tell Alice that he is"."""
        gender = self.gender(at, at + 1)
        if gender is None or self.gender_of(person.text) == gender:
            return None
        others = [name for name in self.people.named if self.gender_of(name) == gender]
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
        self.variables |= {candidate}
        return candidate

    def has_named(self, *names: str) -> None:
        """Somebody was named."""
        self.people = replace(self.people, named=(*self.people.named, *names))

    def need_first(self, *steps: Step) -> None:
        """The condition that is made needs these steps before it can be checked."""
        self.command = replace(self.command, pending=(*self.command.pending, *steps))

    def resolve(self, tokens: Iterable[int]) -> None:
        """These tokens of a free text stand for what is only known when the program runs."""
        self.command = replace(self.command, resolved=self.command.resolved | {*tokens})

    def keep_note(self, what: tuple[Any, ...], variable: str) -> None:
        """Something of a poll is noted in a variable."""
        self.answers = replace(self.answers, notes={**self.answers.notes, what: variable})

    def went(self, place: Value) -> None:
        """The robot is at this place now."""
        person = self.scene.person
        if person is not None and person.known and person.here:
            person = replace(person, here=False)  # who is left behind
        self.scene = replace(
            self.scene.arrived(place),
            person=person,
            person_on_arrival=person,
            away=False,
            looked_in=None,
            at_furniture=None,
            with_person=None,
            led=None,
        )

    def came_back(self) -> None:
        """The robot has gone back to the speaker by itself: "there" is still where it was."""
        place = self.scene.place
        self.went(self.start())
        self.scene = replace(self.scene, place=place)

    def known_by_now(self) -> tuple[Any, ...]:
        """What could be told: the last answer, code and report."""
        return (self.answers.last, self.answers.code, self.reports.last)

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
