"""How a program is written, token by token: only what may still become one, several in doubt.

The program of the likeliest tokens is written first. Wherever another token would have been nearly
as likely, another draft may be begun there later, so that drafts differ where the model is in doubt
and share all that they have in common.

A model reads several tokens in hardly more time than one. So how the first program goes on is
guessed, and where the model would have chosen the same, it need not be asked again (speculative
decoding: Leviathan et al., arXiv:2211.17192).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import Any, Final, Protocol

from grammar.planning.model.recogniser import CLARIFY, REFUSE, Partial
from grammar.planning.model.request import Written

LOOKED_AT: Final = 24
"""Tokens that are compared at each step."""
FURTHER: Final = 2000
"""Tokens that are looked through where none of these may follow."""
MOST_TOKENS: Final = 320
"""Of one program."""
WAYS_OUT: Final = (f"{REFUSE}(", f"{CLARIFY}(")
LEAST_LIKELY: Final = 4.0
"""By how much less likely than the first another program may be, as a logarithm."""


class Full(Exception):
    """The model can remember no more."""


class LanguageModel(Protocol):
    """A model that reads tokens; `Branch` is its own notion of what it has read."""

    def encode(self, text: str) -> list[int]:
        """The tokens of a text."""
        ...

    def text(self, token: int) -> str:
        """What a token stands for; "" for the end of a program."""
        ...

    def read(self, pieces: Sequence[tuple[Any, Sequence[int]]]) -> list[Any]:
        """Read tokens behind each of some branches; the branches as they are then. Raises
        `Full`."""
        ...

    def read_along(self, branch: Any, tokens: Sequence[int]) -> list[Any]:
        """Read tokens one behind the other: the branch behind each of them. Raises `Full`."""
        ...

    def guess(self, branch: Any, tokens: Sequence[int]) -> Sequence[int]:
        """What probably comes after these tokens behind a branch; costs nothing if it is wrong but
        a little time."""
        ...

    def following(self, branch: Any) -> Iterator[tuple[int, float]]:
        """The tokens that may follow, the likeliest first, with logarithms of probabilities."""
        ...


@dataclass(frozen=True)
class Fork:
    """A place where another token could have been taken."""

    branch: Any
    """What was read before it."""
    draft: Partial
    token: int
    """The other token."""
    draft_after: Partial
    score: float
    """The logarithm of the probability of all tokens up to it."""
    tokens: int
    """How many these are."""
    least: float
    """The logarithm of the probability of the least likely of them."""
    ends: bool = False
    """Whether the program would have ended here."""


@dataclass
class _Growing:
    branch: Any
    draft: Partial
    score: float
    tokens: int = 0
    least: float = 0.0
    pending: tuple[int, ...] = ()
    """Tokens that were chosen and not read yet."""
    done: bool = False
    dead: bool = False


@dataclass
class Decoder:
    """Writes programs for one sentence: the first, then others if they are wanted."""

    model: LanguageModel
    forks: list[Fork] = field(default_factory=list)
    steps: int = 0
    """How often the model was asked to read."""

    def first(
        self,
        prompt: Any,
        begun: Partial,
        on_text: Callable[[str], None] | None = None,
        enough: Callable[[], bool] | None = None,
    ) -> Written | None:
        """The program that is written by taking the likeliest token each time; None if that comes
        to nothing. `prompt` is the branch behind which it is written, `on_text` is told it as it
        grows. Once there was `enough`, no token is written any more."""
        self.forks = []
        growing = [_Growing(prompt, begun, 0.0)]
        return next(self._grown(growing, enough or _never, on_text), None)

    def others(
        self, first: Written, most: int, enough: Callable[[], bool] | None = None
    ) -> Iterator[Written]:
        """Up to `most` other programs, once the first is written; the likeliest first."""
        if first.text.startswith(WAYS_OUT):
            return  # what else could be done is not asked
        least = first.score - LEAST_LIKELY
        others = [self._begun(fork) for fork in self._likeliest(first.text, least, most)]
        known = {first.text}
        for written in sorted(self._grown(others, enough or _never, least=least), key=_by_score):
            if written.text not in known:
                known.add(written.text)
                yield written

    def _likeliest(self, text: str, least: float, most: int) -> list[Fork]:
        """The likeliest places at which another program than this one begins."""
        forks = [
            fork
            for fork in self.forks
            if fork.score > least and (fork.ends or not text.startswith(fork.draft_after.text))
        ]
        return sorted(forks, key=_by_score)[:most]

    def _begun(self, fork: Fork) -> _Growing:
        return _Growing(
            fork.branch,
            fork.draft_after,
            fork.score,
            fork.tokens,
            fork.least,
            pending=(fork.token,),
            done=fork.ends,
        )

    def _grown(
        self,
        growing: list[_Growing],
        enough: Callable[[], bool],
        on_text: Callable[[str], None] | None = None,
        least: float = -math.inf,
    ) -> Iterator[Written]:
        """Write all these to their ends, side by side, but for what becomes less likely than
        `least`, and what is not at its end when there was `enough`."""
        alone = len(growing) == 1 and least == -math.inf
        for each in growing:
            if not each.pending and not each.done:
                self._step(each, fork=alone)
        while True:
            growing[:] = [each for each in growing if not each.dead and each.score > least]
            for each in [each for each in growing if each.done]:
                growing.remove(each)
                yield Written(each.draft.text, each.score, math.exp(each.least), each.tokens)
            if not growing or enough():
                return
            self.steps += 1
            try:
                if alone:
                    self._read_on(growing[0], on_text)
                    continue
                branches = self.model.read([(each.branch, each.pending) for each in growing])
            except Full:
                return  # a half-written program is none
            for each, branch in zip(growing, branches, strict=True):
                each.branch = branch
                self._step(each, fork=False)

    def _read_on(self, each: _Growing, on_text: Callable[[str], None] | None) -> None:
        """Read what was chosen and how it may go on, and choose as long as that is what was
        guessed."""
        guesses = self.model.guess(each.branch, each.pending)
        branches = self.model.read_along(each.branch, (*each.pending, *guesses))
        behind = branches[len(each.pending) - 1 :]
        for branch, guess in zip(behind, (*guesses, None), strict=True):
            each.branch = branch
            self._step(each, fork=True)
            if on_text is not None:
                on_text(each.draft.text)
            if each.done or each.dead or each.pending != (guess,):
                return

    def _step(self, each: _Growing, *, fork: bool) -> None:
        """Choose what follows; remember what else might."""
        choices = self._choices(each)
        if not choices or each.tokens >= MOST_TOKENS:
            each.dead = True
            return
        top = max(score for _, score, _ in choices)
        total = top + math.log(sum(math.exp(score - top) for _, score, _ in choices))
        (token, score, draft), *others = choices
        if fork:
            for other, less, after in others[:3]:
                self.forks.append(
                    Fork(
                        each.branch,
                        each.draft,
                        other,
                        after or each.draft,
                        each.score + less - total,
                        each.tokens + (after is not None),
                        min(each.least, less - total),
                        after is None,
                    )
                )
        each.score += score - total
        each.least = min(each.least, score - total)
        if draft is None:
            each.done = True
            return
        each.tokens += 1
        each.draft = draft
        each.pending = (token,)

    def _choices(self, each: _Growing) -> list[tuple[int, float, Partial | None]]:
        """The tokens that may follow, with the draft behind each; None behind the end."""
        found: list[tuple[int, float, Partial | None]] = []
        for number, (token, score) in enumerate(islice(self.model.following(each.branch), FURTHER)):
            if number >= LOOKED_AT and found:
                break
            text = self.model.text(token)
            if text == "":
                if each.draft.is_whole:
                    found.append((token, score, None))
                continue
            draft = each.draft.extended(text)
            if draft is not None:
                found.append((token, score, draft))
        return found


def _by_score(scored: Fork | Written) -> float:
    return -scored.score


def _never() -> bool:
    return False


__all__ = ["Decoder", "Fork", "Full", "LanguageModel"]
