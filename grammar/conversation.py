"""What a sentence means after others: an answer to a question back, a change to the command before,
a piece that goes on with it, or simply the next command.

Whatever it is, the outcome is a whole sentence, understood anew: "ask Bob if he wants coffee" and
"no, Alice" make "ask Alice if he wants coffee". So nothing is done that could not have been said at
once, and the person sees the whole program again.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Final

from grammar.accounts import TEXTS
from grammar.answers import Answer, answer_to, other_choice
from grammar.chart import TooMuch
from grammar.discourse import Discourse
from grammar.edits import Edit, Sentence, same_word
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.listed import RULES, Row, rows_of
from grammar.pieces import Piece, is_pieces, leading, leaves, pieces_of
from grammar.plan import Call, Plan, Text, calls
from grammar.requests import Request
from grammar.told_apart import one_told_apart, thing_alone, with_other_look
from grammar.understand import Reader
from grammar.understanding import Context, Understanding, rejected

MANNER: Final = frozenset({"set_volume", "set_language"})
"""What is set before something is said rather than after it."""
SPEAKING: Final = frozenset({"say", "ask", "answer", "listen"})
OPEN: Final = TEXTS | {"noun", "unknown", "remark"}
"""Slots for words that nobody knows."""
MOST_TRIED: Final = 12
"""Sentences that are tried for one change."""


def understood(text: str, lexicon: Lexicon, language: Language, context: Context) -> Understanding:
    """Understand a sentence of a conversation."""
    return _Turn(text, lexicon, language, context).understood()


class _Turn:
    """One sentence and what was said before it."""

    def __init__(self, text: str, lexicon: Lexicon, language: Language, context: Context) -> None:
        self.text = text
        self.lexicon = lexicon
        self.language = language
        self.context = replace(context, question=None)
        self.question = context.question
        self.base = context.before or Context()
        """What was known when the command before was given."""

    def understood(self) -> Understanding:
        question = self.question
        if question is not None and question.asked:
            answered = self._answered(answer_to(self.text, question, self.language))
            if answered is not None:
                return answered
        if self.context.chosen is not None:
            asked, taken = self.context.chosen
            other = other_choice(self.text, asked, taken, self.language)
            if other is not None:
                return self._read(other, self.base) or self._reader(other, self.base).understand()
        reader = self._reader(self.text, self.context)
        plain = reader.understand()
        if plain.request is not None:
            return plain
        edit = self._edit()
        if edit is not None and edit.kind == "correct" and question is not None:
            answered = self._answered(
                Answer(sentences=(question.completed(edit.new),), certain=False)
            )
            if answered is not None:
                return answered
        if edit is not None:
            changed = self._changed(edit)
            if changed is not None:
                return changed
        if edit is not None and reader.tokens[0].norm in self.language.speech["only"]:
            # "only if she is there"; a place alone would only be one more of them
            part = is_pieces(self._reader(edit.new, Context()))
            return (None if part else self._gone_on()) or self._unclear(edit)
        if plain.status != "rejected":
            return self._in_that_manner(plain) or self._after_this(plain)
        if question is not None:
            answered = self._answered(answer_to(self.text, question, self.language, loosely=True))
            if answered is not None:
                return answered
        gone_on = self._gone_on() or self._hanging_on(reader)
        if gone_on is not None:
            return gone_on
        if edit is not None and edit.kind in ("same", "add") and self.context.earlier is not None:
            earlier = replace(self.context.earlier, carried_out=True)
            result = understood(self.text, self.lexicon, self.language, earlier)
            if result.status != "rejected":
                return result
        if edit is not None and edit.kind in (
            "correct",
            "only",
            "instead",
            "drop",
            "drop step",
            "manner",
        ):
            return self._unclear(edit)
        return plain

    def _after_this(self, plain: Understanding) -> Understanding:
        """A command of its own, after which the one before can still be spoken of."""
        if not self.context.text:
            return plain
        return replace(plain, context=replace(plain.context, earlier=self._forgetting()))

    def _forgetting(self) -> Context:
        earlier = self.context.earlier
        if earlier is not None and earlier.earlier is not None:
            earlier = replace(earlier, earlier=None)
        return replace(self.context, earlier=earlier)

    # --- trying sentences

    def _reader(self, text: str, context: Context) -> Reader:
        return Reader(text, self.lexicon, self.language, context)

    def _read(self, text: str, base: Context) -> Understanding | None:
        """A sentence made from what was said, if it is one."""
        reader = self._reader(text, base)
        if not reader.tokens:
            return None
        result = reader.understand()
        if result.status == "rejected" or result.request is not None:
            return None
        return replace(result, context=replace(result.context, before=base))

    def _first_read(
        self, texts: Iterable[str | None], base: Context | None = None
    ) -> Understanding | None:
        tried = 0
        for text in texts:
            if text is None:
                continue
            result = self._read(text, base or self.base)
            if result is not None:
                return result
            tried += 1
            if tried == MOST_TRIED:
                break
        return None

    # --- answers

    def _answered(self, answer: Answer | None) -> Understanding | None:
        if answer is None:
            return None
        if answer.dropped:
            return self._dropped()
        if answer.again and self.question is not None:
            return replace(
                rejected(self.text, answer.again, self.context),
                status="clarify",
                suggestions=[self.question.completed(each) for each in self.question.choices[:3]],
                context=replace(self.context, question=self.question),
            )
        alone = None if answer.certain else self._reader(self.text, self.context).understand()
        if alone is not None and (alone.plan is not None or alone.request is not None):
            return None  # another command instead of an answer
        base = self.context.referents()
        result = self._first_read(answer.sentences, base)
        if result is None or not answer.chosen or self.question is None:
            return result
        chosen = (self.question, answer.chosen)
        return replace(result, context=replace(result.context, chosen=chosen))

    def _dropped(self) -> Understanding:
        return Understanding(
            self.text,
            "ok",
            confidence=1.0,
            request=Request("cancel"),
            context=self.context.referents(),
        )

    # --- changes to the command before

    def _edit(self) -> Edit | None:
        """The change to the command before that a sentence asks for, if it reads as one."""
        if not self.context.text and self.question is None:
            return None
        reader = self._reader(self.text.rstrip(" .!?…"), self.context)
        try:
            tree = reader.chart().best("edit")
        except (TooMuch, RecursionError):
            return None
        if tree is None:
            return None
        edit: Edit = Discourse(self.language, self.lexicon, reader.tokens, self.text).build(tree)
        return edit

    def _before(self) -> Sentence:
        """The command before; of a routine that was called by its name, its sentence."""
        before = Sentence(self._reader(self.context.text, self.base))
        routine = before.routine()
        if routine is None:
            return before
        return Sentence(self._reader(routine.sentence, self.base))

    def _changed(self, edit: Edit) -> Understanding | None:
        """The command before with a change; None if that makes no sense."""
        match edit.kind:
            case "cancel":
                return self._dropped() if self.context.text else None
            case _ if not self.context.text:
                return None
            case "drop step" if self.context.carried_out:
                return self._undone()
            case "drop step":
                return self._without_step(edit.which)
            case "drop":
                return self._first_read(self._others(self._without(edit.old)))
            case "instead":
                return self._first_read(self._others(self._instead(edit)))
            case "correct":
                return self._first_read(self._others(self._corrected(edit.new)))
            case "only":
                return self._first_read(self._others(self._only(edit.new)))
            case "first" if not self.context.carried_out:
                return self._first_read(self._with_first(edit.new), self.context.referents())
            case "add" if not self.context.carried_out:
                return self._added(edit.new)
            case "add" if not self._commands(edit.new):
                return self._first_read(self._same(edit.new))
            case "reverse":
                return self._first_read(self._reversed())
            case "again":
                return self._again(edit)
            case "same":
                return self._first_read(self._same(edit.new))
            case "manner":
                return self._first_read(self._in_manner(edit.new))
            case _:
                return None

    def _others(self, texts: Iterable[str | None]) -> Iterator[str]:
        """Those sentences that differ from the command before: a change that changes nothing is
        not what was meant."""
        before = self.context.text.rstrip(" .!?")
        return (text for text in texts if text is not None and text.rstrip(" .!?") != before)

    def _only(self, said: str) -> Iterator[str | None]:
        """ "only in the lobby": of several clauses that do the like, the one with this in it."""
        before, new = self._before(), self._reader(said, Context())
        words = new.content(0, new.last_word)
        row = before.siblings()[0] if before.siblings() else []
        has = [clause for clause in row if words and _has(before.reader.content(*clause), words)]
        if len(has) == 1 and before.all_do_the_like(row):
            yield before.reader.words(*has[0])
        yield from self._corrected(said)

    def _corrected(self, said: str) -> Iterator[str | None]:
        """ "no, the pharmacy": the sentence with this in the place of what it corrects."""
        before, new = self._before(), self._reader(said, Context())
        yield with_other_look(before, new)
        told = one_told_apart(before, new)
        if told is not None:
            yield from before.corrected(told)
            return
        yield from before.corrected(new)
        for part in (before.without_repeated(new), thing_alone(before, new)):
            if part is not None and part is not new:  # "no, bring the red cup", "no, ask Clara"
                yield from before.corrected(part)
        if self._commands(said):
            yield before.with_clause(new)
            if not is_pieces(new):  # "only the kitchen" stands for a part, not for all
                yield said
        yield from before.corrected(new, everywhere=True)
        yield from before.corrected(new, within_texts=True)
        if self._goes_on(new):
            yield self._going_on(self._joined(said))
            yield self._there(new)

    def _instead(self, edit: Edit) -> Iterator[str | None]:
        """ "tea instead of coffee"."""
        before = self._before()
        old, new = self._reader(edit.old, Context()), self._reader(edit.new, Context())
        yield before.swapped(old, before.without_repeated(new))
        yield before.swapped(old, new)
        yield from before.corrected(new)

    def _with_first(self, said: str) -> Iterator[str | None]:
        """ "first go to the lab"."""
        old = self.context.text
        if self._commands(said):
            yield f"{said.rstrip(' .!')}. {old}"
            return
        listed = self._row_for(said)
        if listed is not None and listed[0].begins_it:
            row, named, piece = listed
            yield row.with_one(named, piece, first=True)
            return
        before, new = self._before(), self._reader(said, Context())
        for start, end in before.siblings()[0] if before.siblings() else []:
            clause = Sentence(self._reader(before.reader.words(start, end), self.base))
            for variant in clause.corrected(new):
                yield f"{variant.rstrip(' .!')}. {old}"

    def _reversed(self) -> Iterator[str | None]:
        """ "the other way round"."""
        before = self._before()
        rows = rows_of(before.reader, before.tree)
        if len(rows) == 1:
            yield rows[0].reversed()
        elif not rows and before.siblings():
            clauses = [before.reader.words(*each) for each in before.siblings()[0]]
            yield ". ".join(reversed(clauses)) if len(clauses) > 1 else None

    def _row_for(self, said: str) -> tuple[Row, Reader, Piece] | None:
        """The only row of names that a name goes with: "add the pharmacy"."""
        before, new = self._before(), self._reader(said, Context())
        pieces = next((row for row in pieces_of(new) if len(row) == 1), [])
        kind = RULES.get(pieces[0].rule) if pieces else None
        rows = [row for row in rows_of(before.reader, before.tree) if row.kind == kind]
        return (rows[0], new, pieces[0]) if len(rows) == 1 else None

    def _added(self, said: str) -> Understanding | None:
        """ "and then wave": at the end of the command before."""
        whole = self._joined(self.text)
        separate = self._separate(said)
        elsewhere = self._there_too(said, whole)
        if elsewhere is not None:
            return elsewhere
        if self._commands(said):
            alone = self._reader(said, self.context).understand()
            more = len(calls(alone.plan)) if alone.plan is not None else 1
            least = len(calls(self.context.plan)) + more if self.context.plan else 1
            for text in (whole, separate):
                result = self._read(text, self.base)
                if result is not None and (
                    result.plan is None or len(calls(result.plan)) >= least or text is separate
                ):
                    return result
            return None
        result = self._read(whole, self.base)
        before, new = self._before(), self._reader(said, Context())
        if result is not None and not self._swallowed(whole) and not before.spoken_earlier(new):
            return result
        listed = self._row_for(said)
        if listed is not None:
            row, named, piece = listed
            return self._first_read([row.with_one(named, piece)])
        new = before.without_repeated(new)
        last = before.last_of_its_like()
        like = self._first_read(self._separate(variant) for variant in last.corrected(new))
        if like is None and is_pieces(new):
            return None  # "and in Clara's" is nothing to say, whatever was to be said
        return like or result or self._read(separate, self.base)

    def _there_too(self, said: str, whole: str) -> Understanding | None:
        """ "and in the kitchen", after "ask everyone in the lobby ...": not only to go there."""
        before, new = self._before(), self._reader(said, Context())
        if self.context.plan is None or not is_pieces(new):
            return None
        done = calls(self.context.plan)
        result = self._read(whole, self.base)
        more = calls(result.plan)[len(done) :] if result is not None and result.plan else []
        if not more or done[-1].method == "goto" or any(each.method != "goto" for each in more):
            return None
        like = before.last_of_its_like().corrected(before.without_repeated(new))
        return self._first_read(self._separate(variant) for variant in like)

    def _again(self, edit: Edit) -> Understanding | None:
        said = edit.new
        if edit.late:  # "ask him again in ten minutes"
            return self._first_read(f"{edit.late}, {each}" for each in self._same(said) if each)
        if not said:
            plan = self.context.plan
            assert plan is not None
            context = replace(self.context, carried_out=False)
            return Understanding(self.text, "ok", plan, 1.0, context=context)
        if self._commands(said) and not is_pieces(self._reader(said, Context())):
            return self._read(said, self.context.referents())
        return self._first_read(self._same(said))

    def _same(self, said: str) -> Iterator[str | None]:
        """ "the same for Bob": again, with Bob in the place of who it was for."""
        before = self._before()
        new = before.without_repeated(self._reader(said, Context()))
        done = self.context.carried_out
        like = before if done else before.last_of_its_like()
        for variant in like.corrected(new):
            yield variant if done else self._separate(variant)
        yield self._going_on(self._separate(self.text))
        if self._goes_on(new):
            for more in (self._going_on(self._joined(said)), self._there(new)):
                if more is not None:
                    yield more if done else self._separate(more)

    def _in_manner(self, said: str) -> Iterator[str | None]:
        """ "say it louder", "say that in German"."""
        alone = self._reader(said, self.context).understand()
        if alone.plan is not None and {call.method for call in calls(alone.plan)} <= MANNER:
            yield f"{said.rstrip(' .!?')}. {self.context.text}"
        yield self._going_on(self._joined(said))
        if self._speaks():
            spoken = self.language.speech["spoken_so"].format(words=said.rstrip(" .!?"))
            yield f"{spoken}. {self.context.text}"
        yield from self._same(said)  # "say it to Bob, too"

    def _without(self, said: str) -> Iterator[str | None]:
        """ "without the greeting", "not the kitchen"."""
        before, what = self._before(), self._reader(said, Context())
        words = what.content(0, what.last_word)
        if not words:
            return
        rows = rows_of(before.reader, before.tree)
        members = [(row, member) for row in rows for member in row.about(words)]
        if members:
            yield from (row.without(member) for row, member in members)
            return
        for piece in before.pieces():
            if _has(before.reader.content(piece.start, piece.end), words):
                yield from before.without_words(piece)
        if is_pieces(what):
            yield from before.except_for(what.words(0, what.last_word))
        named = [
            clause
            for clause in before.clauses()
            if _has(before.reader.content(*clause), words) or self._does(before, clause, words)
        ]
        named.sort(key=lambda clause: clause[1] - clause[0])
        if named and all(start <= named[0][0] and named[0][1] <= end for start, end in named):
            yield from (before.without(*clause) for clause in named)  # the innermost that can go

    def _does(self, before: Sentence, clause: tuple[int, int], words: set[str]) -> bool:
        """Whether a clause does what these words speak of: "the greeting"."""
        part = self._reader(before.reader.words(*clause), self.base).understand()
        if part.plan is None:
            return False
        methods = {call.method for call in calls(part.plan)}
        called = self.language.speech.get("part_words", {})
        return all(any(word in called.get(method, ()) for method in methods) for word in words)

    def _undone(self) -> Understanding:
        """Of what was done, only a drive can be taken back."""
        origin = self.context.origin
        if origin is None:
            undo = Request("undo")
            return Understanding(
                self.text, "ok", confidence=1.0, request=undo, context=self.context
            )
        plan = Plan((Call("goto", {"place": Text(origin)}),), self.language.code)
        context = replace(self.context.referents(), plan=plan, text=self.text)
        return Understanding(self.text, "ok", plan, 1.0, context=context)

    def _without_step(self, which: int) -> Understanding | None:
        """ "undo the last step": the innermost clause that is a sentence less."""
        before = self._before()
        rows = before.siblings()
        ends = [row[which] for row in (rows if which == 0 else reversed(rows)) if len(row) > 1]
        result = self._first_read(before.without(*clause) for clause in ends)
        return result or rejected(self.text, self.language.phrase("drop_all"), self.context)

    # --- what goes on with the command before

    def _gone_on(self) -> Understanding | None:
        """A sentence that is none in itself, but goes on with the one before: "..., in German",
        "only if she is there"; or asks for the like: "and in the lobby?"."""
        if not self.context.text:
            return None
        before, new = self._before(), self._reader(self.text, Context())
        joined = self._joined(self.text)
        if not self.context.carried_out:  # "the blue one", "the one in the lobby"
            told = one_told_apart(before, new)
            if told is not None:
                return self._first_read(before.corrected(told))
            placed = leading(new, 1) > 0  # "aus der Küche"
            look = None if placed else with_other_look(before, new, instead=True)
            if look is not None:
                return self._read(look, self.base)
        if not self.context.carried_out and self._goes_on(new):
            texts = [self._going_on(text) for text in (joined, self._separate(self.text))]
            variants = [*before.corrected(new)]
            if variants and self._is_number(new):  # "cinq minutes" - "dix"
                texts = []
            result = self._first_read(texts if variants else (*texts, self._there(new)))
            if result is not None:
                return result
        variants = [*before.corrected(new)]
        if not self._goes_on(new) or not variants:
            return None
        joins = self.language.speech["joins"]
        more = new.tokens[0].norm in joins and not self.context.carried_out
        return self._first_read(self._separate(each) if more else each for each in variants)

    def _hanging_on(self, reader: Reader) -> Understanding | None:
        """A command that can be read, but only makes sense after the one before, which waits to be
        carried out: "tell me how many said yes"."""
        plan = self.context.plan
        if plan is None or self.context.carried_out or not reader.reads:
            return None
        whole = self._separate(self.text)
        result = None if self._swallowed(whole) else self._read(whole, self.base)
        if result is None or result.plan in (None, plan):
            return None
        return result

    def _in_that_manner(self, plain: Understanding) -> Understanding | None:
        """ "louder", while something to say waits for its approval: that is to be said louder."""
        if plain.plan is None or self.context.carried_out or not self._speaks():
            return None
        if not {call.method for call in calls(plain.plan)} <= MANNER:
            return None
        return self._read(f"{self.text.rstrip(' .!?')}. {self.context.text}", self.base)

    def _speaks(self) -> bool:
        """Whether something is said in the command before."""
        plan = self.context.plan
        return plan is not None and any(call.method in SPEAKING for call in calls(plan))

    def _joined(self, more: str) -> str:
        """The command before and more, in one sentence."""
        return f"{self.context.text.rstrip(' .!?')} {more.lstrip(' ,.')}"

    def _separate(self, more: str) -> str:
        """The command before and more, in sentences of their own."""
        return f"{self.context.text.rstrip(' .!?')}. {more.lstrip(' ,.')}"

    def _goes_on(self, new: Reader) -> bool:
        """Whether words may go on with a sentence: "in the kitchen", "three times", "ten"."""
        begins = self.language.speech["goes_on"]
        if not new.tokens:
            return False
        known = new.tokens[0].norm in begins or new.tokens[0].kind in ("number", "time")
        return known or self._is_number(new)

    def _is_number(self, new: Reader) -> bool:
        return any(end == new.last_word for end, _, _ in new.slots["{number}"](0))

    def _commands(self, said: str) -> bool:
        """Whether this is a command in itself."""
        result = self._reader(said, self.context).understand()
        return result.plan is not None or result.status == "clarify"

    def _there(self, new: Reader) -> str | None:
        """ "in ward b": the command before, there."""
        words = new.words(0, new.last_word)
        return f"{words}, {self.context.text}" if is_pieces(new) else None

    def _swallowed(self, whole: str) -> bool:
        """Whether what goes on with the command before was only read as more of its free text."""
        boundary = len(self.context.text.rstrip(" .!?"))
        return any(first < boundary < last for first, last in self._open_words(whole))

    def _going_on(self, whole: str) -> str | None:
        """A sentence that goes on with the command before, if rules know its new words: what would
        only be more of a free text, or an unheard-of noun, is too little to go by; but an "or" may
        add to a question."""
        boundary = len(self.context.text.rstrip(" .!?"))
        more = self._reader(whole[boundary:], Context())
        if more.tokens and more.tokens[0].norm in self.language.speech["or"]:
            return whole
        open_ = self._open_words(whole)
        return None if any(last > boundary for _, last in open_) else whole

    def _open_words(self, text: str) -> list[tuple[int, int]]:
        """The characters that only slots for any words at all could make something of."""
        reader = self._reader(text, self.base)
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

    def _unclear(self, edit: Edit) -> Understanding:
        """Nothing of the command before fits what is said of it."""
        name = "drop_what" if edit.kind in ("drop", "drop step") else "correct_what"
        part = edit.new or edit.old or self.text
        message = self.language.phrase(name, part=part)
        return replace(rejected(self.text, message, self.context), unclear=part)


def _has(words: set[str], sought: set[str]) -> bool:
    return all(any(same_word(word, each) for word in words) for each in sought)
