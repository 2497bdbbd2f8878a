"""`make run` speaks nothing aloud, and says how one would hear it."""

import importlib.util

from nl2robot.cli.commands.demo import how_to_hear


def test_without_a_voice_it_is_said_why_and_how_to_get_one(monkeypatch) -> None:
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    said = how_to_hear()
    assert "Nothing was spoken aloud" in said and "GPL" in said and "make voices" in said


def test_with_one_it_is_said_how_to_hear_it() -> None:
    assert "--speak" in how_to_hear()
