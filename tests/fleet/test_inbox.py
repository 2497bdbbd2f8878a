"""A robot with so much to do that it falls behind with what the others say."""

from __future__ import annotations

import queue
import time

import pytest

from nl2robot.fleet.inbox import Inbox


def test_a_stop_is_looked_at_before_all_that_came_earlier() -> None:
    inbox, done = Inbox(), list[str]()
    inbox.put(lambda came: done.append("how Ben stands"))
    inbox.put(lambda came: done.append("how Cleo stands"))
    inbox.put(lambda came: done.append("stop"), urgent=True)
    inbox.put(lambda came: done.append("stop, said again"), urgent=True)
    for _ in range(4):
        came, deed = inbox.get(0.0)
        assert deed is not None
        deed(came)
    assert done == ["stop", "stop, said again", "how Ben stands", "how Cleo stands"]
    with pytest.raises(queue.Empty):
        inbox.get(0.0)


def test_what_was_said_long_ago_is_not_taken_for_news(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [100.0]
    monkeypatch.setattr(time, "monotonic", lambda: clock[0])
    inbox = Inbox()
    inbox.put(lambda came: None)
    clock[0] = 112.0
    monkeypatch.setattr(queue, "time", lambda: clock[0])
    assert inbox.get(0.0)[0] == 100.0
