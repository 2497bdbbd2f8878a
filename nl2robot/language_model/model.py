"""A language model that reads tokens and says what may follow, on onnxruntime.

The keys and values of all that was read stand in one room of a fixed size. A `Branch` is a
continuation of what was read before it: it knows which of the rows are its own, so that several
can grow side by side over one beginning, and one that is given up costs nothing.
"""

from __future__ import annotations

import mmap
import os
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from grammar.planning.model.decoding import Full
from nl2robot.language_model.changes import changes
from nl2robot.language_model.files import GRAPH, LEVELS, SCALES, TOKENS, WEIGHTS
from nl2robot.language_model.memory import give_back
from nl2robot.language_model.tokens import Tokens
from nl2robot.language_model.weights import BLOCK, Floats

ROOM: Final = 2048
"""Tokens that can be remembered at once."""
AT_ONCE: Final = 64
"""Tokens of a long text that are read in one go: what is read in more needs more memory."""
_UNSEEN: Final = -1e9
_LIKELY: Final = 32
"""Followers that are sorted at once; hardly ever is a less likely one asked for."""


class Cancelled(Exception):
    """Somebody called `cancel` while the model was reading."""


@dataclass(frozen=True)
class Branch:
    """A text that was read, and where it stands in the room."""

    tokens: tuple[int, ...] = ()
    spans: tuple[tuple[int, int], ...] = ()
    """The rows, first to last and behind it, in order."""
    reading: int = field(default=0, repr=False, compare=False)
    """Which reading of the model it comes of, ..."""
    row: int = field(default=0, repr=False, compare=False)
    """... and at which place."""

    def with_rows(self, start: int, end: int) -> tuple[tuple[int, int], ...]:
        if self.spans and self.spans[-1][1] == start:
            return (*self.spans[:-1], (self.spans[-1][0], end))
        return (*self.spans, (start, end))


class OnnxModel:
    """One model and what it has read. Not for several threads, but for `cancel`."""

    def __init__(
        self,
        folder: Path,
        threads: int | None = None,
        room: int = ROOM,
        learned: Path | None = None,
    ) -> None:
        """`learned` is a file that `nl2robot.training.planner.train` has written for this model.
        Raises `ValueError` if it is of another one."""
        import onnxruntime

        self.tokens = Tokens.load(folder / TOKENS)
        self.room = room
        self._levels = _looked_up(folder / LEVELS)
        self._scales = _looked_up(folder / SCALES)
        options = onnxruntime.SessionOptions()
        options.intra_op_num_threads = threads or os.cpu_count() or 1
        options.enable_cpu_mem_arena = False  # it would keep what the longest prompt needed
        self._session: Any = onnxruntime.InferenceSession(
            folder / GRAPH, options, providers=["CPUExecutionProvider"]
        )
        self._run: Any = None
        self._cancelled = False
        states = [each for each in self._session.get_inputs() if each.name.startswith("key_")]
        shape = (1, states[0].shape[1], room, states[0].shape[3])
        self._kept: dict[str, NDArray[np.float32]] = {
            f"{what}_{layer}": np.zeros(shape, np.float32)
            for layer in range(len(states))
            for what in ("key", "value")
        }
        self._bound = {
            name: onnxruntime.OrtValue.ortvalue_from_numpy(each)
            for name, each in self._kept.items()
        }
        inputs = {each.name: each.shape for each in self._session.get_inputs()}
        self._learned = {
            name: onnxruntime.OrtValue.ortvalue_from_numpy(each)
            for name, each in changes(inputs, learned)
        }
        give_back(folder / WEIGHTS)
        self._options = onnxruntime.RunOptions
        self.used = 0
        """Rows that are taken."""
        self._reading = 0
        """How often it has read."""
        self._scores: Floats = np.zeros((0, 0), np.float32)
        """Of what may follow what was read last, as logarithms of probabilities."""

    # --- reading

    def read(self, pieces: Sequence[tuple[Branch, Sequence[int]]]) -> list[Branch]:
        """Read more tokens, at least one, behind each of some branches, and what then may follow
        them. Raises `Full` and `Cancelled`; the branches are as good as before then."""
        if self.used + sum(len(tokens) for _, tokens in pieces) > self.room:
            raise Full
        longest = max(len(tokens) for _, tokens in pieces)
        if len(pieces) == 1 and longest > AT_ONCE:
            (branch, tokens), branches = pieces[0], []
            for start in range(0, longest, AT_ONCE):
                branches = self._read([(branch, tokens[start : start + AT_ONCE])])
                branch = branches[0]
            return branches
        return self._read(pieces)

    def read_along(self, branch: Branch, tokens: Sequence[int]) -> list[Branch]:
        """Read a few tokens, at least one: the branch behind each of them. Raises as `read`."""
        if self.used + len(tokens) > self.room:
            raise Full
        places = range(len(branch.tokens), len(branch.tokens) + len(tokens))
        start = self.used
        sees = np.full((1, 1, len(tokens), start + len(tokens)), _UNSEEN, np.float32)
        for first, last in branch.spans:
            sees[..., first:last] = 0
        sees[0, 0, :, start:] = _earlier(len(tokens))
        self._compute([*tokens], [*range(len(tokens))], [*places], sees)
        self.used += len(tokens)
        return [
            Branch(
                (*branch.tokens, *tokens[: number + 1]),
                branch.with_rows(start, start + number + 1),
                self._reading,
                number,
            )
            for number in range(len(tokens))
        ]

    def _read(self, pieces: Sequence[tuple[Branch, Sequence[int]]]) -> list[Branch]:
        new = [token for _, tokens in pieces for token in tokens]
        total = self.used + len(new)
        sees = np.full((1, 1, len(new), total), _UNSEEN, np.float32)
        places: list[int] = []
        asked: list[int] = []
        read: list[Branch] = []
        for branch, tokens in pieces:
            first, last = len(places), len(places) + len(tokens)
            for start, end in branch.spans:
                sees[..., first:last, start:end] = 0
            own = slice(self.used + first, self.used + last)
            sees[0, 0, first:last, own] = _earlier(len(tokens))
            places += range(len(branch.tokens), len(branch.tokens) + len(tokens))
            asked.append(last - 1)
            rows = branch.with_rows(own.start, own.stop)
            read.append(Branch((*branch.tokens, *tokens), rows))
        self._compute(new, asked, places, sees)
        self.used = total
        return [replace(each, reading=self._reading, row=row) for row, each in enumerate(read)]

    def _compute(self, new: list[int], asked: list[int], places: list[int], sees: Floats) -> None:
        """The scores of what may follow each of the new tokens that are asked for, by their
        numbers among them."""
        total = self.used + len(new)
        binding = self._session.io_binding()
        for name, value in {
            "embeddings": self._embedded(new)[None],
            "asked": np.array(asked, np.int64),
            "last": np.array([total - 1], np.int32),
            "total": np.array(total, np.int32),
            "places": np.array([places], np.int64),
            "sees": sees,
        }.items():
            binding.bind_cpu_input(name, np.ascontiguousarray(value))
        for name, kept in self._bound.items():
            binding.bind_ortvalue_input(name, kept)
            binding.bind_ortvalue_output(f"new_{name}", kept)
        for name, change in self._learned.items():
            binding.bind_ortvalue_input(name, change)
        binding.bind_output("scores")
        self._run = self._options()
        try:
            if self._cancelled:
                raise Cancelled
            self._session.run_with_iobinding(binding, self._run)
        except Exception as error:
            if self._cancelled:
                raise Cancelled from error
            raise
        finally:
            self._run = None
        scores: Floats = binding.get_outputs()[-1].numpy()[0]
        scores -= scores.max(-1, keepdims=True)
        scores -= np.log(np.exp(scores).sum(-1, keepdims=True))
        self._scores = scores
        self._reading += 1

    def _embedded(self, tokens: list[int]) -> Floats:
        levels = self._levels[tokens].astype(np.float32) - 128
        scaled: Floats = levels * np.repeat(self._scales[tokens], BLOCK, -1)
        return scaled

    def cancel(self) -> None:
        """End what is being read at once; to be called from another thread. Until `resume`, nothing
        more is read."""
        self._cancelled = True
        run = self._run
        if run is not None:
            run.terminate = True

    def resume(self) -> None:
        self._cancelled = False

    def scores(self, branch: Branch) -> Floats:
        """Of what may follow a branch of the last reading, as logarithms of probabilities. What
        follows others is forgotten: that would be half a megabyte for each."""
        assert branch.reading == self._reading, "something else was read since"
        scores: Floats = self._scores[branch.row]
        return scores

    def following(self, branch: Branch) -> Iterator[tuple[int, float]]:
        """The tokens that may follow a branch of the last reading, the likeliest first, with the
        logarithms of their probabilities."""
        scores, written = self.scores(branch), self.tokens.written
        likely = np.argpartition(-scores, _LIKELY)[:_LIKELY]
        seen = likely[np.argsort(-scores[likely], kind="stable")]
        yield from ((written[place], float(scores[place])) for place in seen)
        for place in np.argsort(-scores, kind="stable")[_LIKELY:]:
            yield written[place], float(scores[place])

    # --- what is remembered

    def forget(self, used: int) -> None:
        """Give up all rows from this one on."""
        self.used = used


def _looked_up(file: Path) -> Any:
    """A table of which only a few rows are read: the system need not read those around them."""
    table: Any = np.load(file, mmap_mode="r")
    with suppress(AttributeError):  # Windows takes no advice
        table._mmap.madvise(mmap.MADV_RANDOM)
    return table


def _earlier(tokens: int) -> NDArray[np.float64]:
    """What each of some new tokens sees of them: itself and those before it."""
    return np.triu(np.full((tokens, tokens), _UNSEEN), 1)
