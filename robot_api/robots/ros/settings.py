"""The section `ros` of a robot file: what things are called on this robot.

    ros:
      topics: {velocity: /base/cmd_vel, battery: /power}
      actions: {navigate: /navigate_to_pose}
      controllers: {/head_controller: [head_pan, head_tilt]}

What is left out has the usual name and is used where the robot has it; what is named has to be
there.
"""

from __future__ import annotations

import msgspec

from robot_api.capabilities.languages import known_languages


class Topics(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Names of topics. None: the usual one of `USUAL_TOPICS`, if there is one."""

    velocity: str | None = None
    """Twist or TwistStamped, whichever the robot listens to."""
    odometry: str | None = None
    pose: str | None = None
    """Where it is on the map: PoseWithCovarianceStamped, PoseStamped, Odometry, or /tf."""
    initial_pose: str | None = None
    map: str | None = None
    battery: str | None = None
    joint_states: str | None = None
    camera: str | None = None
    """CompressedImage, for reading codes."""
    laser: str | None = None
    """LaserScan, for the pages' map."""
    speech: str | None = None
    """String: what is published there is spoken."""
    gesture: str | None = None
    """String: the robot's own name of a gesture."""
    emotion: str | None = None
    """String: the robot's own name of an emotion."""
    keep_out_mask: str | None = None
    keep_out_info: str | None = None
    heartbeat: str | None = None
    """String: published five times a second, for the guard on the robot."""


USUAL_TOPICS = Topics(
    velocity="/cmd_vel",
    odometry="/odom",
    pose="/amcl_pose",
    initial_pose="/initialpose",
    map="/map",
    battery="/battery_state",
    joint_states="/joint_states",
    keep_out_mask="/keepout_filter_mask",
    keep_out_info="/costmap_filter_info",
    laser="/scan",
    heartbeat="/nl2robot/heartbeat",
)


class Actions(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """Names of action servers."""

    navigate: str | None = None
    """NavigateToPose, or move_base in ROS 1."""
    dock: str | None = None
    """DockRobot. None: it drives to the place of the kind "charger"."""


class Frames(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    map: str = "map"
    odometry: str = "odom"
    base: str = "base_link"


class SpeechService(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A service that speaks, and answers when it has spoken."""

    name: str
    text: str = "text"
    """The field for the text."""
    language: str | None = None
    """The field for the code of the language."""


class RosSettings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    topics: Topics = Topics()
    actions: Actions = Actions()
    frames: Frames = Frames()
    types: dict[str, str] = {}
    """Types of topics by the field's name (`velocity: geometry_msgs/msg/TwistStamped`), for a
    rosbridge without rosapi; where there is rosapi, they have to agree with it."""
    controllers: dict[str, list[str]] = {}
    """Each joint controller with all its joints in its order: `/head_controller`, which has the
    action `follow_joint_trajectory` or the topic `joint_trajectory` below it."""
    skills: dict[str, str] = {}
    """The robot file's skills, each with the std_srvs/Trigger service that does it."""
    speech_service: SpeechService | None = None
    languages: tuple[str, ...] = msgspec.field(default_factory=known_languages)
    """What the robot's own voice speaks."""
    dock_id: str = ""
    """Which dock, for DockRobot; empty: the first."""
    speed: float = 0.3
    """Metres per second at which `move` drives, if the robot file's limits allow it."""
    turn_rate: float = 45.0
    """Degrees per second at which `turn` turns, likewise."""
    acceleration: float = 0.5
    """Metres per second, per second, unless the limits say less."""
    stop_within: float = 2.0
    """Seconds in which the robot stands after a stop, however fast it drove."""
    lost_after: float = 2.0
    """Seconds without an answer after which it counts as lost."""
    patience: float = 60.0
    """Seconds that it may stand on its way without getting on, before it gives up."""
    arrival: float = 1.0
    """Metres from the goal within which it has arrived."""
    place_radius: float = 1.5
    """Metres from a named place within which it is in it."""
    drift: float = 5.0
    """Metres that it may drive by odometry alone before it no longer knows where it is."""
    mask_resolution: float = 0.1
    """Metres per cell of the keep-out mask."""
    laser_turned: float = 0.0
    """Degrees that the laser looks to the left of straight ahead; 180: it is mounted backwards."""
    tls: bool = False
    """Whether rosbridge is reached by wss."""
