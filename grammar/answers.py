"""An answer to a question back: which of several was meant, or what was left out."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from grammar.language import Language
from grammar.naming import joined_up
from grammar.tokens import Token, tokenise

if TYPE_CHECKING:
    from grammar.understanding import Clarification

ALIKE: Final = 80
"""How alike a word must be to one of a choice, in percent."""


@dataclass(frozen=True)
class Answer:
    """What an answer makes of the sentence that the question was about."""

    chosen: str = ""
    """Which of the choices it is, if it is one of them."""
    sentences: tuple[str, ...] = ()
    """The completed sentence; the likeliest of several first."""
    certain: bool = True
    """Whether it can be nothing but an answer; otherwise it may be a command of its own."""
    dropped: bool = False
    """Whether nothing is to be done after all."""
    again: str = ""
    """The question to be asked once more."""


def answer_to(
    text: str, question: Clarification, language: Language, *, loosely: bool = False
) -> Answer | None:
    """What an answer makes of the sentence; None if it is no answer. `loosely`: it is no command
    either, so that any words may be what was asked for."""
    reply = _Reply(text, question, language)
    return reply.loose() if loosely else reply.answer()


class _Reply:
    def __init__(self, text: str, question: Clarification, language: Language) -> None:
        self.text = text
        self.question = question
        self.language = language
        self.tokens = tokenise(text, language.spelling)
        self.fillers = {word for filler in language.fillers for word in filler}
        self.words = [token.norm for token in self.tokens if token.kind != "mark"]
        self.said = tuple(word for word in self.words if word not in self.fillers)

    def answer(self) -> Answer | None:
        choices = self.question.choices
        if self.is_one_of("answered_none") or self.is_one_of("refuse"):
            return Answer(dropped=True)
        if self.is_one_of("unsure"):
            return Answer(again=self.question.question)
        if len(choices) == 1 and self.is_one_of("agree"):
            return self._with(choices[0])
        if self.is_one_of("answered_any") and choices:
            return self._with(choices[0])
        if self.is_one_of("answered_all") and choices:
            return self._with_all(choices)
        number = self._ordinal()
        if number is not None and self.question.asked:
            return self._with(choices[number])
        return self._named()

    def loose(self) -> Answer | None:
        """Whatever was said, in the place of what was asked for."""
        if not self.words:
            return None
        named = self._named()
        if named is not None and named.sentences:
            return named
        text = self.text.strip(" .!?")
        start = 0
        while start < len(self.tokens) and self.tokens[start].norm in self.language.closed:
            start += 1
        noun = text[self.tokens[start].start :] if start < len(self.tokens) else text
        return Answer(
            sentences=(
                self._completed(text),
                replace_before(self.question, text),
                self._completed(noun),
                replace_before(self.question, noun),
            )
        )

    # --- ways to answer

    def _named(self) -> Answer | None:
        """Some of the choices by their names, maybe with more to do after them."""
        meant = self._meant(self.tokens)
        if len(meant) == 1:
            return self._with(meant[0])
        if len(meant) > 1:
            if self._tells_apart(meant):
                return self._with_all(tuple(meant))
            return Answer(again=self.question.question)
        joins = self.language.speech.get("joins", ())
        for at, token in enumerate(self.tokens):
            if at and (token.kind == "mark" or token.norm in joins):
                meant = self._meant(self.tokens[:at])
                rest = self.text[token.start :].lstrip(" ,.")
                if len(meant) == 1 and rest:
                    whole = self._completed(meant[0]).rstrip(" .!?")
                    return Answer(sentences=(f"{whole} {rest}", f"{whole}. {rest}"), certain=False)
        return None

    def _meant(self, tokens: tuple[Token, ...]) -> list[str]:
        """The choices that all these words may be of; none if some word is of none."""
        content = self._content(token.norm for token in tokens if token.kind != "mark")
        if not content:
            return []
        found = {choice: self._hits(choice, content) for choice in self.question.choices}
        if set().union(*found.values(), set()) != set(content):
            return []
        most = max(len(hits) for hits in found.values())
        whole = [choice for choice, hits in found.items() if len(hits) == len(content)]
        return whole or [choice for choice, hits in found.items() if hits and most]

    def _content(self, words: Iterable[str]) -> list[str]:
        silent = self.language.closed | self.fillers | self._counted
        return [word for word in words if word not in silent]

    def _hits(self, choice: str, content: list[str]) -> set[str]:
        from rapidfuzz import fuzz

        names = self.language.tokens_of(choice)
        return {word for word in content if any(fuzz.ratio(word, name) >= ALIKE for name in names)}

    def _tells_apart(self, meant: list[str]) -> bool:
        """Whether each of the choices was named by a word of its own."""
        content = self._content(self.words)
        hits = [self._hits(choice, content) for choice in meant]
        return all(
            hit - set().union(*(other for other in hits if other is not hit)) for hit in hits
        )

    def _ordinal(self) -> int | None:
        """ "the second one"."""
        counted = self._counted | self.language.closed
        said = [word for word in self.said if word not in counted]
        if len(said) != 1 and len(self.said) != 1:
            return None
        word = said[0] if said else self.said[0]
        if any((word,) == self.language.tokens_of(way) for way in self._data("last_of_them")):
            return -1 if self.question.choices else None
        for number, ways in enumerate(self._data("ordinals")):
            said_so = any((word,) == self.language.tokens_of(str(way)) for way in ways)
            if said_so and number < len(self.question.choices):
                return number
        return None

    def _with(self, choice: str) -> Answer:
        return Answer(sentences=(self._completed(choice),), chosen=choice)

    def _with_all(self, choices: tuple[str, ...]) -> Answer:
        joiner = f" {self.language.speech['joined_by']} "
        return Answer(sentences=(self._completed(joiner.join(choices)),))

    def _completed(self, words: str) -> str:
        return joined_up(self.question.completed(words), self.language)

    def is_one_of(self, name: str) -> bool:
        ways = {self.language.tokens_of(way) for way in self._data(name)}
        return tuple(self.words) in ways or self.said in ways

    @property
    def _counted(self) -> set[str]:
        """ "one", in "the second one"."""
        return {
            word for way in self._data("counted_words") for word in self.language.tokens_of(way)
        }

    def _data(self, name: str) -> list[str]:
        data: list[str] = self.language.speech.get(name, [])
        return data


def other_choice(text: str, asked: Clarification, taken: str, language: Language) -> str | None:
    """ "the other one": the sentence with the other choice of two, if that is what was said."""
    reply = _Reply(text, asked, language)
    others = [choice for choice in asked.choices if choice != taken]
    if len(others) != 1 or not reply.is_one_of("the_other"):
        return None
    return joined_up(asked.completed(others[0]), language)


def replace_before(question: Clarification, words: str) -> str:
    """The sentence with these words instead, without what else would have to stand before them."""
    return question.text[: question.start] + words + question.text[question.end :]
