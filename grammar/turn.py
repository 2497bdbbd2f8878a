"""One sentence of a conversation, and the sentences that are tried for it.

What it adds to the command before, or changes about it, makes a sentence that somebody could have
said at once; the first of those that makes sense is taken.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Final

from grammar.chart import TooMuch
from grammar.coverage import TEXTS
from grammar.edits import Sentence
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.pieces import is_pieces, leaves, pieces_of
from grammar.plan import calls
from grammar.reader import SentenceReader
from grammar.requests import Request
from grammar.understanding import Context, Understanding

SPEAKING: Final = frozenset({"say", "ask", "answer", "listen"})
OPEN: Final = TEXTS | {"noun", "unknown", "remark"}
"""Slots for words that nobody knows."""
MOST_TRIED: Final = 12
"""Sentences that are tried for one change."""


class Turn:
    """One sentence and what was said before it."""

    def __init__(self, text: str, lexicon: Lexicon, language: Language, context: Context) -> None:
        self.text = text
        self.lexicon = lexicon
        self.language = language
        self.context = replace(context, question=None)
        self.question = context.question
        self.base = context.before or Context()
        """What was known when the command before was given."""

    def reader(self, text: str, context: Context) -> SentenceReader:
        """Some words, to be read in the same language and world."""
        return SentenceReader(text, self.lexicon, self.language, context)

    def read(self, text: str, base: Context) -> Understanding | None:
        """A sentence made from what was said, if it is one."""
        reader = self.reader(text, base)
        if not reader.tokens:
            return None
        result = reader.understand()
        if result.status == "rejected" or result.request is not None:
            return None
        return replace(result, context=replace(result.context, before=base))

    def first_read(
        self, texts: Iterable[str | None], base: Context | None = None
    ) -> Understanding | None:
        tried = 0
        for text in texts:
            if text is None:
                continue
            result = self.read(text, base or self.base)
            if result is not None:
                return result
            tried += 1
            if tried == MOST_TRIED:
                break
        return None

    def before(self) -> Sentence:
        """The command before; of a routine that was called by its name, its sentence."""
        before = Sentence(self.reader(self.context.text, self.base))
        routine = before.routine()
        if routine is None or not routine.sentence:
            return before
        return Sentence(self.reader(routine.sentence, self.base))

    def _is_times(self, new: SentenceReader) -> bool:
        return any(len(row) == 1 and row[0].rule == "times" for row in pieces_of(new))

    def commands(self, said: str) -> bool:
        """Whether this is a command in itself."""
        result = self.reader(said, self.context).understand()
        return result.plan is not None or result.status == "clarify"

    def joined(self, more: str) -> str:
        """The command before and more, in one sentence."""
        return f"{self.context.text.rstrip(' .!?')} {more.lstrip(' ,.')}"

    def separate(self, more: str) -> str:
        """The command before and more, in sentences of their own."""
        return f"{self.context.text.rstrip(' .!?')}. {more.lstrip(' ,.')}"

    def goes_on(self, new: SentenceReader) -> bool:
        """Whether words may go on with a sentence: "in the kitchen", "three times", "ten"."""
        begins = self.language.speech["goes_on"]
        if not new.tokens:
            return False
        known = new.tokens[0].norm in begins or new.tokens[0].kind in ("number", "time")
        return known or self.is_number(new) or self._is_times(new)

    def is_number(self, new: SentenceReader) -> bool:
        return any(end == new.last_word for end, _, _ in new.slots.matches("{number}", 0))

    def there(self, new: SentenceReader) -> str | None:
        """ "in ward b": the command before, there."""
        words = new.words(0, new.last_word)
        return f"{words}, {self.context.text}" if is_pieces(new) else None

    def swallowed(self, whole: str) -> bool:
        """Whether what goes on with the command before was only read as more of its free text."""
        boundary = len(self.context.text.rstrip(" .!?"))
        return any(first < boundary < last for first, last in self.open_words(whole))

    def going_on(self, whole: str) -> str | None:
        """A sentence that goes on with the command before, if rules know its new words: what would
        only be more of a free text, or an unheard-of noun, is too little to go by; but an "or" may
        add to a question."""
        boundary = len(self.context.text.rstrip(" .!?"))
        more = self.reader(whole[boundary:], Context())
        if more.tokens and more.tokens[0].norm in self.language.speech["or"]:
            return whole
        open_ = self.open_words(whole)
        return None if any(last > boundary for _, last in open_) else whole

    def open_words(self, text: str) -> list[tuple[int, int]]:
        """The characters that only slots for any words at all could make something of."""
        reader = self.reader(text, self.base)
        try:
            tree = reader.chart().best("utterance")
        except (TooMuch, RecursionError):
            tree = None
        if tree is None:
            return [(0, len(text))]
        return [
            (reader.tokens[leaf.start].start, reader.tokens[leaf.end - 1].end)
            for leaf in leaves(tree)
            if leaf.slot in OPEN and leaf.start < leaf.end
        ]

    def speaks(self) -> bool:
        """Whether something is said in the command before."""
        plan = self.context.plan
        return plan is not None and any(call.method in SPEAKING for call in calls(plan))

    def dropped(self) -> Understanding:
        return Understanding(
            self.text,
            "ok",
            confidence=1.0,
            request=Request("cancel"),
            context=self.context.referents(),
        )
