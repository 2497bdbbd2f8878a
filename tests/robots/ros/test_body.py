"""What else the porter has: a battery, a head, a voice, a camera; and what stands in for it."""

from __future__ import annotations

import io
import math
import queue
from base64 import b64encode

import pytest

from robot_api.capabilities.sound import Asked, Sound
from robot_api.driver import StopFlag
from robot_api.errors import InvalidCall, NotPossible, NotSupported, Stopped, TimedOut
from robot_api.robots.robot_file import RobotFile
from robot_api.robots.ros import body
from robot_api.robots.ros.laser import RAYS, around
from robot_api.robots.ros.settings import RosSettings, SpeechService, Topics
from tests.robots.far_robot import SOON
from tests.robots.ros.stand_in import StandIn
from tests.robots.ros.ward import Heard, Under, call, connected

HEAD = RobotFile(joints={"head_pan": (-60, 60)})
CONTROLLER = RosSettings(controllers={"/head_controller": ["head_pan", "head_tilt"]})


@pytest.mark.parametrize(("said", "percent"), [(0.73, 73), (41.0, 41), (1.0, 100)])
def test_the_battery_is_told_in_percent(said, percent) -> None:
    robot = StandIn()
    robot.percentage = said
    with robot, connected(robot) as driver:
        heard = Heard(driver)
        assert call(driver, "battery") == percent
        robot.percentage = 0.2
        heard.wait(lambda: {"percent": 20, "charging": False} in heard.of("battery"))


def test_a_battery_that_cannot_tell_says_so(monkeypatch) -> None:
    monkeypatch.setattr(body, "_BATTERY_WITHIN", 0.5)
    robot = StandIn()
    robot.percentage = None
    with robot, connected(robot) as driver, pytest.raises(NotSupported, match="how full"):
        call(driver, "battery")


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("action", [False, True])
def test_a_joint_turns_and_the_others_of_its_controller_stay(version, action) -> None:
    if action and version == 1:
        pytest.skip("the stand-in has no such action in ROS 1")
    with (
        StandIn(version, head_action=action) as robot,
        connected(robot, CONTROLLER, HEAD) as driver,
    ):
        heard = Heard(driver)
        assert driver.capabilities().joints == {"head_pan": (-60, 60)}
        call(driver, "joint", name="head_pan", degrees=30)
        heard.wait(lambda: {"name": "head_pan", "degrees": 30.0} in heard.of("joint"))
        assert {each["name"] for each in heard.of("joint")} == {"head_pan"}
        assert robot.joints == {"head_pan": pytest.approx(0.5236, abs=1e-3), "head_tilt": 0.1}
        with pytest.raises(InvalidCall, match="from -60 to 60"):
            call(driver, "joint", name="head_pan", degrees=80)


def test_a_joint_that_is_held_is_told(monkeypatch) -> None:
    monkeypatch.setattr(body, "_JOINT_WITHIN", 0.2)
    with StandIn() as robot, connected(robot, CONTROLLER, HEAD) as driver:
        robot.faults.frozen = True
        with pytest.raises(NotPossible, match="has not come where it should"):
            call(driver, "joint", name="head_pan", degrees=30)


def test_its_own_voice_speaks_what_is_published() -> None:
    settings = RosSettings(topics=Topics(speech="/say"), languages=("de",))
    with StandIn() as robot, connected(robot, settings) as driver:
        heard = Heard(driver)
        call(driver, "say", text="Guten Tag.")
        assert robot.heard("/say") == [{"data": "Guten Tag."}]
        assert heard.of("speech") == [{"text": "Guten Tag.", "language": "de"}]
        assert "set_volume" not in driver.capabilities().methods
        with pytest.raises(NotSupported, match="I speak German"):
            call(driver, "say", text="Hello.", language="en")
        under_way = Under(driver, "say", text="bla " * 300)
        robot.until(lambda: len(robot.heard("/say")) == 2)
        under_way.flag.set()
        assert isinstance(under_way.ended(0.5), Stopped)


def test_its_own_voice_speaks_through_a_service() -> None:
    settings = RosSettings(speech_service=SpeechService(name="/tts", text="line", language="lang"))
    robot, spoken = StandIn(), []

    def speak(arguments):
        spoken.append(arguments)
        return {}

    robot.services["/tts"] = speak
    with robot, connected(robot, settings) as driver:
        call(driver, "say", text="Bonjour.", language="fr")
        assert spoken == [{"line": "Bonjour.", "lang": "fr"}]


def test_gestures_emotions_and_skills_go_by_the_robots_own_names() -> None:
    file = RobotFile(
        gestures={"wave": "hey_1"}, emotions={"happy": "smile"}, skills={"sit": "sit down"}
    )
    topics = Topics(gesture="/gesture", emotion="/emotion")
    robot = StandIn(types={"/gesture": "std_msgs/msg/String", "/emotion": "std_msgs/msg/String"})
    done = []

    def sit(arguments):
        done.append(arguments)
        return {"success": len(done) == 1, "message": "My knee hurts."}

    robot.services["/sit"] = sit
    settings = RosSettings(topics=topics, skills={"sit": "/sit"})
    with robot, connected(robot, settings, file) as driver:
        has = driver.capabilities()
        assert (has.gestures, has.emotions, has.skills) == (
            ("wave",),
            ("happy",),
            {"sit": "sit down"},
        )
        call(driver, "gesture", name="wave")
        call(driver, "emotion", name="happy")
        robot.until(lambda: robot.heard("/emotion"))
        assert robot.heard("/gesture") == [{"data": "hey_1"}]
        assert robot.heard("/emotion") == [{"data": "smile"}]
        call(driver, "do", skill="sit")
        with pytest.raises(NotPossible, match="My knee hurts"):
            call(driver, "do", skill="sit")
        with pytest.raises(InvalidCall, match="takes nothing besides"):
            call(driver, "do", skill="sit", slowly=True)


def test_its_camera_reads_codes_and_is_left_alone_otherwise() -> None:
    settings = RosSettings(topics=Topics(camera="/camera/compressed"))
    with StandIn() as robot, connected(robot, settings) as driver:
        assert not robot.listens("/camera/compressed")
        robot.camera = "no picture"
        under_way = Under(driver, "scan", timeout=20)
        robot.until(lambda: robot.listens("/camera/compressed"))
        robot.camera = _picture("4006381333931")
        assert under_way.ended() is None
        robot.until(lambda: not robot.listens("/camera/compressed"))
        robot.camera = None
        with pytest.raises(TimedOut):
            call(driver, "scan", timeout=0.3)


def test_who_looks_through_its_camera_goes_on_looking_while_it_scans() -> None:
    settings = RosSettings(topics=Topics(camera="/camera/compressed"))
    with StandIn() as robot, connected(robot, settings) as driver:
        assert driver.camera is not None
        seen: queue.Queue[bytes] = queue.Queue()
        leave = driver.camera.watch(seen.put)
        robot.camera = _picture("4006381333931")
        assert seen.get(timeout=SOON).startswith(b"\xff\xd8\xff")
        assert call(driver, "scan", timeout=20) == "4006381333931"
        with seen.mutex:
            seen.queue.clear()
        assert seen.get(timeout=SOON)
        leave()
        robot.until(lambda: not robot.listens("/camera/compressed"))
        leave()  # once more is nothing


def test_a_robot_without_a_camera_has_none_to_look_through() -> None:
    with StandIn() as robot, connected(robot) as driver:
        assert driver.camera is None


QUARTER = {"angle_min": 0.0, "angle_increment": math.pi / 2, "range_min": 0.1, "range_max": 8.0}


@pytest.mark.parametrize("version", [1, 2])
def test_what_its_laser_measures_is_told_round_the_robot(version) -> None:
    with StandIn(version) as robot, connected(robot) as driver:
        heard = Heard(driver)
        robot.scan = {**QUARTER, "ranges": [1.0, 2.0, None, 3.0]}  # ahead, left, behind, right
        heard.wait(lambda: heard.of("lidar"))
        metres = heard.of("lidar")[0]["metres"]
        told = {side: distance for side, distance in enumerate(metres) if distance is not None}
        assert told == {0: 1.0, RAYS // 4: 2.0, 3 * RAYS // 4: 3.0}


@pytest.mark.parametrize(
    ("scan", "turned", "told"),
    [
        ({**QUARTER, "ranges": [1.0]}, 180.0, {RAYS // 2: 1.0}),
        ({**QUARTER, "ranges": [0.05, 9.0, "far", True]}, 0.0, {}),
        ({**QUARTER, "angle_increment": 0.001, "ranges": [2.0, 1.5, 1.8]}, 0.0, {0: 1.5}),
        ({**QUARTER, "angle_min": -math.pi / 2, "ranges": [4.0]}, 0.0, {3 * RAYS // 4: 4.0}),
    ],
)
def test_rays_are_where_they_were_measured(scan, turned, told) -> None:
    metres = around(scan, turned)
    assert metres is not None and len(metres) == RAYS
    assert {side: each for side, each in enumerate(metres) if each is not None} == told


@pytest.mark.parametrize(
    "scan", [{}, {**QUARTER, "ranges": "none"}, {**QUARTER, "angle_min": None, "ranges": [1.0]}]
)
def test_a_laser_that_tells_nonsense_tells_nothing(scan) -> None:
    assert around(scan) is None


def test_what_it_lacks_is_stood_in_for_by_the_server_and_the_tablet() -> None:
    class Ears:
        def hear(self, stop: StopFlag, timeout: float, asked: Asked) -> str | None:
            return "yes please"

    with StandIn() as robot, connected(robot, sound=Sound(ears=Ears())) as driver:
        heard = Heard(driver)
        assert call(driver, "ask", question="More tea?", options=["yes", "no"]) == "yes"
        call(driver, "emotion", name="happy")
        assert heard.of("speech")[0]["text"] == "More tea?"
        assert heard.of("heard") == [{"text": "yes please", "person": None}]
        assert "svg" in heard.of("screen")[-1]["html"]
        lacking = {"call", "sees", "grab", "follow", "do", "joint", "gesture", "scan"}
        assert not lacking & set(driver.capabilities().methods)
        with pytest.raises(NotSupported, match="cannot see"):
            call(driver, "sees", thing="cup")


def _picture(code: str) -> str:
    import zxingcpp
    from PIL import Image

    made = zxingcpp.create_barcode(code, zxingcpp.BarcodeFormat.QRCode).to_image(scale=4)
    file = io.BytesIO()
    Image.fromarray(made).save(file, "JPEG")
    return b64encode(file.getvalue()).decode()
