"""Goals that a robot pursues: actions of ROS 2, actionlib of ROS 1.

rosbridge hides much of an action: nobody says that a goal was taken, a cancel on the connection of
the goal waits until the goal has been reached, and an answer may be missing. So a goal has a
connection of its own, is cancelled by the robot's own service (ROS 2) or topic (ROS 1) on the
connection that stops, and one that was given up is cancelled again whenever it is heard of.
"""

from __future__ import annotations

import threading
import time
import uuid
from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any

from robot_api.driver import StopFlag
from robot_api.errors import LostConnection
from robot_api.robots.ros.connection import Connection
from robot_api.robots.ros.dialect import Dialect, field
from robot_api.robots.ros.wire import Answer

SUCCEEDED, CANCELED, ABORTED, REJECTED = "succeeded", "canceled", "aborted", "rejected"
_ROS2 = {4: SUCCEEDED, 5: CANCELED, 6: ABORTED}
_ROS1 = {2: CANCELED, 3: SUCCEEDED, 4: ABORTED, 5: REJECTED, 8: CANCELED}
_ROS1_GOING_ON = (0, 1, 6, 7)
"""actionlib_msgs/GoalStatus: pending, active, preempting, recalling."""
_CANCEL_EVERY = 0.2
"""Seconds between two cancels of a goal that was given up and is still heard of."""
_ALL = {"goal_id": {"uuid": [0] * 16}, "stamp": {"sec": 0, "nanosec": 0}}


class Pursuit:
    """A goal on its way."""

    def __init__(self) -> None:
        self.ended = threading.Event()
        self.outcome = ""
        self.values: Any = None
        """What came with the outcome: the result's fields, or a text."""
        self.text = ""
        """What the robot says about the outcome, if it does."""
        self.heard = 0.0
        """When it was last heard of, on the monotonic clock; 0 for never."""
        self.feedback: Any = None
        self.given_up = False
        self.cancelled = 0.0
        """When it was last cancelled, on the monotonic clock."""

    def end(self, outcome: str, values: Any, text: str = "") -> None:
        self.outcome, self.values, self.text = outcome, values, text
        self.ended.set()


class Cancelling(ABC):
    """A cancel of everything that an action server pursues."""

    @abstractmethod
    def confirmed(self, since: float) -> bool:
        """Whether the server has said that it pursues nothing more; what it says by itself counts
        from `since` on, on the monotonic clock."""


class Action(ABC):
    """An action server on the robot."""

    def __init__(self, connection: Connection, name: str, kind: str) -> None:
        self.name = name
        self._connection = connection
        self._line = connection.line(name)
        self._kind = kind
        self._lock = threading.Lock()
        self._pursuits: dict[str, Pursuit] = {}

    @abstractmethod
    def cancel_all(self) -> Cancelling:
        """Cancel every goal, whoever gave it. Raises `LostConnection`."""

    def start(self, goal: Mapping[str, Any], stop: StopFlag) -> Pursuit:
        """Raises `LostConnection` and `Stopped`."""
        pursuit = Pursuit()
        with self._lock:
            stop.check()  # a stop from now on finds the goal under way
            self._send(goal, pursuit)
        return pursuit

    def give_up(self, pursuit: Pursuit) -> None:
        """Cancel it, and again should it be heard of. Does not wait."""
        pursuit.given_up = True
        if pursuit.ended.is_set() or time.monotonic() - pursuit.cancelled < _CANCEL_EVERY:
            return
        pursuit.cancelled = time.monotonic()
        try:
            self._cancel(pursuit)
            self.cancel_all()
        except LostConnection:
            pass  # the first thing that the robot hears when it is found is a stop

    @abstractmethod
    def _send(self, goal: Mapping[str, Any], pursuit: Pursuit) -> None: ...

    @abstractmethod
    def _cancel(self, pursuit: Pursuit) -> None:
        """This one, where the goal was given."""

    def _hear(self, pursuit: Pursuit, feedback: Any) -> None:
        pursuit.heard, pursuit.feedback = time.monotonic(), feedback
        if pursuit.given_up:
            self.give_up(pursuit)


class _Ros2Cancelling(Cancelling):
    def __init__(self, answer: Answer) -> None:
        self._answer = answer

    def confirmed(self, since: float) -> bool:
        """Nothing to cancel is as good; only that it refuses (1) is not."""
        return self._answer.ok and field(self._answer.values, "return_code") != 1


class Ros2Action(Action):
    def cancel_all(self) -> Cancelling:
        service = f"{self.name}/_action/cancel_goal"
        return _Ros2Cancelling(self._connection.halt.now.ask(service, {"goal_info": _ALL}))

    def _send(self, goal: Mapping[str, Any], pursuit: Pursuit) -> None:
        package, _, kind = self._kind.partition("/")

        def ended(status: int, values: Any) -> None:
            text = values if isinstance(values, str) else str(field(values, "error_msg") or "")
            pursuit.end(_ROS2.get(status, REJECTED), values, text)

        pursuit_id = self._line.now.send_goal(
            self.name,
            f"{package}/action/{kind}",
            goal,
            ended,
            lambda feedback: self._hear(pursuit, feedback),
        )
        self._pursuits = {pursuit_id: pursuit}

    def _cancel(self, pursuit: Pursuit) -> None:
        for name, known in self._pursuits.items():
            if known is pursuit:
                self._line.now.cancel_goal(self.name, name)


class _Ros1Cancelling(Cancelling):
    def __init__(self, action: Ros1Action) -> None:
        self._action = action

    def confirmed(self, since: float) -> bool:
        return self._action.idle_since(since)


class Ros1Action(Action):
    """actionlib's five topics. roslibpy's own client drops the text that says why a goal failed,
    and waits seconds for a status before it can be used."""

    def __init__(self, connection: Connection, name: str, kind: str, dialect: Dialect) -> None:
        super().__init__(connection, name, kind)
        self._status: tuple[float, bool] = (0.0, True)
        self._line.advertise(f"{name}/goal", f"{kind}ActionGoal")
        connection.halt.advertise(f"{name}/cancel", dialect.type("actionlib_msgs/GoalID"))
        halt = connection.halt
        halt.subscribe(f"{name}/status", "actionlib_msgs/GoalStatusArray", self._hear_status)
        halt.subscribe(f"{name}/result", f"{kind}ActionResult", self._hear_result)
        halt.subscribe(f"{name}/feedback", f"{kind}ActionFeedback", self._hear_feedback, 0.1)

    def idle_since(self, began: float) -> bool:
        """Whether the server has said, since then, that it pursues nothing."""
        at, going_on = self._status
        return at > began and not going_on

    def cancel_all(self) -> Cancelling:
        self._connection.halt.publish(
            f"{self.name}/cancel", {"stamp": {"secs": 0, "nsecs": 0}, "id": ""}, repeated=True
        )
        return _Ros1Cancelling(self)

    def _send(self, goal: Mapping[str, Any], pursuit: Pursuit) -> None:
        name = f"nl2robot-{uuid.uuid4()}"
        self._pursuits = {name: pursuit}
        message = {"goal_id": {"stamp": {"secs": 0, "nsecs": 0}, "id": name}, "goal": dict(goal)}
        self._line.publish(f"{self.name}/goal", message)

    def _cancel(self, pursuit: Pursuit) -> None:
        """`cancel_all` does it: it has not to wait for the goal in ROS 1."""

    def _hear_status(self, message: Mapping[str, Any]) -> None:
        going_on = False
        for status in field(message, "status_list") or ():
            code, name = field(status, "status"), field(status, "goal_id", "id")
            going_on = going_on or code in _ROS1_GOING_ON
            pursuit = self._pursuits.get(str(name))
            if pursuit is None or pursuit.ended.is_set():
                continue
            if code in _ROS1:
                pursuit.end(_ROS1[code], None, str(field(status, "text") or ""))
            else:
                self._hear(pursuit, pursuit.feedback)
        self._status = time.monotonic(), going_on

    def _hear_result(self, message: Mapping[str, Any]) -> None:
        status = field(message, "status")
        pursuit = self._pursuits.get(str(field(status, "goal_id", "id")))
        if pursuit is not None and not pursuit.ended.is_set():
            outcome = _ROS1.get(field(status, "status"), REJECTED)
            pursuit.end(outcome, field(message, "result"), str(field(status, "text") or ""))

    def _hear_feedback(self, message: Mapping[str, Any]) -> None:
        pursuit = self._pursuits.get(str(field(message, "status", "goal_id", "id")))
        if pursuit is not None:
            self._hear(pursuit, field(message, "feedback"))
