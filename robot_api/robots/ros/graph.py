"""What is there on the robot: asked before anything is advertised or sent."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from robot_api.errors import LostConnection, NotSupported
from robot_api.robots.ros.dialect import Dialect, field, plain
from robot_api.robots.ros.settings import USUAL_TOPICS, RosSettings
from robot_api.robots.ros.wire import Wire

_NOBODY = [7] * 16
"""The id of a goal that nobody has."""


class Graph:
    """Raises `LostConnection` if it does not answer, `NotSupported` if a thing is not what the
    robot file says."""

    def __init__(self, wire: Wire, dialect: Dialect, settings: RosSettings) -> None:
        self._wire = wire
        self._dialect = dialect
        self._settings = settings
        self.has_rosapi = self._is_there()

    def topic(self, field_name: str, *kinds: str) -> tuple[str, str] | None:
        """The name and the type of the topic of that field of `Topics`; None if the robot has no
        such topic and its file names none. `kinds`: what its type may be."""
        named = getattr(self._settings.topics, field_name)
        topic = named or getattr(USUAL_TOPICS, field_name)
        if topic is None:
            return None
        found = self.type_of(topic) if self.has_rosapi else self._settings.types.get(field_name)
        if not found:
            if named is None:
                return None
            raise NotSupported(
                f"The robot has no topic {topic}, which its file names for '{field_name}'."
                " Correct the file, or start what listens or speaks there."
                if self.has_rosapi
                else f"The robot's rosbridge cannot tell what {topic} is. Start rosapi beside it,"
                f" or write its type into the robot file: types: {{{field_name}: ...}}."
            )
        expected = self._settings.types.get(field_name)
        allowed = [plain(kind) for kind in kinds]
        if plain(found) not in allowed or (expected and plain(expected) != plain(found)):
            raise NotSupported(
                f"The topic {topic} carries {found} and not {expected or ' or '.join(allowed)}."
                f" Name another one for '{field_name}' in the robot file."
            )
        return topic, found

    def type_of(self, topic: str) -> str:
        """Its type, empty if there is no such topic."""
        return str(self._told("topic_type", {"topic": topic}, "type") or "")

    def action(self, name: str, kind: str) -> bool:
        """Whether there is such an action server. `kind`: "nav2_msgs/NavigateToPose"."""
        package, _, what = kind.partition("/")
        if self._dialect.version == 1:
            found = self.type_of(f"{name}/goal")
            expected = f"{package}/{what}ActionGoal"
            if found and plain(found) != expected:
                raise _other_action(name, found, expected)
            return bool(found)
        served = self._told("service_type", {"service": f"{name}/_action/send_goal"}, "type")
        if served and plain(served) != f"{package}/{what}_SendGoal":
            raise _other_action(name, served, kind)
        servers = self._told("action_servers", {}, "action_servers")
        known = isinstance(servers, list) and name.strip("/") in (
            str(server).strip("/") for server in servers
        )
        return bool(served) or known or self._answers_a_cancel(name)

    def service(self, name: str) -> bool:
        """Whether there is such a service; without rosapi, it is believed."""
        return not self.has_rosapi or bool(self._told("service_type", {"service": name}, "type"))

    def is_published(self, topic: str) -> bool:
        """Whether anybody publishes it."""
        return bool(self._told("publishers", {"topic": topic}, "publishers"))

    # --- inside ----------------------------------------------------------------------------------

    def _is_there(self) -> bool:
        if self._wire.call("/rosapi/topics").ok:
            return True
        if self._settings.types:
            return False
        raise NotSupported(
            "rosbridge is there, but rosapi is not, so nobody can tell what the robot has."
            " Start rosapi beside it: both are in rosbridge_websocket_launch.xml."
        )

    def _told(self, service: str, arguments: Mapping[str, Any], name: str) -> Any:
        answer = self._wire.call(f"/rosapi/{service}", arguments)
        return field(answer.values, name) if answer.ok else None

    def _answers_a_cancel(self, name: str) -> bool:
        """rosapi of ROS 2 does not list the servers in every version; the service that cancels a
        goal is there if the server is, and nobody has this goal."""
        request = {"goal_info": {"goal_id": {"uuid": _NOBODY}}}
        try:
            answer = self._wire.call(f"{name}/_action/cancel_goal", request)
        except LostConnection:
            if self._wire.over:
                raise
            return False
        return answer.ok


def _other_action(name: str, found: str, expected: str) -> NotSupported:
    return NotSupported(
        f"The action {name} is of the type {found} and not {expected}."
        " Name another one in the robot file."
    )
