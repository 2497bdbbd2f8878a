"""What there is on a robot, asked all at once before anything is sent."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from robot_api.errors import NotSupported
from robot_api.robots.ros.dialect import Dialect
from robot_api.robots.ros.graph import Graph
from robot_api.robots.ros.settings import RosSettings
from robot_api.robots.ros.wheels import POSE_TYPES

Topic = tuple[str, str] | None
"""A name and its type, where the robot has it."""

DOCKING = "nav2_msgs/DockRobot"
TRAJECTORIES = "control_msgs/FollowJointTrajectory"


@dataclass(frozen=True)
class Found:
    velocity: Topic
    odometry: Topic
    pose: Topic
    initial_pose: Topic
    map: Topic
    battery: Topic
    joint_states: Topic
    camera: Topic
    laser: Topic
    speech: Topic
    gesture: Topic
    emotion: Topic
    filter_info: Topic
    navigate: str | None
    dock: str | None
    controllers: Mapping[str, str]
    """Each joint controller with what takes its trajectories: "action" or a topic's type."""


def going(dialect: Dialect) -> str:
    """The type of the action that drives somewhere."""
    return "move_base_msgs/MoveBase" if dialect.version == 1 else "nav2_msgs/NavigateToPose"


def survey(graph: Graph, dialect: Dialect, settings: RosSettings) -> Found:
    """Raises `NotSupported` where the robot is not what its file says, `LostConnection`."""
    topic = graph.topic
    usual = "/move_base" if dialect.version == 1 else "/navigate_to_pose"
    return Found(
        velocity=topic("velocity", "geometry_msgs/Twist", "geometry_msgs/TwistStamped"),
        odometry=topic("odometry", "nav_msgs/Odometry"),
        pose=topic("pose", *POSE_TYPES),
        initial_pose=topic("initial_pose", "geometry_msgs/PoseWithCovarianceStamped"),
        map=topic("map", "nav_msgs/OccupancyGrid"),
        battery=topic("battery", "sensor_msgs/BatteryState"),
        joint_states=topic("joint_states", "sensor_msgs/JointState"),
        camera=topic("camera", "sensor_msgs/CompressedImage"),
        laser=topic("laser", "sensor_msgs/LaserScan"),
        speech=topic("speech", "std_msgs/String"),
        gesture=topic("gesture", "std_msgs/String"),
        emotion=topic("emotion", "std_msgs/String"),
        filter_info=topic("keep_out_info", "nav2_msgs/CostmapFilterInfo"),
        navigate=_server(graph, settings.actions.navigate, usual, going(dialect)),
        dock=_server(graph, settings.actions.dock, None, DOCKING),
        controllers={name: _controller(graph, name) for name in settings.controllers},
    )


def needed(topic: Topic, name: str) -> tuple[str, str]:
    """The topic; raises `NotSupported` if it is not there."""
    if topic is None:
        raise NotSupported(
            f"The robot file needs a topic for '{name}', and names none that the robot has."
            f" Name it in its section ros: topics: {{{name}: ...}}."
        )
    return topic


def _server(graph: Graph, named: str | None, usual: str | None, kind: str) -> str | None:
    action = named or usual
    if action is None or graph.action(action, kind):
        return action
    if named is None:
        return None
    raise NotSupported(
        f"The robot has no action server {action}, which its file names."
        " Correct the file, or start the server."
    )


def _controller(graph: Graph, name: str) -> str:
    if graph.action(f"{name}/follow_joint_trajectory", TRAJECTORIES):
        return "action"
    found = graph.type_of(f"{name}/joint_trajectory")
    if not found:
        raise NotSupported(
            f"The robot has no joint controller {name}, which its file names: neither the action"
            " follow_joint_trajectory nor the topic joint_trajectory is below it."
            " Correct the file, or start the controller."
        )
    return found
