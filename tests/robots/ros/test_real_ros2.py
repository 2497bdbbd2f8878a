"""The same wire with real ROS 2 nodes under a real rosbridge, where such an environment is there.

`make ros2` makes it, a Python environment of its own (or `NL2ROBOT_ROS2` names one): its packages
start every Python in it twice, so they cannot be in ours. rosapi is not to be had
there, nor are Nav2's messages: what is shown is velocities, odometry, the stop, and an action that
is cancelled from another connection than its own.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from robot_api.driver import StopFlag
from robot_api.errors import LostConnection, RobotError, Stopped
from robot_api.robots.address import parse
from robot_api.robots.registry import Setup
from robot_api.robots.ros import ROS2
from robot_api.robots.ros.actions import CANCELED, Ros2Action
from robot_api.robots.ros.connection import Connection
from robot_api.robots.ros.driver import RosDriver
from robot_api.robots.ros.settings import RosSettings
from robot_api.robots.ros.wire import Where
from tests.robots.ros.stand_in import free_port
from tests.robots.ros.ward import Under, call

ENVIRONMENT = Path(os.environ.get("NL2ROBOT_ROS2", Path(__file__).parents[3] / ".venv-ros2"))
pytestmark = pytest.mark.skipif(not ENVIRONMENT.exists(), reason="there is no ROS 2 (make ros2)")

TYPES = {"velocity": "geometry_msgs/msg/Twist", "odometry": "nav_msgs/msg/Odometry"}


@pytest.fixture(scope="module")
def port(tmp_path_factory: pytest.TempPathFactory) -> Iterator[int]:
    home, place = ENVIRONMENT, tmp_path_factory.mktemp("ros2")
    packages = next(home.glob("lib/python3.*/site-packages"))
    bridge = place / "rosbridge"
    shutil.copy(packages / "rosbridge_server_rs" / "rosbridge_server_rs_jazzy", bridge)
    bridge.chmod(0o755)
    # The wheels have one middleware and no choice of it, which the bridge looks for.
    (place / "librmw_implementation.so").symlink_to(home / "lib" / "librmw_fastrtps_cpp.so")
    libraries = [place, home / "lib", *packages.glob("ros_*.libs")]
    where = (
        "import sysconfig as s; print(s.get_config_var('LIBDIR'), s.get_config_var('LDLIBRARY'))"
    )
    python = home / "bin" / "python"
    folder, library = subprocess.check_output([python, "-c", where], text=True).split()
    domain = {**os.environ, "ROS_DOMAIN_ID": str(free_port() % 100)}
    found = free_port()
    environment = {
        **domain,
        "LD_LIBRARY_PATH": ":".join(map(str, libraries)),
        "LD_PRELOAD": str(Path(folder) / library),
        "AMENT_PREFIX_PATH": str(home),
    }
    command = [bridge, "--bind", f"127.0.0.1:{found}", "--no-rosapi"]
    programs = [
        subprocess.Popen(command, env=environment, stdout=subprocess.DEVNULL),
        subprocess.Popen([python, Path(__file__).with_name("real_base.py")], env=domain),
    ]
    try:
        yield found
    finally:
        for program in programs:
            program.terminate()
        for program in programs:
            program.wait(10)


@pytest.fixture(scope="module")
def driver(port: int) -> Iterator[RosDriver]:
    driver = _driver(port)
    yield driver
    driver.close()


def _driver(port: int) -> RosDriver:
    """Once it is there and its odometry is heard."""
    for _ in range(30):
        try:
            driver = ROS2.connect(
                Setup(
                    address=parse(f"ros2://127.0.0.1:{port}"),
                    settings=RosSettings(types=TYPES),
                )
            )
        except LostConnection:
            StopFlag().wait(0.5)
            continue
        try:
            driver.stop("Is it there?")
        except RobotError:
            driver.close()
            continue
        assert isinstance(driver, RosDriver)
        return driver
    raise AssertionError("there is no robot")


def test_it_moves_turns_and_stands(driver: RosDriver) -> None:
    assert {"move", "turn", "drive"} <= set(driver.capabilities().methods)
    call(driver, "move", metres=0.3)
    call(driver, "turn", degrees=-45)
    under_way = Under(driver, "drive", linear=0.3, angular=0, seconds=30)
    StopFlag().wait(0.5)
    driver.stop("The nurse said stop.")
    assert isinstance(under_way.ended(0.5), Stopped)


@pytest.mark.usefixtures("driver")  # then the robot is there
def test_an_action_is_cancelled_from_the_connection_for_stopping(port: int) -> None:
    connection = Connection(Where("127.0.0.1", port), lost_after=2.0)
    try:
        action = Ros2Action(connection, "/fibonacci", "test_msgs/Fibonacci")
        pursuit = action.start({"order": 5}, StopFlag())
        for _ in range(100):
            if pursuit.heard:
                break
            StopFlag().wait(0.05)
        assert pursuit.heard and not pursuit.ended.is_set()
        cancelling = action.cancel_all()
        assert pursuit.ended.wait(2)
        assert pursuit.outcome == CANCELED
        assert cancelling.confirmed(0.0)
    finally:
        connection.close()
