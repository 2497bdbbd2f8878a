"""Recordings of every kind come in; what is no recording is refused with a sentence."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import soundfile
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from nl2robot.speech import audio
from nl2robot.speech.audio import RATE, AudioError, Converter, from_float, read, read_bytes
from nl2robot.speech.webm import MAGIC


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
    with pytest.raises(
        AudioError, match=r"is not a recording. Use a wav, flac, ogg, mp3 or webm file"
    ):
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


# --- what a browser records


def element(identity: str, content: bytes, length: int | None = None) -> bytes:
    """Of EBML, its length in eight bytes; -1: "unknown", as a browser writes of what goes on."""
    length = len(content) if length is None else length
    marked = b"\x01" + b"\xff" * 7 if length < 0 else (1 << 56 | length).to_bytes(8, "big")
    return bytes.fromhex(identity) + marked + content


def opus(sound: NDArray[np.float32], rate: int = 48_000) -> tuple[bytes, list[bytes]]:
    """The head and the packets of sound in Opus, taken out of an Ogg file."""
    file = io.BytesIO()
    soundfile.write(file, sound, rate, format="OGG", subtype="OPUS")
    content, at, packets, begun = file.getvalue(), 0, [], b""
    while at < len(content):
        lengths = content[at + 27 : at + 27 + content[at + 26]]
        at += 27 + len(lengths)
        for length in lengths:
            begun += content[at : at + length]
            at += length
            if length < 255:
                packets.append(begun)
                begun = b""
    return packets[0], packets[2:]  # the second one has the tags


def webm(
    head: bytes,
    packets: list[bytes],
    *,
    codec: bytes = b"A_OPUS",
    known: bool = False,
    flags: int = 0x80,
    groups: bool = False,
) -> bytes:
    """As a browser writes it while it records, or, with `known` lengths, afterwards. Before the
    sound there is a picture, and a second cluster begins half-way."""
    picture = element("ae", element("d7", b"\x01") + element("86", b"V_VP8"))
    sound = element("ae", element("d7", b"\x02") + element("86", codec) + element("63a2", head))
    rows = [element("e7", b"\0") + element("a3", b"\x81\0\0\x80picture"), element("e7", b"\x0a")]
    for number, packet in enumerate(packets):
        block = b"\x82\0\0" + bytes([flags]) + packet
        row = element("a0", element("a1", block)) if groups else element("a3", block)
        rows[number * 2 // len(packets)] += row
    length = None if known else -1
    clusters = [element("1f43b675", row, length) for row in rows]
    content = element("ec", b"\0" * 9) + element("1654ae6b", picture + sound) + b"".join(clusters)
    return element("1a45dfa3", element("4282", b"webm")) + element("18538067", content, length)


@pytest.mark.parametrize(("known", "groups"), [(False, False), (True, False), (False, True)])
def test_what_a_browser_records_is_read(tmp_path: Path, known: bool, groups: bool) -> None:
    (tmp_path / "said.webm").write_bytes(webm(*opus(tone(48_000)), known=known, groups=groups))
    heard = read(tmp_path / "said.webm")
    assert heard.seconds == pytest.approx(0.5, abs=0.03)
    assert pitch(heard.samples) == pytest.approx(440, abs=5)
    assert np.abs(heard.samples).max() == pytest.approx(0.5 * 32767, rel=0.15)


def test_a_browsers_recording_need_not_be_a_file() -> None:
    said = read_bytes(webm(*opus(tone(48_000))), "from the tablet")
    assert said.seconds == pytest.approx(0.5, abs=0.03)
    with pytest.raises(AudioError, match=r"The recording from the tablet is empty"):
        read_bytes(b"", "from the tablet")


def test_a_browsers_recording_that_ends_in_the_middle_is_refused() -> None:
    whole = webm(*opus(tone(48_000)))
    for end in (len(whole) - 7, 40, 13, len(MAGIC)):
        with pytest.raises(AudioError, match="ends in the middle"):
            read_bytes(whole[:end], "it")
    known = webm(*opus(tone(48_000)), known=True)
    last = known.rindex(bytes.fromhex("a301"))  # between two packets; only the lengths tell it
    with pytest.raises(AudioError, match="ends in the middle"):
        read_bytes(known[:last], "it")


def test_a_film_without_opus_is_told_from_a_broken_one() -> None:
    head, packets = opus(tone(48_000))
    for film in (
        webm(head, packets, codec=b"A_VORBIS"),
        webm(b"", packets),
        webm(head, packets, flags=0x82),  # laced
        MAGIC + b"\0" * 50,
    ):
        with pytest.raises(
            AudioError, match=r"not of the kind that browsers record \(Opus\)\. Use"
        ):
            read_bytes(film, "it")
    with pytest.raises(AudioError, match="has no sound in it"):
        read_bytes(webm(head, [b""]), "it")


@settings(max_examples=60, deadline=None)
@given(at=st.integers(0, 600), junk=st.binary(max_size=40), end=st.integers(0, 3000))
def test_a_damaged_browsers_recording_is_read_or_refused_and_nothing_else(
    at: int, junk: bytes, end: int
) -> None:
    content = SMALL_WEBM[:at] + junk + SMALL_WEBM[at + len(junk) :]
    try:
        assert read_bytes(content[:end], "it").seconds <= audio.LONGEST
    except AudioError as error:
        assert str(error).count(". ") >= 1


SMALL_WEBM = webm(*opus(tone(48_000, 0.1)))


# --- what headers claim


@pytest.mark.parametrize(
    ("rate", "channels"), [(1, 1), (2**31 - 1, 1), (0, 1), (16_000, 0), (16_000, 1000)]
)
def test_a_header_that_claims_what_no_voice_has_is_refused(rate: int, channels: int) -> None:
    file = io.BytesIO()
    soundfile.write(file, tone(RATE), RATE, format="WAV")
    content = bytearray(file.getvalue())
    content[22:28] = channels.to_bytes(2, "little") + rate.to_bytes(4, "little")
    with pytest.raises(AudioError, match=r"no voice has|is not a recording"):
        read_bytes(bytes(content), "it")


def test_two_hours_are_refused_at_once_and_so_is_what_is_too_large(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with (tmp_path / "shift.wav").open("wb") as file:  # sparse: it takes no room
        soundfile.write(file, tone(RATE), RATE, format="WAV")
        length = 2 * 3600 * RATE * 2
        file.seek(4)
        file.write((36 + length).to_bytes(4, "little"))
        file.seek(40)
        file.write(length.to_bytes(4, "little"))
        file.truncate(44 + length)
    with pytest.raises(AudioError, match=r"120 minutes long. Use one of at most 10 minutes"):
        read(tmp_path / "shift.wav")
    monkeypatch.setattr(audio, "LARGEST", 10 * 1024**2)
    with pytest.raises(AudioError, match=r"larger than 10 MB. Use one of at most 10 minutes"):
        read(tmp_path / "shift.wav")


def test_a_small_file_cannot_unpack_to_more_than_there_is_memory_for() -> None:
    """Nine minutes of silence in eight fast channels: 1 MB, and 9 GB if it were read in one go."""
    file = io.BytesIO()
    with soundfile.SoundFile(file, "w", 96_000, 8, "PCM_16", format="FLAC") as sound:
        second = np.zeros((96_000, 8), np.int16)
        for _ in range(20):
            sound.write(second)
    assert len(file.getvalue()) < 200_000
    assert read_bytes(file.getvalue(), "it").seconds == pytest.approx(20)


# --- live sound


@pytest.mark.parametrize(("rate", "channels"), [(8_000, 1), (16_000, 1), (44_100, 2), (48_000, 2)])
def test_live_sound_becomes_the_same_as_a_file(rate: int, channels: int) -> None:
    sound = np.repeat((tone(rate, 1) * 32767).astype("<i2")[:, np.newaxis], channels, axis=1)
    sent, converter = sound.tobytes(), Converter(rate, channels)
    # As it comes over a wire: pieces of any length, that end in the middle of a sample.
    pieces = [converter.convert(sent[at : at + 333]) for at in range(0, len(sent), 333)]
    live = np.concatenate([*pieces, converter.finish()])
    file = from_float((sound / 32768).astype(np.float32), rate)
    assert len(live) == pytest.approx(len(file.samples), abs=2)
    assert pitch(live) == pytest.approx(440, abs=2)
    assert np.abs(live).max() == pytest.approx(np.abs(file.samples).max(), rel=0.05)


def test_of_live_channels_the_louder_one_is_heard_and_a_crackle_changes_nothing() -> None:
    voice, noise = tone(RATE, 0.1), np.zeros(1600, np.float32)
    converter = Converter(RATE, 2)
    for _ in range(20):
        heard = converter.convert(np.stack([noise, voice], axis=1))
    assert np.abs(heard).max() > 16_000
    crackle = noise.copy()
    crackle[:20] = 0.9
    heard = converter.convert(np.stack([crackle, voice], axis=1))
    assert 16_000 < np.abs(heard).max() < 17_000
    for _ in range(20):  # then the right one is unplugged and the left one plugged in
        heard = converter.convert(np.stack([voice, noise], axis=1))
    assert np.abs(heard).max() > 16_000


def test_live_sound_of_no_rate_is_refused() -> None:
    for rate, channels in ((0, 1), (16_000, 0), (10**9, 1), (48_000, 999)):
        with pytest.raises(AudioError, match=r"cannot be used. Send one channel"):
            Converter(rate, channels)
    assert len(Converter(48_000).convert(b"")) == 0
    assert len(Converter(48_000).convert(b"x")) == 0
