"""A robot with ROS, put together from what is found on it.

First everything is asked, then everything is advertised and subscribed: where something is not what
the robot file says, nothing was sent that could move.
"""

from __future__ import annotations

import math
import threading
import time
from contextlib import suppress
from functools import partial
from typing import Any

from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.company import LeadingGuiding
from robot_api.capabilities.core import LogBook
from robot_api.capabilities.face import ScreenFace
from robot_api.capabilities.hearing import EarsHearing, Hearing, TabletHearing
from robot_api.capabilities.screen import Screen, TabletScreen
from robot_api.capabilities.speech import LoudspeakerSpeech, Speech
from robot_api.composed import ComposedDriver
from robot_api.errors import AccessDenied, LostConnection, NotSupported, StopNotConfirmed
from robot_api.local_time import local_now
from robot_api.robots.link import Link
from robot_api.robots.registry import Brake, Setup
from robot_api.robots.ros.actions import Action, Ros1Action, Ros2Action
from robot_api.robots.ros.body import (
    Battery,
    Controller,
    JointStates,
    RosCore,
    RosJoints,
)
from robot_api.robots.ros.camera import RosCamera, RosScanner
from robot_api.robots.ros.connection import Connection
from robot_api.robots.ros.dialect import Dialect, Pose, Version
from robot_api.robots.ros.graph import Graph
from robot_api.robots.ros.grid import received
from robot_api.robots.ros.halting import Halting
from robot_api.robots.ros.keep_out import KeepOut
from robot_api.robots.ros.laser import EVERY, Laser
from robot_api.robots.ros.motion import RosMotion, Velocity
from robot_api.robots.ros.navigation import Bounds, RosDock, RosNavigation, Way
from robot_api.robots.ros.settings import USUAL_TOPICS, RosSettings
from robot_api.robots.ros.survey import DOCKING, TRAJECTORIES, Found, going, needed, survey
from robot_api.robots.ros.voice import (
    Names,
    RosFace,
    RosGesture,
    RosSkills,
    RosSpeech,
    by_service,
    by_topic,
)
from robot_api.robots.ros.wheels import Teller, Wheels, Whereabouts
from robot_api.robots.ros.wire import Where

_ODOMETRY_EVERY = 0.02
_FIRST_WORD = 2.0
"""Seconds to wait for the first word of odometry and of where it is."""
_OTHERS_WITHIN = 0.7
"""Seconds to listen for another server's heart, which beats five times a second."""
_MAP_WITHIN = 5.0
_CHARGERS = ("charger", "charging station", "dock")
"""Kinds of places to charge at."""
_DEADLY_SURE = 0.25
"""Square metres: how sure somebody is who shows the robot where it is."""


class RosDriver(ComposedDriver):
    """See `connect`."""

    def __init__(self, connection: Connection, **parts: Any) -> None:
        super().__init__(**parts)
        self._connection = connection

    def close(self) -> None:
        try:
            super().close()
        finally:
            self._connection.close()


def connect(setup: Setup, version: Version) -> RosDriver:
    """Raises `LostConnection`, `AccessDenied`, `NotSupported`."""
    settings = setup.settings if isinstance(setup.settings, RosSettings) else RosSettings()
    connection = _connected(setup, settings)
    try:
        return _Assembly(setup, settings, Dialect(version), connection).driver()
    except BaseException:
        connection.close()
        raise


def brake(setup: Setup, version: Version) -> Brake:
    """What stops the robot beside a driver. Raises as `connect` does."""
    settings = setup.settings if isinstance(setup.settings, RosSettings) else RosSettings()
    connection = _connected(setup, settings)
    try:
        halting = _Assembly(setup, settings, Dialect(version), connection).halting()
    except BaseException:
        connection.close()
        raise
    return Brake(halting.halt, connection.close)


def _connected(setup: Setup, settings: RosSettings) -> Connection:
    address = setup.address
    where = Where(address.host, address.port or 9090, settings.tls, address.user, setup.password)
    return Connection(where, settings.lost_after, _name_of(setup))


def _name_of(setup: Setup) -> str:
    return setup.file.name or f"The robot at {setup.address.host}"


class _Assembly:
    """Puts one driver together, or what stops it."""

    def __init__(
        self,
        setup: Setup,
        settings: RosSettings,
        dialect: Dialect,
        connection: Connection,
    ) -> None:
        name = _name_of(setup)
        self._setup = setup
        self._settings = settings
        self._dialect = dialect
        self._connection = connection
        self._name = name
        self._graph = Graph(connection.work.now, dialect, settings)
        self._hub = Hub()
        self._book = LogBook(local_now, self._hub)
        self._link = Link(self._hub, name)
        self._wheels = Wheels()
        self._battery = Battery(self._hub)
        self._actions: list[Action] = []
        self._keep_out = KeepOut(setup.places.keep_out)

    def driver(self) -> RosDriver:
        self._check_alone()
        found = survey(self._graph, self._dialect, self._settings)
        speech = self._speech(found)
        screen = TabletScreen(self._hub, speech)
        camera = RosCamera(self._connection, *found.camera) if found.camera else None
        base = self._base(found, speech)
        parts: list[Capability] = [
            speech,
            screen,
            self._hearing(speech, screen),
            self._face(found, screen),
            *base,
            *self._body(found, speech, camera),
        ]
        if found.battery is not None:
            self._battery.expected = True
            self._connection.work.subscribe(*found.battery, self._battery.hear, 1.0)
        if found.laser is not None:
            laser = Laser(self._hub, self._settings.laser_turned)
            self._connection.work.subscribe(*found.laser, laser.hear, EVERY)
        halting = self._halting(found)
        core = RosCore(
            self._book,
            halting,
            self._battery,
            self._setup.places.named,
            self._settings.stop_within,
        )
        driver = RosDriver(
            self._connection,
            name=self._name,
            kind=self._setup.address.scheme,
            parts=[core, *parts],
            hub=self._hub,
            book=self._book,
            link=self._link,
            camera=camera,
        )
        self._watch(found, halting)
        return driver

    def halting(self) -> Halting:
        """What stops the robot, without all else that a driver has."""
        found = survey(self._graph, self._dialect, self._settings)
        if found.odometry is not None:
            self._connection.halt.subscribe(*found.odometry, self._wheels.hear, _ODOMETRY_EVERY)
        if found.navigate is not None:
            self._action(found.navigate, going(self._dialect))
        if found.dock is not None:
            self._action(found.dock, DOCKING)
        for name, kind in found.controllers.items():
            if kind == "action":
                self._action(f"{name}/follow_joint_trajectory", TRAJECTORIES)
        return self._halting(found)

    def _halting(self, found: Found) -> Halting:
        return Halting(
            self._actions,
            self._connection.ask,
            self._still(found),
            self._wheels if found.odometry is not None else None,
            self._settings.stop_within,
        )

    def _check_alone(self) -> None:
        """Raise `AccessDenied` if another server's heart is heard on the robot."""
        topic, heard = self._heartbeat, threading.Event()
        kind = self._graph.type_of(topic)
        if not kind:
            return
        line = self._connection.work
        line.subscribe(
            topic, kind, lambda message: heard.set() if message.get("data") == "here" else None
        )
        try:
            if heard.wait(_OTHERS_WITHIN):
                raise AccessDenied(
                    f"Another server drives {self._name} already. End that one first."
                )
        finally:
            line.unsubscribe(topic)

    @property
    def _heartbeat(self) -> str:
        return self._settings.topics.heartbeat or str(USUAL_TOPICS.heartbeat)

    # --- putting together ------------------------------------------------------------------------

    def _base(self, found: Found, speech: Speech) -> list[Capability]:
        if found.odometry is None:
            if found.velocity is not None or found.navigate is not None:
                self._book.write(
                    "no odometry: nothing would tell whether it moves, so it is not driven",
                    "warning",
                )
            return []
        self._connection.halt.subscribe(*found.odometry, self._wheels.hear, _ODOMETRY_EVERY)
        where = self._whereabouts(found)
        parts: list[Capability] = []
        if found.velocity is not None:
            velocity = Velocity(
                self._connection.work, *found.velocity, self._dialect, self._settings.frames.base
            )
            parts.append(
                RosMotion(
                    velocity,
                    self._wheels,
                    where,
                    self._keep_out,
                    self._link,
                    self._setup.file.limits,
                    self._settings,
                )
            )
        if found.navigate is not None and where is not None:
            parts += self._navigation(found, found.navigate, where, speech)
        return parts

    def _whereabouts(self, found: Found) -> Whereabouts | None:
        if found.pose is None:
            return None
        topic, kind = found.pose
        frames = self._settings.frames
        where = Whereabouts(self._wheels, kind, frames.map, frames.odometry, self._settings.drift)
        end = time.monotonic() + _FIRST_WORD
        while self._wheels.last() is None and time.monotonic() < end:
            self._wheels.wait(end - time.monotonic())
        self._connection.work.subscribe(topic, kind, where.hear)
        while where.guess() is None and time.monotonic() < end:
            self._wheels.wait(end - time.monotonic())
        return where

    def _navigation(
        self, found: Found, name: str, where: Whereabouts, speech: Speech
    ) -> list[Capability]:
        way = Way(
            action=self._action(name, going(self._dialect)),
            link=self._link,
            wheels=self._wheels,
            where=where,
            keep_out=self._keep_out,
            settings=self._settings,
        )
        places = self._setup.places
        navigation = RosNavigation(
            way, self._dialect, places, self._bounds(found), self._set_pose(found)
        )

        def tell(pose: Pose, speed: float, seconds: float) -> None:
            here = navigation.location_at(pose)
            self._hub.publish(
                "pose",
                x=here.x,
                y=here.y,
                theta=here.theta,
                place=here.place,
                speed=abs(speed),
                time=seconds,
            )

        self._wheels.on_moment(Teller(tell, where).hear)
        charger = next(
            (
                place.name
                for place in places.named.values()
                if place.goal is not None and place.kind in _CHARGERS
            ),
            None,
        )
        docking = None
        if found.dock is not None:
            action = self._action(found.dock, DOCKING)
            docking = Way(
                action=action,
                link=self._link,
                wheels=self._wheels,
                where=where,
                keep_out=self._keep_out,
                settings=self._settings,
            )
        parts: list[Capability] = [navigation, LeadingGuiding(navigation, speech)]
        if docking is None and charger is None:
            return parts
        return [*parts, RosDock(navigation, charger, docking, self._settings.dock_id)]

    def _bounds(self, found: Found) -> Bounds | None:
        if found.map is None:
            return None
        try:
            grid = received(self._connection.work, *found.map, _MAP_WITHIN)
        except (LostConnection, NotSupported) as error:
            self._book.write(f"no map to check goals by: {error}", "warning")
            return None
        return Bounds(grid.origin, *grid.size)

    def _set_pose(self, found: Found) -> Any:
        if found.initial_pose is None:
            return None
        topic, kind = found.initial_pose
        line = self._connection.work
        line.advertise(topic, kind)
        covariance = [0.0] * 36
        covariance[0] = covariance[7] = _DEADLY_SURE
        covariance[35] = math.radians(15) ** 2

        def set_pose(pose: Pose) -> None:
            stamped = {"pose": pose.message(), "covariance": covariance}
            header = self._dialect.header(self._settings.frames.map)
            line.publish(topic, {"header": header, "pose": stamped})

        return set_pose

    def _body(self, found: Found, speech: Speech, camera: RosCamera | None) -> list[Capability]:
        file, hub, line = self._setup.file, self._hub, self._connection.work
        parts: list[Capability] = []
        if file.gestures:
            names = Names(line, *needed(found.gesture, "gesture"), file.gestures)
            parts.append(RosGesture(hub, names))
        if file.skills:
            for skill in file.skills:
                service = self._settings.skills.get(skill)
                if service is None or not self._graph.service(service):
                    raise NotSupported(
                        f"The robot has no service for the skill '{skill}', which its file names."
                        " Name one in its section ros: skills, or start it."
                    )
            parts.append(RosSkills(line, self._settings.skills, file.skills))
        if camera is not None:
            parts.append(RosScanner(speech, camera))
        if file.joints:
            parts.append(self._joints(found))
        return parts

    def _joints(self, found: Found) -> RosJoints:
        states = JointStates(self._hub, self._setup.file.joints)
        name, kind = needed(found.joint_states, "joint_states")
        self._connection.work.subscribe(name, kind, states.hear, 0.1)
        states.heard.wait(_FIRST_WORD)
        controllers = []
        for name, joints in self._settings.controllers.items():
            if found.controllers[name] == "action":
                action = self._action(f"{name}/follow_joint_trajectory", TRAJECTORIES)
                controllers.append(Controller(joints, action))
                continue
            topic = f"{name}/joint_trajectory"
            self._connection.work.advertise(topic, found.controllers[name])
            publish = partial(self._connection.work.publish, topic)
            controllers.append(Controller(joints, publish=publish))
        controlled = {joint for controller in controllers for joint in controller.joints}
        for joint in self._setup.file.joints:
            if joint not in controlled or joint not in states.angles:
                raise NotSupported(
                    f"The robot file names the joint {joint}, which this robot lacks"
                    f" {'in its joint_states' if joint in controlled else 'in its controllers'}."
                    " Correct the file."
                )
        return RosJoints(controllers, states, self._setup.file.joints, self._dialect)

    def _action(self, name: str, kind: str) -> Action:
        action: Action
        if self._dialect.version == 1:
            action = Ros1Action(self._connection, name, kind, self._dialect)
        else:
            action = Ros2Action(self._connection, name, kind)
        self._actions.append(action)
        return action

    def _speech(self, found: Found) -> Speech:
        wish, service = self._setup.file.speech, self._settings.speech_service
        if wish in (None, "robot"):
            if service is not None:
                if not self._graph.service(service.name):
                    raise NotSupported(
                        f"The robot has no service {service.name}, which its file names for"
                        " speech. Correct the file, or start it."
                    )
                say = by_service(self._connection.work, service)
                return RosSpeech(self._hub, say, self._settings.languages, self._setup.sound)
            if found.speech is not None:
                say = by_topic(self._connection.work, *found.speech)
                return RosSpeech(self._hub, say, self._settings.languages, self._setup.sound)
            if wish == "robot":
                raise NotSupported(
                    "The robot is to speak itself, but its file names neither a topic nor a"
                    " service for it. Name one, or let the server speak."
                )
        return LoudspeakerSpeech(self._hub, self._setup.sound)

    def _hearing(self, speech: Speech, screen: Screen) -> Hearing:
        wish, ears = self._setup.file.hearing, self._setup.sound.ears
        if wish == "robot":
            raise NotSupported(
                "ROS has no common way to hear people. Let the server or a tablet hear them:"
                " hearing: server."
            )
        if ears is None or wish == "tablet":
            return TabletHearing(speech, screen)
        return EarsHearing(self._hub, speech, screen, ears, "the server's microphone")

    def _face(self, found: Found, screen: Screen) -> Capability:
        file = self._setup.file
        if not file.emotions:
            return ScreenFace(screen, self._hub)
        topic, kind = needed(found.emotion, "emotion")
        return RosFace(self._hub, Names(self._connection.work, topic, kind, file.emotions))

    # --- standing, and being there ---------------------------------------------------------------

    def _still(self, found: Found) -> Any:
        """What sets the velocity to zero on the connection for that."""
        if found.velocity is None or found.odometry is None:
            return None
        velocity = Velocity(
            self._connection.halt, *found.velocity, self._dialect, self._settings.frames.base
        )
        return velocity.still

    def _watch(self, found: Found, halting: Halting) -> None:
        heart = self._heartbeat
        self._connection.halt.advertise(heart, self._dialect.type("std_msgs/String"))
        mask = self._mask(found)

        def found_again() -> None:
            try:
                halting.halt()
            except StopNotConfirmed as error:
                self._book.write(f"found again, but: {error}", "error")
            mask()

        def drawn_anew() -> None:
            self._keep_out.hold(self._setup.places.keep_out)
            with suppress(LostConnection):  # it is given them when it is found again
                mask()

        mask()
        self._setup.places.on_keep_out(drawn_anew)
        self._connection.watch(self._link, found_again, heart)

    def _mask(self, found: Found) -> Any:
        """What gives the robot its keep-out zones, if it has a filter for them and nobody else
        fills it."""
        topics, line = self._settings.topics, self._connection.work
        info = found.filter_info
        mask = topics.keep_out_mask or USUAL_TOPICS.keep_out_mask
        if info is None or mask is None or self._graph.is_published(info[0]):
            return lambda: None
        frame = self._settings.frames.map
        given = False

        def give() -> None:
            nonlocal given
            if not given and not self._keep_out:
                return  # it has never had any
            if not given:
                line.advertise(mask, self._dialect.type("nav_msgs/OccupancyGrid"), latch=True)
                line.advertise(*info, latch=True)
            given = True
            grid = self._keep_out.mask(self._dialect, frame, self._settings.mask_resolution)
            line.publish(mask, grid)
            line.publish(
                info[0],
                {
                    "header": self._dialect.header(frame),
                    "type": 0,
                    "filter_mask_topic": mask,
                    "base": 0.0,
                    "multiplier": 1.0,
                },
            )

        return give
