"""Recordings of every kind come in; what is no recording is refused with a sentence."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from nl2robot.speech import audio
from nl2robot.speech.audio import RATE, AudioError, from_float, read


def tone(rate: int, seconds: float = 0.5, hertz: float = 440.0) -> NDArray[np.float32]:
    time = np.arange(int(rate * seconds)) / rate
    return (0.5 * np.sin(2 * np.pi * hertz * time)).astype(np.float32)


def pitch(samples: NDArray[np.int16]) -> float:
    spectrum = np.abs(np.fft.rfft(samples.astype(float) * np.hanning(len(samples))))
    return float(np.argmax(spectrum)) * RATE / len(samples)


@pytest.mark.parametrize("rate", [8_000, 11_025, 16_000, 22_050, 44_100, 48_000])
def test_every_rate_becomes_16_kilohertz(tmp_path: Path, rate: int) -> None:
    soundfile.write(tmp_path / "bell.wav", tone(rate), rate)
    heard = read(tmp_path / "bell.wav")
    assert heard.samples.dtype == np.int16
    assert heard.seconds == pytest.approx(0.5, abs=0.01)
    assert pitch(heard.samples) == pytest.approx(440, abs=5)
    assert np.abs(heard.samples).max() == pytest.approx(0.5 * 32767, rel=0.05)


@pytest.mark.parametrize(
    ("name", "options"),
    [
        ("bell.wav", {"subtype": "PCM_U8"}),
        ("bell.wav", {"subtype": "PCM_24"}),
        ("bell.wav", {"subtype": "PCM_32"}),
        ("bell.wav", {"subtype": "FLOAT"}),
        ("bell.wav", {"subtype": "DOUBLE"}),
        ("bell.wav", {"subtype": "ULAW"}),
        ("bell.flac", {}),
        ("bell.ogg", {}),
        ("bell.mp3", {}),
    ],
    ids=lambda value: value if isinstance(value, str) else value.get("subtype", ""),
)
def test_every_format_is_read(tmp_path: Path, name: str, options: dict[str, Any]) -> None:
    soundfile.write(tmp_path / name, tone(44_100), 44_100, **options)
    heard = read(tmp_path / name)
    assert heard.seconds == pytest.approx(0.5, abs=0.1)
    assert pitch(heard.samples) == pytest.approx(440, abs=5)


def test_of_two_channels_the_louder_one_is_heard(tmp_path: Path) -> None:
    """The microphone on the left was unplugged; elsewhere one is wired the wrong way round."""
    right = tone(RATE)
    soundfile.write(tmp_path / "a.wav", np.stack([np.zeros_like(right), right], axis=1), RATE)
    soundfile.write(tmp_path / "b.wav", np.stack([right, -right], axis=1), RATE)
    for name in ("a.wav", "b.wav"):
        assert np.abs(read(tmp_path / name).samples).max() > 16_000


def test_too_loud_and_broken_samples_are_clipped_not_wrapped_round() -> None:
    frames = np.array([[2.0], [-3.0], [np.nan], [np.inf]], np.float32)
    assert from_float(frames, RATE).samples.tolist() == [32767, -32767, 0, 32767]


def wav(path: Path) -> Path:
    soundfile.write(path, tone(RATE), RATE)
    return path


def test_a_recording_that_ends_in_the_middle_is_refused(tmp_path: Path) -> None:
    """Half a command may mean the opposite."""
    path = wav(tmp_path / "command.wav")
    path.write_bytes(path.read_bytes()[:-4000])
    with pytest.raises(AudioError, match="ends in the middle"):
        read(path)


def test_a_flac_that_ends_in_the_middle_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "command.flac"
    soundfile.write(path, np.random.default_rng(0).uniform(-0.5, 0.5, RATE), RATE)
    path.write_bytes(path.read_bytes()[:12_000])
    with pytest.raises(AudioError):
        read(path)


def test_a_wav_written_into_a_pipe_does_not_know_its_length_and_is_read(tmp_path: Path) -> None:
    path = wav(tmp_path / "piped.wav")
    content = bytearray(path.read_bytes())
    data = content.index(b"data")
    content[data + 4 : data + 8] = content[4:8] = b"\xff\xff\xff\xff"
    path.write_bytes(content)
    assert read(path).seconds == pytest.approx(0.5)


def test_a_film_is_refused_before_it_fills_the_memory(tmp_path: Path) -> None:
    soundfile.write(tmp_path / "film.flac", np.zeros(8000 * 601, np.int16), 8000)
    with pytest.raises(AudioError, match=r"10 minutes long. Use one of at most 10 minutes"):
        read(tmp_path / "film.flac")


def test_what_is_not_there_not_a_file_or_empty_is_said(tmp_path: Path) -> None:
    with pytest.raises(AudioError, match="is not there"):
        read(tmp_path / "missing.wav")
    with pytest.raises(AudioError, match="is a folder"):
        read(tmp_path)
    (tmp_path / "empty.wav").write_bytes(b"")
    with pytest.raises(AudioError, match="is empty"):
        read(tmp_path / "empty.wav")
    soundfile.write(tmp_path / "silent.wav", np.zeros(0, np.int16), RATE)
    with pytest.raises(AudioError, match="has no sound in it"):
        read(tmp_path / "silent.wav")


@pytest.mark.parametrize("content", [b"Dear nurse,", b"%PDF-1.7\n", b"\x00" * 100, b"RIFF"])
def test_what_is_no_recording_is_said(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "letter.wav").write_bytes(content)
    with pytest.raises(AudioError, match=r"is not a recording. Use a wav, flac, ogg or mp3 file"):
        read(tmp_path / "letter.wav")


@settings(
    max_examples=80, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(at=st.integers(0, 1000), junk=st.binary(max_size=64), end=st.integers(0, 1100))
def test_a_damaged_file_is_read_or_refused_and_nothing_else(
    tmp_path: Path, at: int, junk: bytes, end: int
) -> None:
    soundfile.write(tmp_path / "x.wav", tone(8000, 0.0625), 8000)
    content = (tmp_path / "x.wav").read_bytes()
    (tmp_path / "x.wav").write_bytes((content[:at] + junk + content[at + len(junk) :])[:end])
    try:
        heard = read(tmp_path / "x.wav")
    except AudioError as error:
        assert str(error).count(". ") >= 1  # what happened, and what to do
    else:
        assert heard.samples.ndim == 1
        assert 0 < heard.seconds <= audio.LONGEST
