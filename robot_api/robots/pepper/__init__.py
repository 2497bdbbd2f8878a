"""Pepper, over `qi` sessions as its own software (NAOqi) speaks: `pepper://HOST`.

    session    the connections to the robot, their time limits, its errors in words, lost and found
    body       whether it can move, and why it cannot; waking up, autonomous life, the charging flap
    core       battery, and the stop that is confirmed
    voice      speech
    ears       its own microphones, as sound for the server's recogniser
    limbs      gestures, joints and the eyes
    wheels     driving without a map
    navigation driving on a map that Pepper has made
    tablet     its screen
    skills     behaviours that are installed on it
    driver     all of it put together

Nothing here imports `qi` until a robot is connected to.
"""

from __future__ import annotations

from robot_api.robots.pepper.settings import PepperSettings
from robot_api.robots.registry import RobotKind, when_called

PEPPER = RobotKind(
    scheme="pepper",
    title="A Pepper with NAOqi 2.5, or 2.9 with a login",
    example="pepper://HOST",
    connect=when_called("robot_api.robots.pepper.driver:connect"),
    brake=when_called("robot_api.robots.pepper.driver:brake"),
    modules=("qi",),
    extra="pepper",
    port=9559,
    section="pepper",
    settings=PepperSettings,
)
