"""Stops a robot with ROS when the server that drives it is gone. Runs on the robot itself.

    python guard.py ros2://localhost:9090

The server publishes a heartbeat while it is connected. When that ends without a goodbye, every goal
is cancelled and the velocity is set to zero for a second. It needs `roslibpy` and nothing else of
this project, so this one file can be copied to the robot.
"""

from __future__ import annotations

import argparse
import logging
import sys
import threading
import time
from collections.abc import Mapping, Sequence
from typing import Any
from urllib.parse import urlsplit

_LOOK_EVERY = 0.1
_STOP_FOR = 1.0
"""Seconds for which it is told to stand."""
_ANSWER_WITHIN = 3.0

log = logging.getLogger("guard")


class Guard:
    """Watches over one robot. `ros` is a connected `roslibpy.Ros`."""

    def __init__(
        self,
        ros: Any,
        version: int,
        *,
        heartbeat: str,
        velocity: str,
        actions: Sequence[str],
        patience: float,
    ) -> None:
        import roslibpy

        self._roslibpy = roslibpy
        self._ros = ros
        self._actions = actions
        self._patience = patience
        self._heard: float | None = None
        """When the last heartbeat came; None while nobody drives."""
        package = "std_msgs/" if version == 1 else "std_msgs/msg/"
        kind = self._type_of(velocity)
        self._stamped = kind.endswith("TwistStamped")
        self._velocity = roslibpy.Topic(ros, velocity, kind, queue_size=1) if kind else None
        if self._velocity is not None:
            self._velocity.advertise()
        self._cancels = {}
        if version == 1:
            for action in actions:
                topic = roslibpy.Topic(ros, f"{action}/cancel", "actionlib_msgs/GoalID")
                topic.advertise()
                self._cancels[action] = topic
        roslibpy.Topic(ros, heartbeat, f"{package}String").subscribe(self._hear)

    def look(self) -> bool:
        """Stop the robot if whoever drove it is gone; whether it did."""
        if self._heard is None or time.monotonic() - self._heard < self._patience:
            return False
        if not self._ros.is_connected:  # rosbridge itself is gone: as soon as it is there again
            return False
        self._heard = None
        log.warning("No heartbeat for %g seconds: the robot is stopped.", self._patience)
        end = time.monotonic() + _STOP_FOR
        while time.monotonic() < end:
            self._stop()
            time.sleep(_LOOK_EVERY)
        return True

    def _hear(self, message: Mapping[str, Any]) -> None:
        self._heard = None if message.get("data") == "bye" else time.monotonic()

    def _stop(self) -> None:
        still = {"linear": {"x": 0.0}, "angular": {"z": 0.0}}
        if self._velocity is not None:
            self._velocity.publish({"twist": still} if self._stamped else still)
        for action in self._actions:
            if action in self._cancels:
                everything = {"stamp": {"secs": 0, "nsecs": 0}, "id": ""}
                self._cancels[action].publish(everything)
            else:
                everything = {"goal_id": {"uuid": [0] * 16}, "stamp": {"sec": 0, "nanosec": 0}}
                self._ask(f"{action}/_action/cancel_goal", {"goal_info": everything})

    def _type_of(self, topic: str) -> str:
        answered, told = threading.Event(), []

        def hear(values: Mapping[str, Any]) -> None:
            told.append(str(values.get("type") or ""))
            answered.set()

        self._ask("/rosapi/topic_type", {"topic": topic}, hear)
        answered.wait(_ANSWER_WITHIN)
        return told[0] if told else ""

    def _ask(self, service: str, arguments: Mapping[str, Any], hear: Any = lambda _: None) -> None:
        request = self._roslibpy.ServiceRequest(dict(arguments))
        self._roslibpy.Service(self._ros, service, "").call(request, hear, lambda _: None)


def main(arguments: Sequence[str] | None = None) -> int:
    """Watch until it is ended."""
    parser = argparse.ArgumentParser(prog="guard", description=(__doc__ or "").split("\n")[0])
    parser.add_argument("address", help="the robot's own rosbridge: ros2://localhost:9090")
    parser.add_argument("--heartbeat", default="/nl2robot/heartbeat", metavar="TOPIC")
    parser.add_argument("--velocity", default="/cmd_vel", metavar="TOPIC")
    parser.add_argument(
        "--action", action="append", metavar="NAME", help="an action to cancel; may be repeated"
    )
    parser.add_argument(
        "--patience", type=float, default=1.5, help="seconds without a heartbeat (1.5)"
    )
    options = parser.parse_args(arguments)
    parts = urlsplit(options.address)
    if parts.scheme not in ("ros1", "ros2") or not parts.hostname:
        parser.error("Write the address as ros2://HOST:9090 or ros1://HOST:9090.")
    version = int(parts.scheme[-1])
    logging.basicConfig(level=logging.WARNING, format="%(asctime)s %(message)s")
    logging.getLogger("roslibpy").setLevel(logging.CRITICAL)
    import roslibpy

    ros = roslibpy.Ros(parts.hostname, parts.port or 9090, transport="asyncio")
    while not ros.is_connected:  # rosbridge may start after it
        try:
            ros.run(timeout=5)
        except roslibpy.RosTimeoutError:
            log.warning("There is no rosbridge at %s yet.", options.address)
    usual = "/move_base" if version == 1 else "/navigate_to_pose"
    guard = Guard(
        ros,
        version,
        heartbeat=options.heartbeat,
        velocity=options.velocity,
        actions=options.action or [usual],
        patience=options.patience,
    )
    log.warning("Watching over %s.", options.address)
    try:
        while True:
            guard.look()
            time.sleep(_LOOK_EVERY)
    except KeyboardInterrupt:
        return 0
    finally:
        ros.close()


if __name__ == "__main__":
    sys.exit(main())
