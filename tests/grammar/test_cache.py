"""A language is compiled once; what is kept of it is never trusted blindly and never needed."""

from __future__ import annotations

from pathlib import Path

import msgspec
import pytest

from grammar import cache, language
from grammar.language import Compiled, languages


class Soup(msgspec.Struct):
    of: str


class Kitchen:
    """Makes soup, and counts how often."""

    def __init__(self) -> None:
        self.times = 0

    def __call__(self) -> Soup:
        self.times += 1
        return Soup("peas")


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(cache, "_folder", lambda: tmp_path / "cache")
    return tmp_path / "cache"


def test_what_was_made_before_is_not_made_again(folder: Path) -> None:
    kitchen = Kitchen()
    for _ in range(3):
        assert cache.kept("soup", [b"recipe"], Soup, kitchen) == Soup("peas")
    assert kitchen.times == 1


def test_from_something_else_it_is_made_anew(folder: Path) -> None:
    kitchen = Kitchen()
    cache.kept("soup", [b"a", b"b"], Soup, kitchen)
    cache.kept("soup", [b"ab"], Soup, kitchen)
    assert kitchen.times == 2


@pytest.mark.parametrize("junk", [b"", b"\xc1junk", msgspec.msgpack.encode({"of": 3})])
def test_what_cannot_be_read_is_made_again(folder: Path, junk: bytes) -> None:
    kitchen = Kitchen()
    cache.kept("soup", [b"recipe"], Soup, kitchen)
    (file,) = folder.iterdir()
    file.write_bytes(junk)
    assert cache.kept("soup", [b"recipe"], Soup, kitchen) == Soup("peas")
    assert kitchen.times == 2


def test_without_a_folder_it_works_all_the_same(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "file").write_text("no folder")
    for folder in (None, tmp_path / "file"):
        monkeypatch.setattr(cache, "_folder", lambda folder=folder: folder)
        assert cache.kept("soup", [b"recipe"], Soup, Kitchen()) == Soup("peas")


def test_old_ones_go(folder: Path) -> None:
    for number in range(2 * cache.MOST_KEPT):
        cache.kept("soup", [bytes([number])], Soup, Kitchen())
    assert len(list(folder.iterdir())) == cache.MOST_KEPT


@pytest.mark.parametrize("code", languages())
def test_a_language_from_the_disk_is_the_same(
    code: str, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    kept: list[Compiled] = []

    def remember(*arguments) -> Compiled:
        kept.append(cache.kept(*arguments))
        return kept[-1]

    monkeypatch.setattr(language, "kept", remember)
    for _ in range(2):
        language.load_language.__wrapped__(code)
    made, read = kept
    assert made == read
    assert made is not read
