"""What a model has read before every sentence is kept on disk; whatever becomes of the disk, what
it says next is the same."""

from __future__ import annotations

import errno
import io
import os
import random
import shutil
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nl2robot.language_model import remembered as module
from nl2robot.language_model.install import install
from nl2robot.language_model.model import Branch, OnnxModel
from nl2robot.language_model.remembered import MOST_KEPT, remembered
from tests.language_model.tiny import Tiny

TEXT = "say Bob"
CLOSE = 0.05
"""What was kept is kept in half the bytes."""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tiny")
    Tiny().write(folder / "tiny.gguf")
    install(folder / "tiny.gguf", folder)
    return folder


@pytest.fixture(scope="module")
def model(folder: Path) -> OnnxModel:
    return OnnxModel(folder, threads=1, room=64)


@pytest.fixture(scope="module")
def wanted(model: OnnxModel) -> Any:
    """What the model says behind the text, read at this moment."""
    model.forget(0)
    [branch] = model.read([(Branch(), model.tokens.encode(TEXT, control=True))])
    [branch] = model.read([(branch, [40])])
    return branch.scores


@pytest.fixture(autouse=True)
def cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    return tmp_path / "cache"


@pytest.fixture
def reads(model: OnnxModel, monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many tokens the model has had to read, each time."""
    counted: list[int] = []
    read = model.read

    def noted(pieces: Any) -> Any:
        counted.append(sum(len(tokens) for _, tokens in pieces))
        return read(pieces)

    monkeypatch.setattr(model, "read", noted)
    return counted


def said(model: OnnxModel, folder: Path, text: str = TEXT) -> Any:
    """What the model says next."""
    branch = remembered(model, folder, text)
    assert model.used == len(branch.tokens)
    [branch] = OnnxModel.read(model, [(branch, [40])])
    return branch.scores


def kept(cache: Path) -> Path:
    [file] = cache.glob("read-*.npz")
    return file


def test_what_is_kept_is_not_read_again(
    model: OnnxModel, folder: Path, wanted: Any, reads: list[int]
) -> None:
    said(model, folder)
    assert len(reads) == 1
    assert np.abs(said(model, folder) - wanted).max() < CLOSE
    assert len(reads) == 1


def bit_flipped(content: bytes, luck: random.Random) -> bytes:
    """With a wrong byte where it hurts most often: in what describes the rest."""
    marks = [at for at in range(len(content)) if content[at : at + 2] == b"PK"]
    at = min(luck.choice(marks) + luck.randrange(150), len(content) - 1)
    return content[:at] + bytes([luck.randrange(256)]) + content[at + 1 :]


def array() -> bytes:
    file = io.BytesIO()
    np.save(file, np.zeros(3))
    return file.getvalue()


def arrays(**known: Any) -> bytes:
    file = io.BytesIO()
    np.savez(file, allow_pickle=False, **known)
    return file.getvalue()


DAMAGES: dict[str, Callable[[bytes], bytes]] = {
    "empty": lambda good: b"",
    "cut off": lambda good: good[: len(good) // 2],
    "cut off at the very end": lambda good: good[:-1],
    "zeros": lambda good: bytes(len(good)),
    "a picture": lambda good: b"\x89PNG\r\n\x1a\n" + good[8:],
    "a single array": lambda good: array(),
    "a pickle": lambda good: b"\x80\x04K\x01.",
    "of a model with fewer layers": lambda good: arrays(key_0=np.zeros((1, 2, 5, 64))),
    "of a text of one token": lambda good: arrays(
        **{f"{what}_{n}": np.zeros((1, 2, 1, 64)) for what in ("key", "value") for n in (0, 1)}
    ),
    "words": lambda good: arrays(key_0=np.array(["tea"])),
}


@pytest.mark.parametrize("damage", DAMAGES.values(), ids=DAMAGES)
def test_a_damaged_file_is_made_anew(
    damage: Callable[[bytes], bytes],
    model: OnnxModel,
    folder: Path,
    cache: Path,
    wanted: Any,
    reads: list[int],
) -> None:
    said(model, folder)
    kept(cache).write_bytes(damage(kept(cache).read_bytes()))
    assert np.abs(said(model, folder) - wanted).max() < CLOSE
    assert len(reads) == 2
    assert np.abs(said(model, folder) - wanted).max() < CLOSE
    assert len(reads) == 2, "the file was not made anew"


def test_wrong_bytes_anywhere_change_nothing(
    model: OnnxModel, folder: Path, cache: Path, wanted: Any
) -> None:
    said(model, folder)
    good, luck = kept(cache).read_bytes(), random.Random()
    for _ in range(50):
        damaged = bit_flipped(good, luck)
        kept(cache).write_bytes(damaged)
        assert np.abs(said(model, folder) - wanted).max() < CLOSE, damaged


def test_a_cache_that_may_only_be_read_is_used(
    model: OnnxModel,
    folder: Path,
    cache: Path,
    reads: list[int],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    said(model, folder)

    def refused(*_: object, **__: object) -> None:
        raise PermissionError(errno.EACCES, "Permission denied")

    monkeypatch.setattr(os, "utime", refused)
    monkeypatch.setattr(module.tempfile, "mkstemp", refused)
    said(model, folder)
    assert len(reads) == 1
    said(model, folder, "say hello")  # not kept
    assert len(reads) == 2
    assert len([*cache.iterdir()]) == 1


def test_a_cache_that_cannot_be_is_done_without(
    model: OnnxModel, folder: Path, cache: Path, wanted: Any
) -> None:
    cache.write_text("I am a file.")
    for _ in range(2):
        assert np.abs(said(model, folder) - wanted).max() < CLOSE
    cache.unlink()
    said(model, folder)
    file = kept(cache)
    file.unlink()
    file.mkdir()  # somebody was funny
    assert np.abs(said(model, folder) - wanted).max() < CLOSE
    assert [*cache.iterdir()] == [file]


@pytest.mark.parametrize("error", [OSError(errno.ENOSPC, "No space left"), MemoryError()])
def test_a_full_disk_costs_time_and_leaves_nothing(
    error: Exception,
    model: OnnxModel,
    folder: Path,
    cache: Path,
    wanted: Any,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    def full(file: Any, **_: Any) -> None:
        file.write(b"PK")
        raise error

    monkeypatch.setattr(np, "savez", full)
    assert np.abs(said(model, folder) - wanted).max() < CLOSE
    assert [*cache.iterdir()] == []


def test_another_model_in_the_same_folder_reads_for_itself(
    folder: Path, cache: Path, tmp_path: Path
) -> None:
    place = tmp_path / "model"
    shutil.copytree(folder, place)
    said(OnnxModel(place, threads=1, room=64), place)
    Tiny(seed=1).write(place / "tiny.gguf")
    install(place / "tiny.gguf", place)
    other = OnnxModel(place, threads=1, room=64)
    [alone] = other.read([(Branch(), [*other.tokens.encode(TEXT, control=True), 40])])
    other.forget(0)
    assert np.abs(said(other, place) - alone.scores).max() < CLOSE
    assert len([*cache.iterdir()]) == 2


def test_what_it_has_learned_since_counts(folder: Path, cache: Path, tmp_path: Path) -> None:
    said(OnnxModel(folder, threads=1, room=64), folder)
    luck = np.random.default_rng(7)
    learned = {
        f"0.{product}.{side}": luck.normal(0, 0.1, shape).astype(np.float16)
        for product, rows in (("qkv", 512), ("told", 256))
        for side, shape in (("down", (3, 256)), ("up", (rows, 3)))
    }
    np.savez(tmp_path / "learned.npz", allow_pickle=False, **learned)
    wiser = OnnxModel(folder, threads=1, room=64, learned=tmp_path / "learned.npz")
    [alone] = wiser.read([(Branch(), [*wiser.tokens.encode(TEXT, control=True), 40])])
    wiser.forget(0)
    assert np.abs(said(wiser, folder) - alone.scores).max() < CLOSE
    assert len([*cache.iterdir()]) == 2


def test_the_oldest_go_and_what_was_never_finished(
    model: OnnxModel, folder: Path, cache: Path
) -> None:
    cache.mkdir()
    long_ago = time.time() - 2 * module.ABANDONED
    for name in ("killed", "writing"):
        (cache / f".read-{name}").write_bytes(b"PK")
    os.utime(cache / ".read-killed", (long_ago, long_ago))
    (cache / "something else").touch()
    for number in range(MOST_KEPT + 2):
        said(model, folder, f"say {number}")
        for age, file in enumerate(sorted(cache.glob("read-*"), key=lambda f: f.stat().st_mtime)):
            os.utime(file, (long_ago + age, long_ago + age))
    names = {file.name for file in cache.iterdir()}
    assert {".read-writing", "something else"} < names
    assert ".read-killed" not in names
    assert len(names) == MOST_KEPT + 2
