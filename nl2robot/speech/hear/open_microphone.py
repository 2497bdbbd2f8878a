"""A microphone that stays open, so that who answers need not wait for the end of the question.

ears = OpenMicrophone(duplex, lambda: Microphone("USB"))
with ears() as blocks:                 # from where somebody began to speak over the robot
    for samples in blocks:
        ...
"""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Final

from nl2robot.errors import UserError
from nl2robot.speech.audio import RATE, AudioError, Samples
from nl2robot.speech.hear.full_duplex import WINDOW, FullDuplex
from nl2robot.speech.hear.microphone import Microphone

_log: Final = logging.getLogger(__name__)

BEFORE: Final = WINDOW + 0.3
"""Seconds of sound that are always kept: an answer has begun before it is known to be one."""
MOST: Final = 15.0
"""Seconds of an answer that are kept until somebody listens."""
_WAIT: Final = 0.2
_LAST_BLOCK: Final = 0.3
"""Seconds that the sound heard last may take. What it is heard with goes when the program ends."""


class OpenMicrophone:
    """One microphone, for one who listens at a time."""

    def __init__(
        self, duplex: FullDuplex, opened: Callable[[], AbstractContextManager[Microphone]]
    ) -> None:
        self._duplex = duplex
        self._opened = opened
        self._changed = threading.Condition()
        self._blocks: deque[Samples] = deque()
        self._kept = 0  # samples in it
        self._listened_to = False
        self._failed: UserError | None = None
        self._closed = False
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Open it; again, if it was unplugged."""
        if self._thread is None or not self._thread.is_alive():
            self._failed = None
            self._thread = threading.Thread(target=self._run, name="microphone", daemon=True)
            self._thread.start()

    def close(self) -> None:
        self._closed = True
        if self._thread is not None:
            self._thread.join(_LAST_BLOCK)

    @contextmanager
    def __call__(self) -> Iterator[Iterator[Samples]]:
        """What is heard; the iterator raises `UserError` when nothing can be heard any more."""
        self.start()
        self._listened_to = True
        try:
            yield self._listen()
        finally:
            self._listened_to = False
            self._duplex.gave_way = False  # that was the answer

    def _listen(self) -> Iterator[Samples]:
        while True:
            with self._changed:
                while not self._blocks:
                    if self._failed is not None:
                        raise self._failed
                    if self._closed:
                        return
                    self._changed.wait(_WAIT)
                samples = self._blocks.popleft()
                self._kept -= len(samples)
            yield samples

    def _run(self) -> None:
        try:
            with self._opened() as microphone:
                for samples in self._duplex.hear(microphone.timed_blocks()):
                    if self._closed:
                        return
                    self._keep(samples)
        except UserError as error:
            self._failed = error
        except Exception:  # noqa: BLE001 - a fault of ours must not leave somebody waiting for ever
            _log.debug("Listening failed", exc_info=True)
            self._failed = AudioError("Listening failed, so nothing was heard. Ask again.")
        with self._changed:
            self._changed.notify_all()

    def _keep(self, samples: Samples) -> None:
        with self._changed:
            self._blocks.append(samples)
            self._kept += len(samples)
            if not self._listened_to:
                most = MOST if self._duplex.gave_way else BEFORE
                while self._kept - len(self._blocks[0]) > most * RATE:
                    self._kept -= len(self._blocks.popleft())
            self._changed.notify_all()
