"""What a sentence means after others: an answer to a question back, a change to the command before,
a piece that goes on with it, or simply the next command.

Whatever it is, the outcome is a whole sentence, understood anew: "ask Bob if he wants coffee" and
"no, Alice" make "ask Alice if he wants coffee". So nothing is done that could not have been said at
once, and the person sees the whole program again.
"""

from __future__ import annotations

from dataclasses import replace

from grammar.answers import Answer, answer_to, other_choice
from grammar.changes import MANNER, Changes
from grammar.chart import TooMuch
from grammar.discourse import Discourse
from grammar.distinguish import one_told_apart, with_other_look
from grammar.edits import Edit
from grammar.language import Language
from grammar.lexicon import Lexicon
from grammar.pieces import is_pieces, leading
from grammar.plan import methods
from grammar.reader import SentenceReader
from grammar.understanding import Context, Understanding, rejected


def understood(text: str, lexicon: Lexicon, language: Language, context: Context) -> Understanding:
    """Understand a sentence of a conversation."""
    return _Conversation(text, lexicon, language, context).understood()


class _Conversation(Changes):
    """Whatever a sentence may be after others, one possibility after the other."""

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
                return self.read(other, self.base) or self.reader(other, self.base).understand()
        reader = self.reader(self.text, self.context)
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
            changed = self.changed(edit)
            if changed is not None:
                return changed
        if edit is not None and reader.tokens[0].norm in self.language.speech["only"]:
            # "only if she is there"; a place alone would only be one more of them
            part = is_pieces(self.reader(edit.new, Context()))
            return (None if part else self._gone_on()) or self._unclear(edit, plain)
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
            return self._unclear(edit, plain)
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

    def _answered(self, answer: Answer | None) -> Understanding | None:
        if answer is None:
            return None
        if answer.dropped:
            return self.dropped()
        if answer.again and self.question is not None:
            return replace(
                rejected(self.text, answer.again, self.context),
                status="clarify",
                suggestions=[self.question.completed(each) for each in self.question.choices[:3]],
                context=replace(self.context, question=self.question),
            )
        alone = None if answer.certain else self.reader(self.text, self.context).understand()
        if alone is not None and (alone.plan is not None or alone.request is not None):
            return None  # another command instead of an answer
        base = self.context.referents()
        result = self.first_read(answer.sentences, base)
        if result is None or not answer.chosen or self.question is None:
            return result
        chosen = (self.question, answer.chosen)
        return replace(result, context=replace(result.context, chosen=chosen))

    def _edit(self) -> Edit | None:
        """The change to the command before that a sentence asks for, if it reads as one."""
        if not self.context.text and self.question is None:
            return None
        reader = self.reader(self.text.rstrip(" .!?…"), self.context)
        try:
            tree = reader.chart().best("edit")
        except (TooMuch, RecursionError):
            return None
        if tree is None:
            return None
        edit: Edit = Discourse(self.language, self.lexicon, reader.tokens, self.text).build(tree)
        return edit

    def _gone_on(self) -> Understanding | None:
        """A sentence that is none in itself, but goes on with the one before: "..., in German",
        "only if she is there"; or asks for the like: "and in the lobby?"."""
        if not self.context.text:
            return None
        before, new = self.before(), self.reader(self.text, Context())
        joined = self.joined(self.text)
        if not self.context.carried_out:  # "the blue one", "the one in the lobby"
            told = one_told_apart(before, new)
            if told is not None:
                return self.first_read(before.corrected(told))
            placed = leading(new, 1) > 0  # "aus der Küche"
            look = None if placed else with_other_look(before, new, instead=True)
            if look is not None:
                return self.read(look, self.base)
        if not self.context.carried_out and self.goes_on(new):
            texts = [self.going_on(text) for text in (joined, self.separate(self.text))]
            variants = [*before.corrected(new)]
            if variants and self.is_number(new):  # "cinq minutes" - "dix"
                texts = []
            result = self.first_read(texts if variants else (*texts, self.there(new)))
            if result is not None:
                return result
        variants = [*before.corrected(new)]
        if not self.goes_on(new) or not variants:
            return None
        joins = self.language.speech["joins"]
        more = new.tokens[0].norm in joins and not self.context.carried_out
        return self.first_read(self.separate(each) if more else each for each in variants)

    def _hanging_on(self, reader: SentenceReader) -> Understanding | None:
        """A command that can be read, but only makes sense after the one before, which waits to be
        carried out: "tell me how many said yes"."""
        plan = self.context.plan
        if plan is None or self.context.carried_out or not reader.reads:
            return None
        whole = self.separate(self.text)
        result = None if self.swallowed(whole) else self.read(whole, self.base)
        if result is None or result.plan in (None, plan):
            return None
        return result

    def _in_that_manner(self, plain: Understanding) -> Understanding | None:
        """ "louder", while something to say waits for its approval: that is to be said louder."""
        if plain.plan is None or self.context.carried_out or not self.speaks():
            return None
        if not methods(plain.plan) <= MANNER:
            return None
        return self.read(f"{self.text.rstrip(' .!?')}. {self.context.text}", self.base)

    def _unclear(self, edit: Edit, plain: Understanding) -> Understanding:
        """Nothing of the command before fits what is said of it. Words that change a command begin
        many a command, too ("remove the plates from the table"): one that cannot be done for a
        reason of its own is told that, and the one before is left alone."""
        if self.reader(self.text, self.context).refuses_with_reason:
            return plain
        new = self.reader(edit.new, self.context)
        if new.tokens and new.refuses_with_reason:
            refused = new.understand()
            if refused.status == "rejected":
                return replace(refused, utterance=self.text)
        if edit.kind == "correct":
            part = edit.new or self.text
            message = self.language.phrase("correct_what", part=part)
        else:
            part = self.text
            message = self.language.phrase("no_change", part=part, before=self.context.text)
        return replace(rejected(self.text, message, self.context), unclear=part)
