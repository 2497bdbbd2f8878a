"""A microphone on a machine that may have none: missing, refused, silent, unplugged."""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import miniaudio
import numpy as np
import pytest

from nl2robot.speech.audio import AudioError
from nl2robot.speech.hear import microphone
from nl2robot.speech.hear.microphone import CAPTURED, CHANNELS, Microphone, devices

NULL = [miniaudio.Backend.NULL]  # a microphone of miniaudio's own that hears nothing


class Plugged:
    """A microphone in the hand of the test, in place of miniaudio's."""

    def __init__(self, **options: Any) -> None:
        self.options = options
        self.stop_callback: Any = None
        self.closed = threading.Event()
        self.receiver: Any = None

    def start(self, receiver: Any) -> None:
        self.receiver = receiver

    def hear(self, samples: np.ndarray[Any, Any]) -> None:
        self.receiver.send(bytearray(samples.astype(np.int16).tobytes()))

    def close(self) -> None:
        self.closed.set()


@pytest.fixture
def plugged(monkeypatch: pytest.MonkeyPatch) -> Iterator[Plugged]:
    device = Plugged()
    there = [{"name": name, "id": name} for name in ("USB Audio", "USB Headset", "Built-in")]
    devices = SimpleNamespace(backend="ALSA", get_captures=lambda: there)

    def opened(**options: Any) -> Plugged:
        device.options = options
        return device

    monkeypatch.setattr(miniaudio, "Devices", lambda _backends: devices)
    monkeypatch.setattr(miniaudio, "CaptureDevice", opened)
    yield device


def stereo(seconds: float) -> np.ndarray[Any, Any]:
    time = np.arange(int(CAPTURED * seconds)) / CAPTURED
    left = np.zeros(len(time))
    return np.stack([left, 10_000 * np.sin(2 * np.pi * 440 * time)], axis=1)


def test_the_microphone_that_every_machine_has_gives_silence_at_16_kilohertz() -> None:
    with Microphone(backends=NULL) as open_one:
        blocks = open_one.blocks()
        first = np.concatenate([next(blocks), next(blocks)])
        blocks.close()
    assert first.dtype == np.int16
    assert not first.any()


def test_when_it_was_heard_is_told_however_late_it_is_fetched(
    plugged: Plugged, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 12.0
    monkeypatch.setattr(microphone, "time", SimpleNamespace(monotonic=lambda: now))
    with Microphone() as open_one:
        plugged.hear(stereo(0.5))
        now = 13.0
        _, came = next(open_one.timed_blocks())
    assert came == 12.0


def test_what_it_hears_comes_as_it_is_heard(plugged: Plugged) -> None:
    """Of a microphone whose left side is dead."""
    with Microphone() as open_one:
        plugged.hear(stereo(0.5))
        plugged.hear(stereo(0.5))
        blocks = open_one.blocks()
        samples = np.concatenate([next(blocks), next(blocks)])
        blocks.close()
    assert len(samples) == pytest.approx(16_000, abs=1000)
    assert np.abs(samples).max() == pytest.approx(10_000, rel=0.05)
    assert plugged.options["nchannels"] == CHANNELS
    assert plugged.closed.wait(5)


def test_a_part_of_the_name_tells_which(plugged: Plugged) -> None:
    Microphone("headset")
    assert plugged.options["device_id"] == "USB Headset"
    Microphone()
    assert plugged.options["device_id"] is None


@pytest.mark.parametrize(
    ("name", "told"), [("usb", "more than one microphone"), ("Neumann", "no microphone")]
)
def test_a_name_that_is_none_or_many_is_told_with_the_names(
    plugged: Plugged, name: str, told: str
) -> None:
    with pytest.raises(AudioError, match=rf"{told} called '{name}'.*: USB Audio; USB Headset; "):
        Microphone(name)


def test_without_a_sound_card_it_is_said_that_there_is_none(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Miniaudio falls back on its silent one; a robot that listens to that waits for ever."""
    fallen_back = SimpleNamespace(backend="Null", get_captures=lambda: [{"name": "Null"}])
    monkeypatch.setattr(miniaudio, "Devices", lambda _backends: fallen_back)
    assert devices() == []
    with pytest.raises(AudioError, match=r"no microphone on this computer. Plug one in, use a"):
        Microphone()


def test_one_that_may_not_be_used_is_refused_with_what_to_check(
    plugged: Plugged, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refused(**_options: Any) -> None:
        raise miniaudio.MiniaudioError("failed to init device", -22)

    monkeypatch.setattr(miniaudio, "CaptureDevice", refused)
    with pytest.raises(AudioError, match=r"cannot be opened. Check that one is plugged in"):
        Microphone()


def test_one_that_does_not_start_is_refused_too(plugged: Plugged) -> None:
    def refused(_receiver: Any) -> None:
        raise miniaudio.MiniaudioError("failed to start audio device", -22)

    plugged.start = refused  # type: ignore[method-assign]
    with pytest.raises(AudioError, match="cannot be opened"), Microphone():
        pass


def test_one_that_is_unplugged_half_way_is_told_at_once(plugged: Plugged) -> None:
    with Microphone() as open_one:
        plugged.hear(stereo(0.5))
        blocks = open_one.blocks()
        assert len(next(blocks)) > 0
        plugged.stop_callback()
        with pytest.raises(AudioError, match=r"has stopped; perhaps it was unplugged"):
            next(blocks)


def test_one_that_falls_silent_without_a_word_is_noticed(plugged: Plugged) -> None:
    with (
        Microphone(patience=0.01) as open_one,
        pytest.raises(AudioError, match=r"No sound has come from the microphone for 0.01 seconds"),
    ):
        next(open_one.blocks())


def test_closing_it_is_no_unplugging_and_waits_for_nobody(plugged: Plugged) -> None:
    held = threading.Event()
    plugged.close = held.wait  # type: ignore[method-assign, assignment]
    with Microphone() as open_one:
        pass
    plugged.stop_callback()
    assert open_one._blocks.empty()
    held.set()


def test_a_sound_system_that_does_not_answer_is_given_up(
    plugged: Plugged, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = threading.Event()
    monkeypatch.setattr(microphone, "OPENING", 0.01)
    monkeypatch.setattr(miniaudio, "CaptureDevice", lambda **_options: held.wait())
    with pytest.raises(AudioError, match=r"has not answered for 0.01 seconds"):
        Microphone()
    held.set()


def test_who_cannot_keep_up_is_told_rather_than_given_half_a_command(
    plugged: Plugged, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(microphone, "BEHIND", 0.1)
    with Microphone() as open_one:
        for _ in range(6):  # five fit
            plugged.hear(stereo(0.02))
        with pytest.raises(AudioError, match=r"too busy to listen: sound was lost"):
            next(open_one.blocks())


def test_alsa_does_not_write_its_search_to_the_terminal(capfd: pytest.CaptureFixture[str]) -> None:
    """On a machine without a sound card it told of it in fifty lines."""
    with contextlib.suppress(AudioError):
        Microphone(backends=[miniaudio.Backend.ALSA])
    assert "ALSA" not in capfd.readouterr().err
