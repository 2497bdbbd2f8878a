"""Sound from a microphone, as it comes.

    with Microphone("USB") as microphone:  # or Microphone(): the one that the system uses
        for samples in microphone.blocks():
            ...

Nothing here waits without end: a microphone that cannot be opened, gives no sound, or is unplugged
half-way is an `AudioError`.
"""

from __future__ import annotations

import queue
import threading
import time
from collections.abc import Callable, Generator, Iterator, Sequence
from types import TracebackType
from typing import TYPE_CHECKING, Any, Final, TypeVar

from nl2robot.speech.audio import AudioError, Converter, Samples
from nl2robot.speech.sound_cards import sound_cards

if TYPE_CHECKING:
    from miniaudio import Backend, CaptureDevice

CAPTURED: Final = 48_000
"""Samples a second asked of the system: what most microphones have themselves."""
CHANNELS: Final = 2
BLOCK: Final = 20
"""Milliseconds of sound that come at a time."""
PATIENCE: Final = 2.0
"""Seconds without a block after which a microphone counts as lost."""
OPENING: Final = 5.0
"""Seconds that opening may take; a sound server that does not answer takes for ever."""
BEHIND: Final = 30.0
"""Seconds of sound that may wait to be fetched."""

_GONE: Final = None  # in the queue, for the end
T = TypeVar("T")


class Microphone:
    """A microphone that is open, or nothing: to be used in a `with`."""

    def __init__(
        self,
        device: str | None = None,
        *,
        backends: Sequence[Backend] = (),
        patience: float = PATIENCE,
    ) -> None:
        """`device` is a part of its name. `backends` are miniaudio's, the system's own by default:
        its null backend is a silent microphone that every machine has. Raises AudioError."""
        self._patience = patience
        self._blocks: queue.Queue[tuple[bytes, float] | None] = queue.Queue(
            int(BEHIND * 1000 / BLOCK)
        )
        self._too_slow = False
        self._closed = False
        self._device = _in_time(lambda: _opened(device, list(backends)), OPENING)

    def __enter__(self) -> Microphone:
        self._device.stop_callback = self._stopped
        receiver = self._receive()
        next(receiver)  # to where it waits for the first block
        _in_time(lambda: _started(self._device, receiver), OPENING)
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._closed = True
        # One that was unplugged may never be done with closing; nobody waits for it.
        threading.Thread(target=self._device.close, name="close microphone", daemon=True).start()

    def blocks(self) -> Iterator[Samples]:
        """What it hears from now on, 16 kHz. Raises AudioError when it hears no more."""
        return (samples for samples, _ in self.timed_blocks())

    def timed_blocks(self) -> Iterator[tuple[Samples, float]]:
        """As `blocks`, with the time at which each came, on the monotonic clock."""
        converter = Converter(CAPTURED, CHANNELS)
        while True:
            try:
                block = self._blocks.get(timeout=self._patience)
            except queue.Empty:
                raise AudioError(
                    f"No sound has come from the microphone for {self._patience:g} seconds. "
                    "Check that it is plugged in and that no other program keeps it, then try "
                    "again."
                ) from None
            if block is _GONE:
                raise AudioError(
                    "The microphone has stopped; perhaps it was unplugged. "
                    "Plug it in and start again."
                )
            if self._too_slow:
                raise AudioError(
                    "This computer is too busy to listen: sound was lost. "
                    "End other programs and start again."
                )
            sound, came = block
            samples = converter.convert(sound)
            if len(samples):
                yield samples, came

    def _receive(self) -> Generator[None, bytearray, None]:
        """Takes what the device sends, in a thread of its own; must not wait."""
        while True:
            block = yield
            try:
                self._blocks.put_nowait((bytes(block), time.monotonic()))
            except queue.Full:  # half a command may mean the opposite: better none
                self._too_slow = True

    def _stopped(self) -> None:
        if not self._closed:
            try:
                self._blocks.put_nowait(_GONE)
            except queue.Full:
                self._too_slow = True


def devices(backends: Sequence[Backend] = ()) -> list[str]:
    """The names of the microphones that are there. Raises AudioError."""
    return [each["name"] for each in _in_time(lambda: _captures(list(backends)), OPENING)]


def _captures(backends: list[Backend]) -> list[dict[str, Any]]:
    miniaudio = sound_cards(AudioError)
    try:
        found = miniaudio.Devices(backends)
        # Without a sound card, miniaudio falls back on one that is always there and always silent.
        if found.backend == "Null" and not backends:
            return []
        return list(found.get_captures())
    except miniaudio.MiniaudioError:
        return []


def _opened(name: str | None, backends: list[Backend]) -> CaptureDevice:
    miniaudio = sound_cards(AudioError)
    there = _captures(backends)
    if not there:
        raise AudioError(
            "There is no microphone on this computer. "
            "Plug one in, use a recording (nl2robot listen --wav FILE), or type (nl2robot chat)."
        )
    chosen = _named(name, there) if name is not None else None
    try:
        return miniaudio.CaptureDevice(
            nchannels=CHANNELS,
            sample_rate=CAPTURED,
            buffersize_msec=BLOCK,
            device_id=chosen["id"] if chosen else None,
            backends=backends,
            app_name="nl2robot",
        )
    except miniaudio.MiniaudioError as error:
        raise _refused() from error


def _named(name: str, there: list[dict[str, Any]]) -> dict[str, Any]:
    names = [each["name"] for each in there]
    alike = [each for each in there if name.casefold() in each["name"].casefold()]
    exact = [each for each in there if name.casefold() == each["name"].casefold()]
    if len(exact) == 1 or len(alike) == 1:
        return (exact or alike)[0]
    which = "more than one microphone" if alike else "no microphone"
    raise AudioError(
        f"There is {which} called {name!r}. Use one of these names: {'; '.join(names)}."
    )


def _started(device: CaptureDevice, receiver: Generator[None, bytearray, None]) -> None:
    import miniaudio

    try:
        device.start(receiver)
    except miniaudio.MiniaudioError as error:
        raise _refused() from error


def _refused() -> AudioError:
    return AudioError(
        "The microphone cannot be opened. Check that one is plugged in, that programs may use it "
        "(in the system's settings), and that no other program keeps it."
    )


def _in_time(work: Callable[[], T], seconds: float) -> T:
    """What `work` returns or raises. Raises AudioError where it does neither in time; what it then
    still waits for is left to itself, for a call into a driver cannot be ended."""
    done: queue.Queue[tuple[T | None, BaseException | None]] = queue.Queue()

    def run() -> None:
        try:
            done.put((work(), None))
        except BaseException as error:  # noqa: BLE001 - raised where it is waited for
            done.put((None, error))

    threading.Thread(target=run, name="open microphone", daemon=True).start()
    try:
        result, error = done.get(timeout=seconds)
    except queue.Empty:
        raise AudioError(
            f"The sound system has not answered for {seconds:g} seconds. "
            "Restart it, or the computer, and try again."
        ) from None
    if error is not None:
        raise error
    return result  # type: ignore[return-value]
