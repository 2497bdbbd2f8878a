"""Pepper's own microphones: the sound of the one in front, as `ALAudioDevice` sends it to a service
that we give the robot."""

from __future__ import annotations

import queue
import time
import uuid
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from typing import Any, Final

import qi

from robot_api.capabilities.base import POLL
from robot_api.errors import NotPossible, RobotError
from robot_api.robots.pepper.session import Wire

_RATE: Final = 16_000
"""The one rate at which Pepper gives a single channel."""
_FRONT: Final = 3
_AS_IT_COMES: Final = 0
"""Channels are not interleaved."""
_PATIENCE: Final = 3.0
"""Seconds without a block after which it counts as deaf."""


class _Receiver:
    """What the robot calls with each block of sound; it names the method."""

    def __init__(self) -> None:
        self.blocks: queue.SimpleQueue[bytes] = queue.SimpleQueue()

    def processRemote(self, channels: int, samples: int, stamp: Any, sound: bytearray) -> None:
        self.blocks.put(bytes(sound))


# Without the kinds of the parameters `qi` would take the sound for a text.
_receive = qi.bind(qi.Void, [qi.Int32, qi.Int32, qi.Dynamic, qi.Buffer])
_Receiver.processRemote = _receive(_Receiver.processRemote)  # type: ignore[method-assign]


class PepperMicrophone:
    """A `robot_api.capabilities.sound.Microphone`. It is open only while somebody is listened
    to."""

    def __init__(self, wire: Wire) -> None:
        self._wire = wire

    @contextmanager
    def __call__(self) -> Iterator[Iterable[bytes]]:
        """Raises `NotPossible` when no sound comes, `LostConnection`."""
        receiver = qi.multiThreaded()(_Receiver)()
        name = f"NL2RobotEars{uuid.uuid4().hex[:8]}"
        number = self._wire.register(name, receiver)
        try:
            self._wire.call(
                "ALAudioDevice", "setClientPreferences", name, _RATE, _FRONT, _AS_IT_COMES
            )
            # It looks for us before it answers.
            self._wire.call("ALAudioDevice", "subscribe", name, within=_PATIENCE)
            try:
                yield self._blocks(receiver)
            finally:
                with suppress(RobotError):
                    self._wire.call("ALAudioDevice", "unsubscribe", name)
        finally:
            with suppress(RobotError):
                self._wire.unregister(number)

    def _blocks(self, receiver: _Receiver) -> Iterator[bytes]:
        came = time.monotonic()
        while True:
            try:
                block = receiver.blocks.get(timeout=POLL)
            except queue.Empty:
                self._wire.check()
                if time.monotonic() - came > _PATIENCE:
                    raise NotPossible(
                        f"No sound has come from Pepper's microphones for {_PATIENCE:g} seconds."
                        " Pepper must be able to reach this computer: check its firewall, or write"
                        " 'hearing: server' into the robot file."
                    ) from None
                block = b""
            else:
                came = time.monotonic()
            yield block
