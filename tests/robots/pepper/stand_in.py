"""A Pepper that is not there: a real `qi` session with its services, in a process of its own.

    python stand_in.py '{"hurry": 10}'

prints where it listens, in a line that begins with "URL ", and then stays. Its services do what
NAOqi's do over the same wire: `moveTo` blocks until the robot is there, or is stopped, or stands
before an obstacle; plain calls cannot be taken back; the charging flap and autonomous life lock the
wheels. The service `StandIn` is what no robot has: with it a test sets the scene, and looks at what
happened.
"""

from __future__ import annotations

import json
import math
import re
import sys
import threading
import time
import wave
from html import unescape
from typing import Any

import qi
from stand_in_body import Body

BLOCK = 2720
"""Samples that ALAudioDevice sends at a time: 170 ms."""
JOINTS = {
    "HeadYaw": (-2.0857, 2.0857),
    "HeadPitch": (-0.7068, 0.4451),
    "LShoulderPitch": (-2.0857, 2.0857),
    "RShoulderPitch": (-2.0857, 2.0857),
    "RElbowRoll": (0.0087, 1.5620),
    "LHand": (0.0, 1.0),
    "WheelFL": (-1.0, 1.0),
}
ANIMATIONS = [
    "animations/Stand/Gestures/Hey_1",
    "animations/Stand/Gestures/Yes_1",
    "animations/Stand/Gestures/No_1",
    "animations/Stand/Gestures/BowShort_1",
    "animations/Stand/Waiting/FunnyDancer_1",
]
FLAP = "Device/SubDeviceList/Platform/ILS/Sensor/Value"
SONAR = re.compile(r"Device/SubDeviceList/Platform/(Front|Back)/Sonar/Sensor/Value")
MAP = "/home/nao/.local/share/Explorer/ward.explo"


class Robot:
    """What the services have in common."""

    def __init__(self, scene: dict[str, Any]) -> None:
        self.body = Body(scene.get("braking", 1.0), scene.get("hurry", 1.0))
        self.awake = scene.get("awake", True)
        self.life = scene.get("life", "disabled")
        self.flap = scene.get("flap", False)
        self.speaks = scene.get("speaks", 200.0)  # characters a second
        self.languages = scene.get("languages", ["English", "German", "French"])
        self.language = self.languages[0]
        self.volume = 50
        self.battery = scene.get("battery", 87)
        self.localised = scene.get("localised", True)
        self.code = None  # what navigateToInMap returns whatever happens
        self.voices = list(scene.get("voices", []))  # recordings, one for each time it listens
        self.lost_sound = scene.get("lost_sound", False)
        self.nonsense = scene.get("nonsense", False)
        self.angles = dict.fromkeys(JOINTS, 0.0)
        self.said: list[list[Any]] = []
        self.done: list[str] = []
        self.shown: str | None = None
        self.eyes: int | None = None
        self.hush = threading.Event()
        self.limp = threading.Event()
        self.webview: Any = None
        self.lock_wheels()

    def lock_wheels(self) -> None:
        self.body.locked = self.flap or self.life != "disabled" or not self.awake


@qi.multiThreaded()
class ALMotion:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def moveTo(self, x: float, y: float, theta: float, config: list[Any]) -> bool:
        how = dict(config)
        for name, (least, most) in {
            "MaxVelXY": (0.1, 0.55),
            "MaxVelTheta": (0.2, 2.0),
            "MaxAccXY": (0.1, 0.55),
        }.items():
            if not least - 1e-6 <= how.get(name, least) <= most + 1e-6:
                raise RuntimeError(f"ALMotion::moveTo\n\t{name} is out of range")
        self._robot.done.append(f"moveTo {x:.2f} {y:.2f} {math.degrees(theta):.0f}")
        bx, by, bt = self._robot.body.pose
        goal = (
            bx + x * math.cos(bt) - y * math.sin(bt),
            by + x * math.sin(bt) + y * math.cos(bt),
            bt + theta,
        )
        most = (how.get("MaxVelXY", 0.35), how.get("MaxVelTheta", 1.0), how.get("MaxAccXY", 0.3))
        return self._robot.body.go(goal, most)

    def stopMove(self) -> None:
        self._robot.done.append("stopMove")
        self._robot.body.stop()

    def killAll(self) -> None:
        self._robot.done.append("killAll")
        self._robot.limp.set()
        self._robot.body.stop()

    def moveIsActive(self) -> bool:
        return self._robot.body.moving

    def getRobotVelocity(self) -> list[Any]:
        return ["fast"] if self._robot.nonsense else list(self._robot.body.velocity)

    def robotIsWakeUp(self) -> bool:
        return self._robot.awake

    def wakeUp(self) -> None:
        self._robot.done.append("wakeUp")
        self._robot.awake = True
        self._robot.lock_wheels()

    def rest(self) -> None:
        self._robot.done.append("rest")
        self._robot.awake = False
        self._robot.lock_wheels()

    def getBodyNames(self, chain: str) -> list[str]:
        return list(JOINTS)

    def getLimits(self, joint: str) -> list[list[float]]:
        return [] if self._robot.nonsense else [[*JOINTS[joint], 7.0, 1.0]]

    def getAngles(self, joint: str, measured: bool) -> list[float]:
        return [] if self._robot.nonsense else [self._robot.angles[joint]]

    def angleInterpolationWithSpeed(self, joint: str, angle: float, fraction: float) -> None:
        if joint not in JOINTS:
            raise RuntimeError(f"ALMotion::angleInterpolationWithSpeed\n\t{joint} is unknown")
        self._robot.limp.clear()
        turn = abs(angle - self._robot.angles[joint]) / (7.0 * fraction)
        if not self._robot.limp.wait(turn / self._robot.body.hurry):
            self._robot.angles[joint] = angle


@qi.multiThreaded()
class ALTextToSpeech:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def getAvailableLanguages(self) -> list[str]:
        return self._robot.languages

    def getLanguage(self) -> str:
        return self._robot.language

    def setLanguage(self, language: str) -> None:
        if language not in self._robot.languages:
            raise RuntimeError(f"ALTextToSpeech::setLanguage\n\t{language} is not installed")
        self._robot.language = language

    def say(self, text: str) -> None:
        speak(self._robot, text)

    def stopAll(self) -> None:
        self._robot.done.append("stopAll")
        self._robot.hush.set()


@qi.multiThreaded()
class ALAnimatedSpeech:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def say(self, text: str, how: dict[str, str]) -> None:
        self._robot.done.append(f"animated {how['bodyLanguageMode']}")
        speak(self._robot, text)


def speak(robot: Robot, text: str) -> None:
    robot.hush.clear()
    robot.said.append([text, robot.language, robot.volume])
    robot.hush.wait(len(text) / robot.speaks)


@qi.multiThreaded()
class ALAnimationPlayer:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def run(self, animation: str) -> None:
        if animation not in ANIMATIONS:
            raise RuntimeError(f"ALAnimationPlayer::run\n\t{animation} is not installed")
        self._robot.done.append(animation)
        self._robot.limp.clear()
        self._robot.limp.wait(2.0 / self._robot.body.hurry)


@qi.multiThreaded()
class ALBehaviorManager:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._over = threading.Event()

    def getInstalledBehaviors(self) -> list[str]:
        return [*ANIMATIONS, "taichi"]

    def runBehavior(self, name: str) -> None:
        self._robot.done.append(f"run {name}")
        self._over.clear()
        self._over.wait(60 / self._robot.body.hurry)

    def stopBehavior(self, name: str) -> None:
        self._robot.done.append(f"end {name}")
        self._over.set()


@qi.multiThreaded()
class ALAudioDevice:
    def __init__(self, robot: Robot, session: Any) -> None:
        self._robot = robot
        self._session = session
        self._open: set[str] = set()

    def setOutputVolume(self, percent: int) -> None:
        self._robot.volume = percent

    def setClientPreferences(self, name: str, rate: int, channels: int, interleaved: int) -> None:
        if (rate, channels, interleaved) != (16000, 3, 0):
            raise RuntimeError("ALAudioDevice::setClientPreferences\n\tthe front one has 16000 Hz")

    def subscribe(self, name: str) -> None:
        self._robot.done.append("subscribe")
        self._open.add(name)
        sound = b"\0\0" * 8000
        if self._robot.voices:
            sound += recorded(self._robot.voices.pop(0))
        if not self._robot.lost_sound:
            threading.Thread(target=self._send, args=(name, sound), daemon=True).start()

    def unsubscribe(self, name: str) -> None:
        self._robot.done.append("unsubscribe")
        self._open.discard(name)

    def _send(self, name: str, sound: bytes) -> None:
        receiver = self._session.service(name)
        at = 0
        while name in self._open:
            block = sound[at : at + 2 * BLOCK].ljust(2 * BLOCK, b"\0")
            at += 2 * BLOCK
            now = time.time()
            stamp = [int(now), int(now % 1 * 1e6)]
            receiver.processRemote(1, BLOCK, stamp, bytearray(block))
            time.sleep(BLOCK / 16000 / self._robot.body.hurry)


def recorded(file: str) -> bytes:
    with wave.open(file) as recording:
        return recording.readframes(recording.getnframes())


@qi.multiThreaded()
class ALTabletService:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        robot.webview = self
        self.onJSEvent = qi.Signal("(s)")

    def showWebview(self, address: str) -> bool:
        self._robot.shown = address
        return True

    def hideWebview(self) -> bool:
        self._robot.shown = None
        return True


@qi.multiThreaded()
class ALLeds:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def fadeRGB(self, group: str, colour: int, seconds: float) -> None:
        self._robot.eyes = colour


@qi.multiThreaded()
class ALBattery:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def getBatteryCharge(self) -> Any:
        return math.nan if self._robot.nonsense else self._robot.battery


@qi.multiThreaded()
class ALMemory:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def getData(self, key: str) -> Any:
        if key == FLAP:
            return float(self._robot.flap)
        sonar = SONAR.fullmatch(key)
        if sonar is None:
            raise RuntimeError(f"ALMemory::getData\n\tcould not find {key}")
        return self._robot.body.ahead(sonar[1].lower())


@qi.multiThreaded()
class ALAutonomousLife:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot

    def getState(self) -> str:
        return self._robot.life

    def setState(self, state: str) -> None:
        self._robot.done.append(f"life {state}")
        self._robot.life = state
        self._robot.awake = state != "disabled"
        self._robot.lock_wheels()


@qi.multiThreaded()
class ALNavigation:
    def __init__(self, robot: Robot) -> None:
        self._robot = robot
        self._loaded = False

    def loadExploration(self, file: str) -> bool:
        self._loaded = file == MAP
        self._robot.done.append("load map")
        return self._loaded

    def startLocalization(self) -> None:
        if not self._loaded:
            raise RuntimeError("ALNavigation::startLocalization\n\tno map is loaded")

    def relocalizeInMap(self, pose: list[float]) -> None:
        self._robot.localised = True
        self._robot.body.pose = (pose[0], pose[1], pose[2])

    def getRobotPositionInMap(self) -> list[list[float]]:
        if not self._loaded:
            raise RuntimeError("ALNavigation::getRobotPositionInMap\n\tno map is loaded")
        if not self._robot.localised:
            return [[math.nan] * 3, [math.nan] * 3]
        return [list(self._robot.body.pose), [0.01, 0.01, 0.01]]

    def navigateToInMap(self, pose: list[float]) -> int:
        self._robot.done.append(f"navigate {pose[0]:.2f} {pose[1]:.2f}")
        if self._robot.code is not None:
            return self._robot.code
        went = self._robot.body.go((pose[0], pose[1], pose[2]), (0.35, 1.0, 0.5))
        return 0 if went else 4


@qi.multiThreaded()
class StandIn:
    """For tests alone."""

    def __init__(self, robot: Robot, services: dict[str, int], session: Any) -> None:
        self._robot = robot
        self._services = services
        self._session = session

    def state(self) -> str:
        robot = self._robot
        told = ("said", "done", "shown", "eyes", "volume", "language", "awake", "life", "angles")
        return json.dumps(
            {name: getattr(robot, name) for name in told}
            | {
                "pose": robot.body.pose,
                "velocity": robot.body.velocity,
                "stood_at": robot.body.stood_at,
            }
        )

    def set(self, name: str, value: str) -> None:
        target = self._robot.body if hasattr(self._robot.body, name) else self._robot
        setattr(target, name, json.loads(value))
        self._robot.lock_wheels()

    def restart(self, service: str) -> None:
        """As if it had crashed and been started again."""
        self.remove(service)
        again = ALBattery(self._robot)
        self._services[service] = self._session.registerService(service, again)

    def remove(self, service: str) -> None:
        self._session.unregisterService(self._services[service])

    def touch(self, label: str) -> bool:
        """Press the button of that label, if there is one; the page raises its event."""
        import base64

        page = base64.b64decode((self._robot.shown or "").partition("base64,")[2]).decode()
        for event, text in re.findall(r"raiseEvent\('([^']*)'\)\">([^<]*)<", page):
            if unescape(text) == label:
                self._robot.webview.onJSEvent(event)
                return True
        return False


def main() -> None:
    scene = json.loads(sys.argv[1]) if len(sys.argv) > 1 else {}
    qi.logging.setLevel(qi.logging.FATAL)
    session = qi.Session()
    session.listenStandalone(scene.get("url", "tcp://127.0.0.1:0"))
    robot = Robot(scene)
    made = [
        ALMotion(robot),
        ALTextToSpeech(robot),
        ALAnimatedSpeech(robot),
        ALAnimationPlayer(robot),
        ALBehaviorManager(robot),
        ALAudioDevice(robot, session),
        ALTabletService(robot),
        ALLeds(robot),
        ALBattery(robot),
        ALMemory(robot),
        ALAutonomousLife(robot),
        ALNavigation(robot),
    ]
    services: dict[str, int] = {}
    for service in made:
        name = type(service).__name__
        if name not in scene.get("without", ()):
            services[name] = session.registerService(name, service)
    session.registerService("StandIn", StandIn(robot, services, session))
    print("URL", session.endpoints()[-1], flush=True)
    sys.stdin.read()  # until whoever started it is gone


main()
