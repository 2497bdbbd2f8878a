"""Robots that speak ROS, reached through rosbridge with `roslibpy`; docs/robots/ros.md.

wire        one connection to a rosbridge; connection: those of a robot, and whether it is there
dialect     what ROS 1 and ROS 2 spell differently; graph: what is there on the robot
survey      what of all that its file and its capabilities need; settings: the file's section ros
wheels      odometry and where the robot is; halting: the stop that is confirmed
actions     goals that a robot pursues; navigation, motion, body, voice: capabilities
keep_out    where it must not drive; grid: the map that it drives by; laser: what is around it
driver      all of it put together
guard       a script for the robot's side that stops it when we are gone
"""

from __future__ import annotations

from robot_api.robots.registry import RobotKind, when_called
from robot_api.robots.ros.settings import RosSettings

ROS2 = RobotKind(
    scheme="ros2",
    title="A robot with ROS 2 and Nav2, through rosbridge",
    example="ros2://HOST:9090",
    connect=when_called("robot_api.robots.ros.driver:connect", 2),
    brake=when_called("robot_api.robots.ros.driver:brake", 2),
    modules=("roslibpy",),
    extra="ros",
    port=9090,
    section="ros",
    settings=RosSettings,
)
ROS1 = RobotKind(
    scheme="ros1",
    title="A robot with ROS 1 and move_base, through rosbridge",
    example="ros1://HOST:9090",
    connect=when_called("robot_api.robots.ros.driver:connect", 1),
    brake=when_called("robot_api.robots.ros.driver:brake", 1),
    modules=("roslibpy",),
    extra="ros",
    port=9090,
    section="ros",
    settings=RosSettings,
)
