"""An engineer gets an address or a robot file wrong: a sentence each, and nothing moves."""

from __future__ import annotations

import subprocess
import sys
import time

import pytest

from robot_api.errors import AccessDenied, LostConnection, NotSupported
from robot_api.robots.address import parse
from robot_api.robots.registry import Setup
from robot_api.robots.robot_file import RobotFile
from robot_api.robots.ros import ROS2
from robot_api.robots.ros.settings import Actions, RosSettings, SpeechService, Topics
from tests.robots.ros.stand_in import StandIn, free_port, silent_port
from tests.robots.ros.ward import Under, call, connected


def test_where_nobody_listens_it_is_said_at_once() -> None:
    began = time.monotonic()
    with pytest.raises(LostConnection, match="cannot be reached"):
        ROS2.connect(Setup(address=parse(f"ros2://127.0.0.1:{free_port()}")))
    assert time.monotonic() - began < 2


def test_a_machine_that_is_not_there_is_named() -> None:
    with pytest.raises(LostConnection, match=r"no machine called nobody\.invalid"):
        ROS2.connect(Setup(address=parse("ros2://nobody.invalid")))


def test_something_that_says_nothing_is_given_up() -> None:
    with silent_port() as port, pytest.raises(LostConnection, match="not answered for 3 seconds"):
        ROS2.connect(Setup(address=parse(f"ros2://127.0.0.1:{port}")))


def test_a_robot_that_wants_a_login_gets_one() -> None:
    with StandIn(password=True) as robot:
        with pytest.raises(AccessDenied, match="wants a login"), connected(robot):
            pass
        with connected(robot, user="nurse@", password="secret") as driver:
            assert call(driver, "battery") == 73


def test_a_rosbridge_without_rosapi_says_what_to_start() -> None:
    with (
        StandIn(rosapi=False) as robot,
        pytest.raises(NotSupported, match="rosapi is not"),
        connected(robot),
    ):
        pass
    assert not robot.published


def test_a_rosbridge_without_rosapi_will_do_if_the_file_names_the_types() -> None:
    types = {"velocity": "geometry_msgs/msg/Twist", "odometry": "nav_msgs/msg/Odometry"}
    with StandIn(rosapi=False) as robot, connected(robot, RosSettings(types=types)) as driver:
        call(driver, "move", metres=0.2)
        assert robot.body.x == pytest.approx(0.2, abs=0.05)
        driver.stop("Enough.")


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        (RosSettings(topics=Topics(velocity="/wheels")), "no topic /wheels"),
        (RosSettings(topics=Topics(velocity="/odom")), "/odom carries nav_msgs/msg/Odometry"),
        (
            RosSettings(types={"velocity": "geometry_msgs/msg/TwistStamped"}),
            "carries geometry_msgs/msg/Twist and not geometry_msgs/msg/TwistStamped",
        ),
        (RosSettings(actions=Actions(navigate="/drive_there")), "no action server /drive_there"),
        (RosSettings(actions=Actions(dock="/dock_robot")), "no action server /dock_robot"),
        (RosSettings(controllers={"/arm": ["elbow"]}), "no joint controller /arm"),
        (RosSettings(speech_service=SpeechService(name="/tts")), "no service /tts"),
    ],
)
def test_a_file_that_names_what_is_not_there_is_refused_before_anything_is_sent(
    settings, words
) -> None:
    with StandIn() as robot:
        with pytest.raises(NotSupported, match=words), connected(robot, settings):
            pass
        robot.until(lambda: robot.connections == 0)
        assert not robot.published
        assert not robot.goals


@pytest.mark.parametrize(
    ("file", "words"),
    [
        (RobotFile(speech="robot"), "neither a topic nor a service"),
        (RobotFile(hearing="robot"), "hearing: server"),
        (RobotFile(gestures={"wave": "hey"}), "needs a topic for 'gesture'"),
        (RobotFile(emotions={"happy": "smile"}), "needs a topic for 'emotion'"),
        (RobotFile(skills={"sit": "sit down"}), "no service for the skill 'sit'"),
        (RobotFile(joints={"tail": (-20, 20)}), "names the joint tail, which this robot lacks"),
    ],
)
def test_a_file_that_asks_for_what_the_robot_lacks_is_refused(file, words) -> None:
    with StandIn() as robot, pytest.raises(NotSupported, match=words), connected(robot, file=file):
        pass


def test_a_velocity_of_another_type_is_refused() -> None:
    with StandIn(types={"/cmd_vel": "std_msgs/msg/String"}) as robot:
        with pytest.raises(NotSupported, match="carries std_msgs/msg/String"), connected(robot):
            pass
        assert not robot.published


def test_without_an_action_server_it_drives_but_does_not_navigate() -> None:
    with StandIn(navigates=False) as robot, connected(robot) as driver:
        assert "drive" in driver.capabilities().methods
        with pytest.raises(NotSupported, match="cannot find its way"):
            call(driver, "goto", place="pharmacy")


def test_a_second_server_is_refused_and_the_first_goes_on() -> None:
    with StandIn(speed=1.0) as robot, connected(robot) as first:
        under_way = Under(first, "goto", place="pharmacy")
        robot.until(lambda: robot.body.speed > 0.5)
        with pytest.raises(AccessDenied, match="Another server drives"), connected(robot):
            pass
        assert under_way.ended() is None
        assert len(robot.goals) == 1
        first.close()
        with connected(robot) as second:
            assert call(second, "location").place == "pharmacy"


def test_nothing_of_it_is_printed_to_the_terminal() -> None:
    program = (
        "import sys\n"
        "from robot_api.robots.address import parse\n"
        "from robot_api.robots.registry import Setup\n"
        "from robot_api.robots.ros import ROS2\n"
        "driver = ROS2.connect(Setup(address=parse(sys.argv[1])))\n"
        "print('ready', flush=True)\n"
        "input()\n"
        "driver.close()\n"
    )
    with StandIn() as robot:
        done = subprocess.Popen(
            [sys.executable, "-c", program, f"ros2://127.0.0.1:{robot.port}"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        assert done.stdout is not None
        assert done.stdout.readline() == "ready\n"
        robot.cut()
        robot.mend()
        robot.until(lambda: robot.connections >= 3)
        robot.faults.nonsense = True
        robot.until(lambda: robot.heard("/nl2robot/heartbeat"))
        robot.faults.nonsense = False
        _, printed = done.communicate("\n", 20)
        assert (done.returncode, printed) == (0, "")
