"""`nl2robot models`, at a terminal."""

from __future__ import annotations

import json

import pytest

from nl2robot.cli import main as cli
from nl2robot.errors import ExitStatus
from nl2robot.models.catalogue import list_models


def test_what_is_not_installed_comes_with_the_command_that_gets_it(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert cli.main(["models"]) == ExitStatus.OK
    said = capsys.readouterr().out
    for model in list_models():
        assert model.code in said
        assert (f"nl2robot models get {model.code}\n" in said) == (model.state != "installed")


def test_scripts_read_the_same_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["models", "list", "--json"]) == ExitStatus.OK
    told = json.loads(capsys.readouterr().out)
    assert [each["code"] for each in told] == [model.code for model in list_models()]


def test_german_people_read_german(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LANG", "de_CH.UTF-8")
    monkeypatch.delenv("LC_ALL", raising=False)
    assert cli.main(["models"]) == ExitStatus.OK
    assert "englisch" in capsys.readouterr().out.lower()


def test_which_one_is_asked_back(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["models", "get"]) == ExitStatus.BAD_INPUT
    assert "nl2robot models get en" in capsys.readouterr().err


def test_the_speech_model_is_fetched_once_and_whole(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["models", "get", "en"]) == ExitStatus.OK
    assert "The model is in " in capsys.readouterr().out
    assert cli.main(["models", "verify", "en"]) == ExitStatus.OK
    assert "What is installed is whole." in capsys.readouterr().out
