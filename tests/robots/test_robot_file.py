"""What an engineer writes down of a robot: read, held, and refused line by line."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import msgspec
import pytest

from nl2robot.knowledge import Knowledge
from nl2robot.review.policy import violations
from nl2robot.review.risks import risks
from robot_api.driver import StopFlag
from robot_api.drivers import emulated
from robot_api.errors import InvalidCall
from robot_api.robots.opening import hold
from robot_api.robots.reading import Read, RobotFileError, read_robot_file, without_file
from robot_api.robots.registry import RobotKind
from robot_api.robots.robot_file import Limits
from sim.world.loading import load_world


class Topics(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    velocity: str = "/cmd_vel"
    laser: str | None = None


class Settings(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    topics: Topics = Topics()
    rate: float = 10.0
    base: Literal["twist", "twist_stamped"] = "twist"
    goals: dict[str, Topics] = {}
    tries: int = 3


class Needy(msgspec.Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    serial: str


def kind(settings: type[msgspec.Struct] | None = Settings) -> RobotKind:
    return RobotKind(
        scheme="cart",
        title="A cart",
        example="cart://HOST",
        connect=lambda setup: emulated(),
        section="cart" if settings else None,
        settings=settings,
    )


def read(tmp_path: Path, text: str, settings: type[msgspec.Struct] | None = Settings) -> Read:
    file = tmp_path / "porter.yaml"
    file.write_text(text, encoding="utf-8")
    return read_robot_file(file, kind(settings))


def told(tmp_path: Path, text: str, settings: type[msgspec.Struct] | None = Settings) -> str:
    """What is said of a file that is wrong, without its folder."""
    with pytest.raises(RobotFileError) as raised:
        read(tmp_path, text, settings)
    return str(raised.value).replace(f"{tmp_path}/", "")


WHOLE = """\
name: The porter
limits: {speed: 0.5, acceleration: 0.4, turn_rate: 45, volume: 80}
joints:
  head_yaw: [-40, 40]
speech: robot
hearing: server
gestures: {wave: animations/Stand/Gestures/Hey_1}
emotions: {happy: BigSmile}
skills: {sit: sit down}
cart:
  topics: {velocity: /base/cmd, laser: ~}
  rate: 20
  base: twist_stamped
  goals: {dock: {velocity: /dock}}
"""


def test_a_whole_file_is_read(tmp_path: Path) -> None:
    porter = read(tmp_path, WHOLE)
    assert porter.file.name == "The porter"
    assert porter.file.limits == Limits(speed=0.5, acceleration=0.4, turn_rate=45, volume=80)
    assert porter.file.joints == {"head_yaw": (-40.0, 40.0)}
    assert (porter.file.speech, porter.file.hearing) == ("robot", "server")
    assert porter.file.gestures == {"wave": "animations/Stand/Gestures/Hey_1"}
    assert porter.file.skills == {"sit": "sit down"}
    assert porter.settings == Settings(
        topics=Topics(velocity="/base/cmd"),
        rate=20.0,
        base="twist_stamped",
        goals={"dock": Topics(velocity="/dock")},
    )
    assert porter.lines == {"head_yaw": 4}


def test_everything_may_be_left_out(tmp_path: Path) -> None:
    porter = read(tmp_path, "name: The porter\n")
    assert porter.settings == Settings()
    assert without_file(kind()).settings == Settings()
    assert without_file(kind(None)).settings is None


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("nmae: x", 'porter.yaml:1: The robot file has no field "nmae". Did you mean "name"?'),
        ("name: x\npepper: {}", 'porter.yaml:2: The robot file has no field "pepper". The fields'),
        ("limits: {sped: 1}", 'The entry limits has no field "sped". Did you mean "speed"?'),
        ("limits:\n  speed: -1", 'porter.yaml:2: The limit speed is "-1". It should be a number'),
        ("limits: {speed: .nan}", 'The limit speed is ".nan". It should be a number.'),
        ("limits: {volume: 101}", "It should be a number from 0 to 100."),
        ("limits: fast", 'The entry limits is "fast". It should be fields with values'),
        ("joints: {head: [40, -40]}", "goes from 40 to -40 degrees. Write the lesser angle first."),
        ("joints: {head: 40}", "It should be its least and greatest angle, [-40, 40]."),
        ("joints: {head: [a, b]}", 'The joint "head" is "a". It should be a number.'),
        ("joints: {head: [1, 2], head: [1, 3]}", '"head" is here twice.'),
        ("joints: [head]", 'The field "joints" is a list. It should be names with values.'),
        ("speech: robt", 'The field "speech" is "robt". Did you mean "robot"?'),
        ("speech: hologram", "It can be robot, server, tablet."),
        ("gestures: {wave: [1]}", '"wave" of the gestures is a list. It should be a text.'),
        ("cart: {topcis: {}}", '"cart" has no field "topcis". Did you mean "topics"?'),
        (
            "cart:\n  topics:\n    velcity: /x",
            'porter.yaml:3: "cart.topics" has no field "velcity"',
        ),
        ("cart: {goals: {dock: {laser: 1, x: 2}}}", '"cart.goals.dock" has no field "x"'),
        ("cart:\n  rate: fast", 'porter.yaml:2: "cart.rate" is "fast". It should be a number.'),
        ("cart: {tries: 1.5}", '"cart.tries" is "1.5". It should be a whole number.'),
        ("cart: {base: twisted}", '"cart.base" is "twisted". Did you mean "twist"?'),
        ("cart: {topics: /cmd}", '"cart.topics" is "/cmd". It should be fields with values.'),
        ("cart: 7", '"cart" is "7". It should be fields with values.'),
        ("- a\n- b", "The robot file is a list. It should be fields with values"),
        ("", "The file is empty. A robot file has at least"),
        ("name: [", "This is not valid YAML"),
        ("name: a\n---\nname: b", "A second robot file begins here."),
        ("name: !!python/object:os.system x", "has no meaning here. Remove it."),
        ("name: " + "x" * 300, "The name is longer than 200 characters."),
        (f"skills: {{{', '.join(f's{n}: x' for n in range(201))}}}", "more than 200"),
        ("name: " + "[" * 30 + "]" * 30, "nested too deep"),
        ("x: " + "y" * 1_100_000, "larger than 1000 kB. Is it really a robot file?"),
    ],
)
def test_what_is_wrong_is_said_with_its_line(tmp_path: Path, text: str, sentence: str) -> None:
    assert sentence in told(tmp_path, text)


def test_all_that_is_wrong_is_said_at_once(tmp_path: Path) -> None:
    said = told(tmp_path, "nmae: x\nlimits: {speed: 0}\njoints: {head: [2, 1]}\n")
    assert [line.split(":")[1] for line in said.splitlines()] == ["1", "2", "3"]


def test_a_file_that_is_not_there_or_no_text(tmp_path: Path) -> None:
    with pytest.raises(RobotFileError, match="There is no such robot file"):
        read_robot_file(tmp_path / "nowhere.yaml", kind())
    with pytest.raises(RobotFileError, match="Give the path of a robot file"):
        read_robot_file(tmp_path, kind())
    (tmp_path / "binary.yaml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(RobotFileError, match="no text in UTF-8"):
        read_robot_file(tmp_path / "binary.yaml", kind())


def test_what_a_wire_cannot_do_without_is_asked_for(tmp_path: Path) -> None:
    assert 'lacks the field "serial". Add it.' in told(tmp_path, "name: x", Needy)
    assert 'porter.yaml:2: "cart" lacks' in told(tmp_path, "name: x\ncart: {}", Needy)
    with pytest.raises(RobotFileError, match='robot file with a section "cart" that has serial'):
        without_file(kind(Needy))


# --- held


def test_limits_hold_at_the_call(tmp_path: Path) -> None:
    robot = emulated()
    hold(robot, read(tmp_path, WHOLE))
    has = robot.capabilities()
    assert has.name == "The porter"
    assert has.limits == {"speed": 0.5, "acceleration": 0.4, "turn_rate": 45, "volume": 80}
    assert has.joints["head_yaw"] == (-40, 40)
    refused = (
        ("drive", {"linear": 0.6, "angular": 0, "seconds": 1}, "at most, not at 0.6"),
        ("drive", {"linear": -0.6, "angular": 0, "seconds": 1}, "at most, not at 0.6"),
        ("drive", {"linear": 0, "angular": 46, "seconds": 1}, "by 45 degrees a second at most"),
        ("joint", {"name": "head_yaw", "degrees": 41}, "goes from -40 to 40 degrees, not to 41"),
    )
    for method, arguments, sentence in refused:
        with pytest.raises(InvalidCall, match=sentence):
            robot.call(method, arguments, StopFlag())
    robot.call("drive", {"linear": 0.5, "angular": -45, "seconds": 1}, StopFlag())
    robot.call("joint", {"name": "head_yaw", "degrees": 40}, StopFlag())


def test_what_is_too_loud_is_done_less_loudly_and_that_is_said(tmp_path: Path) -> None:
    robot = emulated()
    hold(robot, read(tmp_path, WHOLE))
    robot.call("set_volume", {"percent": 95}, StopFlag())
    assert robot.emulation.volume == 80
    log = robot.call("log", {"lines": 5}, StopFlag())
    assert any("warning: set_volume: set to 80 percent" in line for line in log)
    robot.call("set_volume", {"percent": 60}, StopFlag())
    assert robot.emulation.volume == 60


def test_limits_hold_at_review(tmp_path: Path) -> None:
    robot = emulated()
    hold(robot, read(tmp_path, WHOLE))
    knowledge = Knowledge(load_world("ward"), robot.capabilities())
    found = violations("robot.drive(2.0, 0, 1)\nrobot.joint('head_yaw', 60)\n", knowledge)
    assert [(each.line, each.code, each.severity) for each in found] == [
        (1, "out-of-range", "error"),
        (2, "out-of-range", "error"),
    ]
    assert "drives at 0.5 metres a second at most, not at 2" in found[0].message
    loud = "robot.set_volume(95)\n"
    assert violations(loud, knowledge) == []
    [risk] = risks(loud, knowledge, "de")
    assert (risk.line, risk.kind) == (1, "volume")
    assert "höchstens 80 %" in risk.text


def test_a_joint_that_the_robot_lacks_is_said_with_its_line(tmp_path: Path) -> None:
    with pytest.raises(RobotFileError, match=r"porter.yaml:2: The robot has no joint 'tail'"):
        hold(emulated(), read(tmp_path, "joints:\n  tail: [0, 10]\n"))
    with pytest.raises(RobotFileError, match="goes from -90 to 90 degrees, never from 100 to 110"):
        hold(emulated(), read(tmp_path, "joints: {head_yaw: [100, 110]}\n"))


def test_what_the_robot_itself_allows_stays_the_limit(tmp_path: Path) -> None:
    from tests.robots.far_robot import FarRobot

    robot = FarRobot()  # 0.7 m/s by itself
    hold(robot, read(tmp_path, "limits: {speed: 3, turn_rate: 30}\n"))
    assert robot.capabilities().limits == {"speed": 0.7, "turn_rate": 30}
