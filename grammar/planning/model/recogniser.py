"""Whether a text may still become a program of the dialect: what a language model is held to.

    draft = Partial.begun(words)
    draft = draft.extended('goto("phar')      # None if no program begins like this
    draft.completions                         # ('macy"',) if only one place begins so
    draft.is_whole                            # whether it could end here

The dialect is Python without `robot.` before the robot's methods; every line of it has a plan
(`grammar.program_parser`). A draft never changes: several may grow from one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from typing import Final

from grammar.planning.model.expressions import (
    CALLS,
    FUNCTIONS,
    KEYWORDS,
    Reader,
)
from grammar.planning.model.letters import LONGEST_NAME, Dead, Unfinished
from grammar.planning.model.types import NUMBER, TEXT, Kind, Type, result_of
from grammar.planning.model.vocabulary import Vocabulary
from robot_api.methods import METHODS

INDENT: Final = 4
DEEPEST: Final = 6
MOST_LINES: Final = 60
LONGEST_LINE: Final = 600
ASIDE: Final = frozenset({"ask", "find", "wait_for", "answer"})
"""Methods with a result that may go unheeded."""
REFUSE: Final = "refuse"
CLARIFY: Final = "clarify"
REASONS: Final = ("dangerous", "medical", "unable", "unknown", "no order")
QUESTIONS: Final = ("who", "what", "where", "when", "which")
_STATEMENTS: Final = ("if", "for", "while", "try", "break", "continue")
_LOOPS: Final = frozenset({"for", "while", "while True"})
_CHAINS: Final = frozenset({"if", "elif"})

Names = dict[str, Type]


@dataclass(frozen=True)
class Block:
    """Lines that are indented alike, and the line that they belong to."""

    kind: str
    """What it is the body of: "for", "if", "else", ...; "" for the program."""
    empty: bool = True
    before: Names = field(default_factory=dict)
    """What was known before the statement that it is a part of."""
    ways: tuple[Names, ...] = ()
    """What is known at the end of each branch of this statement before it; of a loop, where it is
    left."""


@dataclass(frozen=True)
class Partial:
    """A program as far as it is written."""

    words: Vocabulary
    blocks: tuple[Block, ...] = (Block(""),)
    names: Names = field(default_factory=dict)
    unread: frozenset[str] = frozenset()
    """Names of what was found out and is not used yet."""
    lines: tuple[str, ...] = ()
    begun: str = ""
    """The line that is being written."""
    completions: tuple[str, ...] = ()
    """All that can follow, if that is one of a few texts."""
    ended: bool = False
    """Whether nothing may follow: a refusal, a question back."""

    @classmethod
    def begin(cls, words: Vocabulary) -> Partial:
        return cls(words)

    @property
    def text(self) -> str:
        return "".join(f"{line}\n" for line in self.lines) + self.begun

    @property
    def is_whole(self) -> bool:
        """Whether the program could end here."""
        whole = self if not self.begun else self._with_line()
        if whole is None or not whole.lines:
            return False
        begun = whole.blocks[-1].empty or any(block.kind == "try" for block in whole.blocks)
        return whole.ended or not (begun or whole.unread)

    def extended(self, text: str) -> Partial | None:
        """The draft with more letters; None if no program begins like that."""
        *whole, rest = text.split("\n")
        draft: Partial | None = self
        for line in whole:
            assert draft is not None
            draft = replace(draft, begun=draft.begun + line)._with_line()
            if draft is None:
                return None
        assert draft is not None
        return draft._with_begun(draft.begun + rest)

    # --- lines

    def _with_begun(self, line: str) -> Partial | None:
        if not line:
            return replace(self, begun="", completions=())
        if self.ended or len(self.lines) >= MOST_LINES:
            return None
        try:
            self._line(line)
        except Dead:
            return None
        except Unfinished as unfinished:
            return replace(self, begun=line, completions=unfinished.completions)
        return None  # a line is never at an end without its "\n"

    def _with_line(self) -> Partial | None:
        """The draft with the line that was begun at its end."""
        if self.ended or len(self.lines) >= MOST_LINES:
            return None
        try:
            return self._line(f"{self.begun}\n")
        except (Dead, Unfinished):
            return None

    def _line(self, line: str) -> Partial:
        """The draft behind a line, or what is wrong with it so far."""
        if len(line) > LONGEST_LINE:
            raise Dead
        body = line.lstrip(" ")
        spaces = len(line) - len(body)
        if not body:
            if spaces > INDENT * (len(self.blocks) - 1):
                raise Dead
            raise Unfinished(self._indents(spaces))
        depth, odd = divmod(spaces, INDENT)
        deepest = len(self.blocks) - 1
        if odd or depth > deepest or (self.blocks[-1].empty and depth < deepest):
            raise Dead
        return _Line(self, line, spaces, depth).read()

    def _indents(self, spaces: int) -> tuple[str, ...]:
        """The spaces that are still needed where only one number of them is right."""
        needed = INDENT * (len(self.blocks) - 1)
        return (" " * (needed - spaces),) if self.blocks[-1].empty and spaces < needed else ()

    def at_depth(self, depth: int, *, goes_on: bool) -> Partial:
        """Behind the ends of all blocks that are deeper; `goes_on`: the last of them belongs to a
        statement that has another branch."""
        draft = self
        while len(draft.blocks) - 1 > depth:
            last = draft.blocks[-1]
            is_branch = goes_on and len(draft.blocks) - 2 == depth
            if last.kind == "try" and not is_branch:
                raise Dead  # a try without it is none
            names = draft.names if is_branch else _after(last, draft.names)
            draft = replace(draft, blocks=draft.blocks[:-1], names=names)
        return draft

    @property
    def in_loop(self) -> bool:
        return any(block.kind in _LOOPS for block in self.blocks)


def _after(block: Block, names: Names) -> Names:
    """What is known behind a statement whose last block ends."""
    if block.kind == "while True":  # only a break ends it
        ways = [*block.ways] or [names]
    else:
        ways = [*block.ways, names]
        if block.kind not in ("else", "except"):
            ways.append(block.before)
    known: Names = {}
    for name in ways[0]:
        types = [way.get(name) for way in ways]
        joined: Type | None = types[0]
        for other in types[1:]:
            joined = joined.joined(other) if joined and other else None
        if joined is not None:
            known[name] = joined
    return known


class _Line(Reader):
    """One line of a draft, behind its spaces."""

    def __init__(self, draft: Partial, line: str, at: int, depth: int) -> None:
        super().__init__(line, at, draft.names, draft.words)
        self.draft = draft
        self.depth = depth

    def read(self) -> Partial:
        goes_on = self._goes_on()
        branch = self.choose(goes_on) if goes_on else ""
        last = self.draft.blocks[-1] if not branch else self.draft.blocks[self.depth + 1]
        draft = self.draft.at_depth(self.depth, goes_on=bool(branch))
        self.names = draft.names
        if branch:
            ways = (*last.ways, draft.names)
            self.names = dict(last.before)
            kind = branch.split()[0].rstrip(":")
            if kind == "elif":
                self.condition()
                self.expect(":")
            return self._opened(draft, Block(kind, True, last.before, ways))
        return self._statement(draft)

    def _goes_on(self) -> tuple[str, ...]:
        """What this line may begin with to go on with the statement before."""
        blocks = self.draft.blocks
        if len(blocks) < self.depth + 2:
            return ()
        branches: tuple[str, ...] = ()
        if blocks[self.depth + 1].kind in _CHAINS:
            branches = ("elif ", "else:")
        elif blocks[self.depth + 1].kind == "try":
            return ("except Exception:",)
        rest = self.rest.rstrip("\n")
        begins = [each for each in branches if each.startswith(rest) or rest.startswith(each)]
        return tuple(begins) if begins and not self._another_word(rest, begins) else ()

    def _another_word(self, rest: str, begins: Iterable[str]) -> bool:
        """Whether what was written so far may also begin another line: "e" of "emotion"."""
        if any(rest.startswith(each) for each in begins):
            return False
        others = (*CALLS, *_STATEMENTS, *self.names)
        return any(each.startswith(rest) for each in others)

    # --- statements

    def _statement(self, draft: Partial) -> Partial:
        if not draft.lines and not self.depth and self._way_out():
            self.expect("\n")
            return replace(self._done(draft), ended=True)
        word = self._first_word()
        if word in CALLS and self.next() == "(":
            return self._action(draft, word)
        match word:
            case "if":
                self.expect(" ")
                self.condition()
                self.expect(":")
                return self._opened(draft, Block("if", before=self.names))
            case "while":
                self.expect(" ")
                endless = self.starts("True:")
                self.condition()
                self.expect(":")
                kind = "while True" if endless else "while"
                return self._opened(draft, Block(kind, before=self.names))
            case "for":
                return self._loop(draft)
            case "try":
                self.expect(":")
                return self._opened(draft, Block("try", before=self.names))
            case "break" | "continue":
                if not draft.in_loop:
                    raise Dead
                self.expect("\n")
                return self._done(self._left(draft) if word == "break" else draft)
            case _:
                return self._change(draft, word)

    def _left(self, draft: Partial) -> Partial:
        """With what is known where the innermost loop is left."""
        blocks = [*draft.blocks]
        at = max(at for at, block in enumerate(blocks) if block.kind in _LOOPS)
        blocks[at] = replace(blocks[at], ways=(*blocks[at].ways, draft.names))
        return replace(draft, blocks=tuple(blocks))

    def _way_out(self) -> bool:
        """Whether it is no program but a refusal or a question back."""
        for way, reasons in ((REFUSE, REASONS), (CLARIFY, QUESTIONS)):
            if self.rest.startswith(f"{way}("):
                self.expect(f"{way}(")
                self.literal(reasons)
                if self.choose((", ", ")")) == ", ":
                    self.quoted_words(self.words.said)
                    self.expect(")")
                return True
        return False

    def _first_word(self) -> str:
        start = self.at
        word = self.word_or_begin()
        if not word.islower() or word in FUNCTIONS:
            raise Dead
        if word in KEYWORDS and word not in _STATEMENTS:
            raise Dead
        self.at = start + len(word)
        return word

    def word_or_begin(self) -> str:
        """The name that a line begins with; any may be new."""
        rest = self.rest
        word = rest[: len(rest) - len(rest.lstrip("abcdefghijklmnopqrstuvwxyz_0123456789"))]
        if not word or not word[0].isalpha() or len(word) > LONGEST_NAME:
            raise Dead
        if len(word) == len(rest):
            raise Unfinished
        return word

    def _action(self, draft: Partial, method: str) -> Partial:
        if result_of(method).kind is not Kind.NOTHING and method not in ASIDE | {"do"}:
            raise Dead  # what was found out would be lost
        self.call(method)
        self.expect("\n")
        return self._done(draft)

    def _loop(self, draft: Partial) -> Partial:
        self.expect(" ")
        variable = self._new_name()
        second = self._new_name() if self.choose((" in ", ", ")) == ", " else ""
        if second:
            self.expect(" in ")
            record = self.value()
            if record.kind is not Kind.RECORD:
                raise Dead
            self.expect(".items():")
            own = {variable: record.keys or TEXT, second: record.of or TEXT}
        elif self.starts("range("):
            self.expect("range(")
            if self.value().kind is not Kind.NUMBER:
                raise Dead
            self.expect("):")
            own = {variable: NUMBER}
        else:
            items = self.value()
            self.expect(":")
            if items.kind is Kind.RECORD:
                own = {variable: items.keys or TEXT}
            elif items.kind is Kind.LIST:
                own = {variable: items.of or TEXT}
            else:
                raise Dead
        block = Block("for", before=self.names)
        return self._opened(draft, block, {**self.names, **own})

    def _new_name(self) -> str:
        word = self.word()
        if word in KEYWORDS or word in FUNCTIONS or not word.islower() or word[0] == "_":
            raise Dead
        return word

    def _change(self, draft: Partial, name: str) -> Partial:
        """A line that gives a name a value, or adds to one."""
        known = self.names.get(name)
        if known is None:
            self.expect(" = ")
            return self._assigned(draft, name, None)
        ways = [" = "]
        if known.kind is Kind.NUMBER:
            ways.append(" += ")
        if known.kind is Kind.LIST:
            ways.append(".append(")
        if known.kind is Kind.RECORD:
            ways.append("[")
        match self.choose(ways):
            case " += ":
                if self.value().kind is not Kind.NUMBER:
                    raise Dead
                changed = known
            case ".append(":
                changed = replace(known, of=self._fitting(known.of, self.value()))
                self.expect(")")
            case "[":
                keys = self.value()
                if not keys.is_text:
                    raise Dead
                self.expect("]")
                adds = self.choose((" = ", " += ")) == " += "
                value = self._fitting(known.of, self.value())
                if adds and value.kind is not Kind.NUMBER:
                    raise Dead
                changed = replace(known, of=value, keys=self._fitting(known.keys, keys))
            case _:
                return self._assigned(draft, name, known)
        self.expect("\n")
        return self._done(draft, {**self.names, name: changed})

    def _fitting(self, known: Type | None, new: Type) -> Type:
        joined = new if known is None else known.joined(new)
        if joined is None or joined.kind is Kind.NOTHING:
            raise Dead
        return joined

    def _assigned(self, draft: Partial, name: str, known: Type | None) -> Partial:
        start = self.at
        value = self._truth_or_value()
        self.expect("\n")
        if value.kind is Kind.NOTHING:
            raise Dead
        if known is not None:
            value = self._fitting(known, value)
        found_out = self.line[start:].split("(")[0]
        asks = found_out in METHODS and found_out not in ASIDE
        return self._done(draft, {**self.names, name: value}, (name,) if asks else ())

    def _truth_or_value(self) -> Type:
        if self.starts("not "):
            self.condition()
            return Type(Kind.TRUTH)
        value = self.comparison_or_value()
        while self.maybe(" and ", " or "):
            self.negation()
            value = Type(Kind.TRUTH)
        return value

    def comparison_or_value(self) -> Type:
        try:
            start = self.at
            return self.comparison()
        except Dead:
            self.at = start
            return self.value()

    # --- ends of lines

    def _done(
        self, draft: Partial, names: Names | None = None, found_out: tuple[str, ...] = ()
    ) -> Partial:
        *around, last = draft.blocks
        return replace(
            draft,
            blocks=(*around, replace(last, empty=False)),
            names=self.names if names is None else names,
            unread=(draft.unread - self.used) | frozenset(found_out),
            lines=(*draft.lines, self.line.rstrip("\n")),
            begun="",
            completions=(),
        )

    def _opened(self, draft: Partial, block: Block, names: Names | None = None) -> Partial:
        self.expect("\n")
        if len(draft.blocks) > DEEPEST:
            raise Dead
        done = self._done(draft, self.names if names is None else names)
        return replace(done, blocks=(*done.blocks, block))


__all__ = ["CLARIFY", "REFUSE", "Block", "Partial"]
