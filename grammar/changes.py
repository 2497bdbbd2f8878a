"""What becomes of the command before when somebody changes it: "no, the pharmacy", "and Bob, too",
"without the greeting", "the same in the lobby" (`grammar.edits.Edit` says which change it is)."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Final

from grammar.distinguish import one_told_apart, thing_alone, with_other_look
from grammar.edits import Edit, Sentence, same_word
from grammar.listed import RULES, Row, rows_of
from grammar.pieces import Piece, is_pieces, pieces_of
from grammar.plan import Call, Plan, Text, calls, methods
from grammar.reader import SentenceReader
from grammar.requests import Request
from grammar.turn import Turn
from grammar.understanding import Context, Understanding, rejected

MANNER: Final = frozenset({"set_volume", "set_language"})
"""What is set before something is said rather than after it."""
ADDRESSING: Final = frozenset({"find", "say", "ask"})
"""What somebody is told or asked something by."""


class Changes(Turn):
    """A sentence that changes the command before it."""

    def changed(self, edit: Edit) -> Understanding | None:
        """The command before with a change; None if that makes no sense."""
        match edit.kind:
            case "cancel":
                return self.dropped() if self.context.text else None
            case _ if not self.context.text:
                return None
            case "drop step" if self.context.carried_out:
                return self._undone()
            case "drop step":
                return self._without_step(edit.which)
            case "drop":
                return self.first_read(self._others(self._without(edit.old)))
            case "instead":
                return self.first_read(self._others(self._instead(edit)))
            case "correct":
                return self.first_read(self._others(self._corrected(edit.new)))
            case "only":
                return self.first_read(self._others(self._only(edit.new)))
            case "first" if not self.context.carried_out:
                return self.first_read(self._with_first(edit.new), self.context.referents())
            case "add" if not self.context.carried_out:
                return self._added(edit.new)
            case "add" if not self.commands(edit.new):
                return self.first_read(self._same(edit.new))
            case "reverse":
                return self.first_read(self._reversed())
            case "again":
                return self._again(edit)
            case "same":
                return self.first_read(self._same(edit.new))
            case "manner":
                return self.first_read(self._in_manner(edit.new))
            case _:
                return None

    def _others(self, texts: Iterable[str | None]) -> Iterator[str]:
        """Those sentences that differ from the command before: a change that changes nothing is
        not what was meant."""
        before = self.context.text.rstrip(" .!?")
        return (text for text in texts if text is not None and text.rstrip(" .!?") != before)

    def _only(self, said: str) -> Iterator[str | None]:
        """ "only in the lobby": of several clauses that do the like, the one with this in it."""
        before, new = self.before(), self.reader(said, Context())
        words = new.content(0, new.last_word)
        row = before.siblings()[0] if before.siblings() else []
        has = [clause for clause in row if words and _has(before.reader.content(*clause), words)]
        if len(has) == 1 and before.all_do_the_like(row):
            yield before.reader.words(*has[0])
        yield from self._corrected(said)

    def _corrected(self, said: str) -> Iterator[str | None]:
        """ "no, the pharmacy": the sentence with this in the place of what it corrects."""
        before, new = self.before(), self.reader(said, Context())
        yield with_other_look(before, new)
        told = one_told_apart(before, new)
        if told is not None:
            yield from before.corrected(told)
            return
        yield from before.corrected(new)
        if not self.goes_on(new):  # "no, bring the red cup", "no, ask Clara"
            for part in (before.without_repeated(new), thing_alone(before, new)):
                if part is not None and part is not new:
                    yield from before.corrected(part)
        if self.commands(said):
            yield before.with_clause(new)
            if not is_pieces(new):  # "only the kitchen" stands for a part, not for all
                yield said
        yield from before.corrected(new, everywhere=True)
        yield from before.corrected(new, within_texts=True)
        if self.goes_on(new):
            yield self.going_on(self.joined(said))
            yield self.there(new)

    def _instead(self, edit: Edit) -> Iterator[str | None]:
        """ "tea instead of coffee"."""
        before = self.before()
        old, new = self.reader(edit.old, Context()), self.reader(edit.new, Context())
        yield before.swapped(old, before.without_repeated(new))
        yield before.swapped(old, new)
        yield from before.corrected(new)

    def _with_first(self, said: str) -> Iterator[str | None]:
        """ "first go to the lab"."""
        old = self.context.text
        if self.commands(said):
            yield f"{said.rstrip(' .!')}. {old}"
            return
        listed = self._row_for(said)
        if listed is not None and listed[0].begins_it:
            row, named, piece = listed
            yield row.with_one(named, piece, first=True)
            return
        before, new = self.before(), self.reader(said, Context())
        for start, end in before.siblings()[0] if before.siblings() else []:
            clause = Sentence(self.reader(before.reader.words(start, end), self.base))
            for variant in clause.corrected(new):
                yield f"{variant.rstrip(' .!')}. {old}"

    def _reversed(self) -> Iterator[str | None]:
        """ "the other way round"."""
        before = self.before()
        rows = rows_of(before.reader, before.tree)
        if len(rows) == 1:
            yield rows[0].reversed()
        elif not rows and before.siblings():
            clauses = [before.reader.words(*each) for each in before.siblings()[0]]
            yield ". ".join(reversed(clauses)) if len(clauses) > 1 else None

    def _row_for(self, said: str) -> tuple[Row, SentenceReader, Piece] | None:
        """The only row of names that a name goes with: "add the pharmacy"."""
        before, new = self.before(), self.reader(said, Context())
        pieces = next((row for row in pieces_of(new) if len(row) == 1), [])
        kind = RULES.get(pieces[0].rule) if pieces else None
        rows = [row for row in rows_of(before.reader, before.tree) if row.kind == kind]
        return (rows[0], new, pieces[0]) if len(rows) == 1 else None

    def _added(self, said: str) -> Understanding | None:
        """ "and then wave": at the end of the command before."""
        joins = self.language.speech["joins"]
        listed = self._row_for(said)
        begins = self.reader(self.text, Context()).tokens[0].norm in joins
        whole = self.joined(self.text if begins or listed else f"{joins[0]} {said}")
        separate = self.separate(said)
        elsewhere = self._there_too(said, whole)
        if elsewhere is not None:
            return elsewhere
        before, new = self.before(), self.reader(said, Context())
        asks = any(text.rstrip().endswith("?") for text in (self.text, self.context.text))
        if self.commands(said) and not (asks and is_pieces(new)):  # "and ward c?" is asked, too
            alone = self.reader(said, self.context).understand()
            more = len(calls(alone.plan)) if alone.plan is not None else 1
            least = len(calls(self.context.plan)) + more if self.context.plan else 1
            for text in (whole, separate):
                result = self.read(text, self.base)
                if result is not None and (
                    result.plan is None or len(calls(result.plan)) >= least or text is separate
                ):
                    return result
            return None
        likewise = self._likewise(new)
        if likewise is not None:
            return likewise
        result = self.read(whole, self.base)
        if result is not None and not self.swallowed(whole) and not before.spoken_earlier(new):
            return result
        if listed is not None:
            row, named, piece = listed
            return self.first_read([row.with_one(named, piece)])
        new = before.without_repeated(new)
        last = before.last_of_its_like()
        like = self.first_read(self.separate(variant) for variant in last.corrected(new))
        if like is None and is_pieces(new):
            return None  # "and in Clara's" is nothing to say, whatever was to be said
        return like or result or self.read(separate, self.base)

    def _likewise(self, new: SentenceReader) -> Understanding | None:
        """ "and Bob", "Bob too": told or asked what somebody else was, with "you" for him, too."""
        plan = self.context.plan
        row = next((row for row in pieces_of(new) if len(row) == 1), [])
        if plan is None or not methods(plan) <= ADDRESSING or not row:
            return None
        if row[0].rule != "person_ref" or not row[0].known:
            return None
        too = self.language.speech["too"][0]
        named = new.words(row[0].start, row[0].end)
        result = self.read(self.separate(f"{named} {too}"), self.base)
        more = len(calls(result.plan)) - len(calls(plan)) if result and result.plan else 0
        return result if more > 0 else None

    def _there_too(self, said: str, whole: str) -> Understanding | None:
        """ "and in the kitchen", after "ask everyone in the lobby ...": not only to go there."""
        before, new = self.before(), self.reader(said, Context())
        if self.context.plan is None or not is_pieces(new):
            return None
        done = calls(self.context.plan)
        result = self.read(whole, self.base)
        more = calls(result.plan)[len(done) :] if result is not None and result.plan else []
        if not more or done[-1].method == "goto" or any(each.method != "goto" for each in more):
            return None
        like = before.last_of_its_like().corrected(before.without_repeated(new))
        return self.first_read(self.separate(variant) for variant in like)

    def _again(self, edit: Edit) -> Understanding | None:
        said = edit.new
        if edit.late:  # "ask him again in ten minutes"
            return self.first_read(f"{edit.late}, {each}" for each in self._same(said) if each)
        if not said:
            plan = self.context.plan
            assert plan is not None
            context = replace(self.context, carried_out=False)
            return Understanding(self.text, "ok", plan, 1.0, context=context)
        if self.commands(said) and not is_pieces(self.reader(said, Context())):
            return self.read(said, self.context.referents())
        return self.first_read(self._same(said))

    def _same(self, said: str) -> Iterator[str | None]:
        """ "the same for Bob": again, with Bob in the place of who it was for."""
        before = self.before()
        new = before.without_repeated(self.reader(said, Context()))
        done = self.context.carried_out
        like = before if done else before.last_of_its_like()
        for variant in like.corrected(new):
            yield variant if done else self.separate(variant)
        yield self.going_on(self.separate(self.text))
        if self.goes_on(new):
            for more in (self.going_on(self.joined(said)), self.there(new)):
                if more is not None:
                    yield more if done else self.separate(more)

    def _in_manner(self, said: str) -> Iterator[str | None]:
        """ "say it louder", "say that in German"."""
        alone = self.reader(said, self.context).understand()
        if alone.plan is not None and methods(alone.plan) <= MANNER:
            yield f"{said.rstrip(' .!?')}. {self.context.text}"
        yield self.going_on(self.joined(said))
        if self.speaks():
            spoken = self.language.speech["spoken_so"].format(words=said.rstrip(" .!?"))
            yield f"{spoken}. {self.context.text}"
        yield from self._same(said)  # "say it to Bob, too"

    def _without(self, said: str) -> Iterator[str | None]:
        """ "without the greeting", "not the kitchen"."""
        before, what = self.before(), self.reader(said, Context())
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
        part = self.reader(before.reader.words(*clause), self.base).understand()
        if part.plan is None:
            return False
        done = methods(part.plan)
        called = self.language.speech.get("part_words", {})
        return all(any(word in called.get(method, ()) for method in done) for word in words)

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
        before = self.before()
        rows = before.siblings()
        ends = [row[which] for row in (rows if which == 0 else reversed(rows)) if len(row) > 1]
        result = self.first_read(before.without(*clause) for clause in ends)
        return result or rejected(self.text, self.language.phrase("drop_all"), self.context)


def _has(words: set[str], sought: set[str]) -> bool:
    return all(any(same_word(word, each) for word in words) for each in sought)
