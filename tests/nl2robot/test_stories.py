"""Sentences with branches and loops do the right thing in the simulated hospital."""

from pathlib import Path

import pytest

from nl2robot.checks import canned
from sim.world.loading import load_world

STORIES = canned.load(Path(__file__).parents[1] / "stories" / "hospital.yaml")


@pytest.fixture(scope="module")
def hospital():
    return load_world(STORIES.world)


@pytest.mark.parametrize("story", STORIES.tests, ids=[test.say[:60] for test in STORIES.tests])
def test_what_a_sentence_leads_to(story, hospital) -> None:
    suite = canned.Suite(tests=(story,), world=STORIES.world)
    [result] = canned.check(suite, hospital)
    assert not result.failures, f"{result.program}\n" + "\n".join(result.failures)
