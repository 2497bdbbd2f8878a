"""A sentence that is being understood. The rules know at once what they know; a language model
thinks about the rest for seconds, in which people want to see how far it is, and to end it."""

from __future__ import annotations

from collections.abc import Callable

from grammar.planning.planner import Interrupted, Watch


class Thought:
    """One sentence, from when it was sent until it is understood or dropped. What a language model
    tells comes from the thread that plans."""

    def __init__(self, words: str, grown: Callable[[], None], heard: int | None = None) -> None:
        """`grown` is called, from any thread, when there is more to be seen of it. `heard`: the
        microphone that it came by; it is thought about where it was heard."""
        self.words = words
        self.heard = heard
        self.deep = heard is not None
        """Whether a language model thinks about it."""
        self.program = ""
        """As far as it is written."""
        self.told_dropped = False
        self.watch = Watch(self._begin, self.write)
        self._cancelled = False
        self._grown = grown

    def cancel(self) -> None:
        """Nobody waits for it any more. What the rules know is known anyhow before this is over."""
        self._cancelled = True
        if self.deep:
            self.watch.cancel()

    def _begin(self) -> None:
        self.deep = True
        if self._cancelled:  # while the rules were asked
            raise Interrupted
        self._grown()

    def write(self, program: str) -> None:
        """So far the program is written."""
        self.program = program
        self._grown()
