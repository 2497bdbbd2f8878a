"""What is likely to be said, from sentences that may be said: an n-gram model of their subwords.

    expectation = Expectation([subwords.of(text) for text in sentences], len(subwords))
    expectation.after([1, 2921])    # log probability of each subword after these

Words that follow one another in the sentences are likely, other words are not impossible. The
longer the words before are known, the more they count (Witten & Bell 1991).
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Sequence
from math import log
from typing import Final

import numpy as np
from numpy.typing import NDArray

from nl2robot.speech.hear.subwords import BEGIN, END

LENGTH: Final = 5  # subwords that are looked at together
ANYTHING: Final = 1e-4  # probability of any subword anywhere

LogProbabilities = NDArray[np.float32]


class Expectation:
    """For any number of threads."""

    def __init__(
        self,
        sentences: Iterable[Sequence[int]],
        vocabulary: int,
        begin: int = BEGIN,
        end: int = END,
    ) -> None:
        """`sentences` as subwords without `begin` and `end`; `vocabulary`: how many there are."""
        self._begin, self._end = begin, end
        follow: defaultdict[tuple[int, ...], Counter[int]] = defaultdict(Counter)
        for sentence in sentences:
            numbers = (begin, *sentence, end)
            for at in range(1, len(numbers)):
                for length in range(min(LENGTH, at + 1)):
                    follow[numbers[at - length : at]][numbers[at]] += 1
        anywhere = follow.pop((), Counter())
        self._anywhere = np.full(vocabulary, ANYTHING)
        for number, count in anywhere.items():
            self._anywhere[number] += count / anywhere.total()
        self._log_anywhere: LogProbabilities = np.log(self._anywhere).astype(np.float32)
        self._follow = {before: _Following(counts) for before, counts in follow.items()}

    def after(self, before: Sequence[int]) -> LogProbabilities:
        """Log probability of each subword after these, of which the last few count."""
        known: list[_Following] = []
        for length in range(1, min(LENGTH, len(before) + 1)):
            following = self._follow.get(tuple(before[len(before) - length :]))
            if following is None:
                break
            known.append(following)
        if not known:
            return self._log_anywhere
        numbers = known[0].numbers  # what follows more subwords also follows fewer
        likely = self._anywhere[numbers]
        rest = 1.0  # what is left for all that was never seen here
        for following in known:
            likely *= following.rest
            likely[np.searchsorted(numbers, following.numbers)] += following.shares
            rest *= following.rest
        result = self._log_anywhere + np.float32(log(rest))
        result[numbers] = np.log(likely)
        return result

    def of(self, numbers: Sequence[int]) -> float:
        """Log probability of a whole sentence of these subwords."""
        whole = [self._begin, *numbers, self._end]
        return sum(float(self.after(whole[:at])[whole[at]]) for at in range(1, len(whole)))


class _Following:
    """The subwords that were seen after some others: as likely as they are frequent, where new ones
    count as often as there are kinds."""

    def __init__(self, counts: Counter[int]) -> None:
        counted = sorted(counts.items())
        whole = counts.total() + len(counts)
        self.numbers = np.array([number for number, _ in counted], np.int64)
        self.shares = np.array([count for _, count in counted]) / whole
        self.rest = len(counts) / whole
