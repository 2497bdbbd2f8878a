"""What comes of reading a sentence: a plan, a question back, or the reason why not."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import Literal

from grammar.discourse import Thing
from grammar.plan import Plan, Value
from grammar.requests import Request
from grammar.trace import Read

Status = Literal["ok", "clarify", "rejected"]


@dataclass(frozen=True)
class Context:
    """What a conversation remembers between two sentences."""

    plan: Plan | None = None
    """The last plan."""
    text: str = ""
    """The last sentence."""
    thing: Thing | None = None
    person: Thing | None = None
    place: Value | None = None
    """What was spoken of last: "it", "her", "there"."""
    source: Value | None = None
    """Where the thing was taken from."""
    question: Clarification | None = None
    """The question that waits for an answer."""
    written: str = ""
    """The program of the last plan as a language model wrote it, if one did."""
    before: Context | None = None
    """What was known when the last sentence was said, for it to be understood anew."""
    carried_out: bool = False
    """Whether the last plan has been carried out, so that what comes is not a part of it."""
    origin: str | None = None
    """The place where the robot was before that."""
    chosen: tuple[Clarification, str] | None = None
    """The question that was answered for the last plan, and the choice that was taken."""
    earlier: Context | None = None
    """As it was before the last sentence, for what is said of the one before that."""

    def referents(self) -> Context:
        """Only what was spoken of last."""
        person = self.person
        if person is not None and not self.carried_out:
            person = replace(person, here=False)  # nobody has gone there yet
        return Context(thing=self.thing, person=person, place=self.place, source=self.source)


@dataclass(frozen=True)
class Clarification:
    """A question back: which of several was meant, or what was left out."""

    text: str
    """The sentence it is about."""
    start: int
    end: int
    """The characters that may mean several things."""
    choices: tuple[str, ...]
    before: str = ""
    """What must stand before the choice, where a contraction was opened: "ins Büro"."""
    question: str = ""
    """As it was asked."""
    asked: bool = True
    """Whether it was put as a question; otherwise the words were only not understood, and an answer
    puts others in their place."""

    def completed(self, choice: str) -> str:
        """The sentence with the choice in place."""
        space = " " if self.start == self.end and not choice.startswith(" ") else ""
        return self.text[: self.start] + self.before + space + choice + self.text[self.end :]


@dataclass(frozen=True)
class Understanding:
    utterance: str
    status: Status
    plan: Plan | None = None
    confidence: float = 0.0
    """From 0 to 1; below 1 where spellings were corrected or something was assumed."""
    message: str | None = None
    """Why it was not understood, or the question back."""
    suggestions: list[str] = field(default_factory=list)
    """Sentences that would be understood."""
    parts: list[Read] = field(default_factory=list)
    """Which words were read as what, as far as the sentence was understood."""
    unclear: str = ""
    """The words that were not understood, or could mean several things."""
    quoted: str = ""
    """The sentence with quotation marks around words that may be meant to be said, until it is
    known whether it would be understood so: then it is a suggestion."""
    request: Request | None = None
    """What is asked of the application instead; such a sentence has no plan."""
    context: Context = field(default_factory=Context)
    """What to pass with the next sentence of the conversation."""

    @property
    def reading(self) -> list[tuple[str, str]]:
        """Which words were read as what: (words, meaning), in their order."""
        return [(part.words, part.meaning) for part in self.parts]


def rejected(text: str, message: str, context: Context) -> Understanding:
    return Understanding(text, "rejected", message=message, context=context)
