"""Frames from anybody: what is too much is refused before it is read, and JSON is read as JSON."""

from __future__ import annotations

import json
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_api.frame import (
    MAX_DEPTH,
    MAX_FRAME,
    MAX_VALUES,
    NoJson,
    TooMuch,
    Unreadable,
    read_frame,
)

NUMBERS = st.integers(-(2**53), 2**53) | st.floats(allow_nan=False, allow_infinity=False)
JSON = st.recursive(
    st.none() | st.booleans() | NUMBERS | st.text(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)
SIGNS = st.text(alphabet='[]{}",:\\0aN ')


@given(JSON)
def test_json_is_read_as_it_was_written(value: Any) -> None:
    assert read_frame(json.dumps(value)) == value
    assert read_frame(json.dumps(value, ensure_ascii=False)) == value


@given(SIGNS | st.text() | st.binary())
def test_whatever_comes_is_json_or_refused(frame: str | bytes) -> None:
    try:
        value = read_frame(frame)
    except Unreadable as refused:
        assert str(refused).endswith(".")
    else:
        assert value == json.loads(frame)


@given(st.integers(1, 2 * MAX_DEPTH), st.text(alphabet="[{", min_size=1, max_size=1), SIGNS)
def test_it_is_too_deep_from_one_depth_on(depth: int, kind: str, text: str) -> None:
    frame = json.dumps(text)  # brackets in a text are none
    for _ in range(depth):
        frame = f"[{frame}]" if kind == "[" else f'{{"a":{frame}}}'
    if depth <= MAX_DEPTH:
        assert read_frame(frame) == json.loads(frame)
    else:
        with pytest.raises(TooMuch, match="levels deep"):
            read_frame(frame)


@pytest.mark.parametrize(
    "frame",
    [
        "[" + ",".join("1" * (MAX_VALUES + 1)) + "]",
        "[" + ",".join(["[]"] * (MAX_VALUES + 1)) + "]",
        "[" + "{}" * (MAX_VALUES + 1) + "]",
        "[" * MAX_FRAME,
        " " * (MAX_FRAME + 1),
    ],
    ids=["numbers", "lists", "objects", "brackets", "length"],
)
def test_it_holds_only_so_much(frame: str) -> None:
    with pytest.raises(TooMuch):
        read_frame(frame)


def test_commas_in_a_program_are_no_values() -> None:
    program = "f(1, 2)\n" * (2 * MAX_VALUES)
    assert read_frame(json.dumps([program])) == [program]


@pytest.mark.parametrize("number", ["NaN", "-Infinity", "1e400"])
def test_who_sends_no_number_can_be_answered(number: str) -> None:
    with pytest.raises(NoJson, match="NaN") as refused:
        read_frame(f'{{"id": 7, "params": [{number}]}}')
    assert refused.value.message["id"] == 7
