"""One number says how likely a draft is what was meant."""

from __future__ import annotations

import json
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar.language import load_language
from grammar.planning.planner import Drafts, Watch
from grammar.planning.rules import RulesPlanner
from nl2robot.deliberation import confidence as module
from nl2robot.deliberation.confidence import READ, WEIGHTS, confidence, features, features_alone
from nl2robot.deliberation.considering import Considered, consider
from nl2robot.deliberation.voting import Count, Vote
from tests.deliberation.drafting import draft, turn

TURN = turn("ward a should get a wave, would you say?")
TURN_OF_RULES = turn("tell Alice that lunch is ready")


def considered(probability: float = 0.5, score: float = -1.0, surest: float = 0.9) -> Considered:
    written = 'goto("ward a")\nif sees("person"):\n    gesture("wave")\n'
    made = consider(TURN, draft(TURN, written, probability, score=score, surest=surest))
    assert made is not None
    return made


def test_without_weights_it_is_the_share_of_the_votes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_weights", dict)
    vote = Vote((considered(0.3), considered(0.2)), 0.5)
    assert confidence(TURN, vote, Count((vote,), ())) == 0.5


def test_it_is_never_more_than_certain(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_weights", dict)
    vote = Vote((considered(),), 1.0000000000000002)
    assert vote.share > 1
    assert confidence(TURN, vote, Count((vote,), ())) == 1


def test_with_weights_it_is_a_logistic_function_of_what_is_known(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    weights = {"model": {"bias": -1.0, "share": 2.0, "surest": 1.0, "no such feature": 5.0}}
    monkeypatch.setattr(module, "_weights", lambda: weights)
    vote = Vote((considered(surest=0.5),), 0.75)
    logit = -1.0 + 2.0 * 0.75 + 0.5
    got = confidence(TURN, vote, Count((vote,), ()))
    assert got == pytest.approx(1 / (1 + math.exp(-logit)))


def test_weights_of_another_planner_say_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "_weights", lambda: {"grammar": {"bias": 9.0}})
    vote = Vote((considered(),), 0.25)
    assert confidence(TURN, vote, Count((vote,), ())) == 0.25


def test_what_is_known_tells_drafts_apart() -> None:
    vote, other = Vote((considered(0.6),), 0.6), Vote((considered(0.2),), 0.2)
    known = features(TURN, vote, Count((vote, other), (considered(0.2),)))
    assert known["share"] == 0.6
    assert known["rivals"] == 1
    assert known["dropped"] == 0.5
    assert known["branches"] == 1
    assert known["lines"] == pytest.approx(math.log1p(3))


def test_the_weights_that_are_delivered_are_numbers_for_what_is_known() -> None:
    vote = Vote((considered(),), 0.5)
    names = {"bias", *features(TURN, vote, Count((vote,), ()))} | {*features_alone(TURN, read())}
    for weights in json.loads(WEIGHTS.read_text("utf-8")).values():
        assert {name for name in weights if not name.startswith(READ)} <= names
        assert {name.removeprefix(READ) for name in weights if name.startswith(READ)} <= readable()
        assert all(math.isfinite(weight) for weight in weights.values())


def read() -> Considered:
    """A draft of the rules."""
    answer = RulesPlanner().plan(TURN_OF_RULES, Watch())
    assert isinstance(answer, Drafts)
    made = consider(TURN_OF_RULES, answer.drafts[0])
    assert made is not None
    return made


def readable() -> set[str]:
    """All that a reading may have: what rules mean, the methods, and the slots."""
    networks = [load_language(each).network for each in ("en", "de", "fr")]
    means = {each.means for network in networks for each in network.productions if each.means}
    return means | {name.strip("{}") for network in networks for name in network.names}


def test_what_rules_have_read_is_known_of_their_draft() -> None:
    known = features_alone(TURN_OF_RULES, read())
    assert known[f"{READ}say_that"] == known[f"{READ}person_name"] == 1
    assert known["texts"] == 1
    assert known["text words"] == pytest.approx(math.log1p(3))
    assert f"{READ}bring" not in known


_NUMBERS = st.floats(-1e6, 1e6)


@given(
    weights=st.dictionaries(
        st.sampled_from(["share", "score", "score by line", "surest", "lines", "unused"]), _NUMBERS
    ),
    bias=_NUMBERS,
    share=st.floats(0, 1),
    score=st.floats(max_value=0, allow_nan=False, allow_infinity=False),
    surest=st.floats(0, 1),
)
def test_it_is_a_probability_whatever_is_known(
    weights: dict[str, float], bias: float, share: float, score: float, surest: float
) -> None:
    first = CONSIDERED
    known = Considered(
        type(first.draft)(
            first.draft.plan,
            "model",
            share,
            first.draft.context,
            score=score,
            surest=surest,
        ),
        first.program,
        first.checked,
    )
    vote = Vote((known,), share)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_weights", lambda: {"model": {"bias": bias, **weights}})
        assert 0 <= confidence(TURN, vote, Count((vote,), ())) <= 1
        patch.setattr(module, "_weights", dict)
        assert 0 <= confidence(TURN, vote, Count((vote,), ())) <= 1


CONSIDERED = considered()
