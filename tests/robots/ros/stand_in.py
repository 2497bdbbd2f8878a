"""A robot with a rosbridge, over a real socket: what `rosbridge_suite` does, with its faults.

It speaks the protocol as rosbridge 2.x and 0.11 do, and moves: odometry, amcl, a velocity that
times out, NavigateToPose or move_base, keep-out filters, joints, a battery, a camera. What is known
of real ones is so by default:

- a connection on which a goal was sent is not read until the goal has ended (rosbridge_suite #909);
- what is published right after advertising is lost (rosbridge_suite, ros2 #698);
- a wrong type, an unknown topic or an absent action server get no reply;
- the link cut in the middle, the robot drives on to its goal.
"""

from __future__ import annotations

import asyncio
import json
import math
import socket
import threading
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from websockets.asyncio.server import Server, ServerConnection, serve
from websockets.exceptions import ConnectionClosed

Message = dict[str, Any]

TICK = 0.02
LOST_AFTER_ADVERTISING = 0.2
ARRIVED = 0.08
HEARTBEAT = "/nl2robot/heartbeat"
HEAD = "/head_controller/follow_joint_trajectory"
VELOCITY_HOLDS = 0.3
"""Seconds after which a velocity that is not repeated ends, as in most bases."""


@dataclass
class Body:
    """Where it is on its map, and how it moves."""

    x: float = 0.0
    y: float = 0.0
    theta: float = 0.0
    speed: float = 0.0
    turning: float = 0.0
    wanted: tuple[float, float] = (0.0, 0.0)
    wanted_at: float = 0.0
    braking: float = 4.0
    """Metres per second, per second."""
    turns_up: float = 15.0
    """Radians per second, per second."""
    odometry_x: float = 3.0
    """Odometry began elsewhere than the map: nobody may take the one for the other."""

    def roll(self, seconds: float) -> None:
        self.theta = math.remainder(self.theta + self.turning * seconds, math.tau)
        self.x += self.speed * math.cos(self.theta) * seconds
        self.y += self.speed * math.sin(self.theta) * seconds


@dataclass
class Goal:
    x: float
    y: float
    theta: float
    client: Client | None
    """Whom the result is told, in ROS 2."""
    name: str
    cancelled: bool = False


@dataclass(eq=False)
class Client:
    socket: ServerConnection
    subscribed: dict[str, float] = field(default_factory=dict)
    """Topics with the seconds between two messages."""
    sent: dict[str, float] = field(default_factory=dict)
    advertised: dict[str, float] = field(default_factory=dict)
    free: asyncio.Event = field(default_factory=asyncio.Event)
    outbox: asyncio.Queue[str] = field(default_factory=asyncio.Queue)


@dataclass
class Faults:
    goals_block: bool = True
    mute: bool = False
    """Nothing is answered any more; the connections stay."""
    answers_after: float = 0.0
    hears_after: float = 0.0
    """Seconds that a message is on its way."""
    nonsense: bool = False
    no_odometry: bool = False
    nan_odometry: bool = False
    nan_pose: bool = False
    frozen: bool = False
    """Its wheels do not turn."""
    runs_away: bool = False
    """It heeds no velocity and no cancel."""
    silent_goals: bool = False
    """A goal is taken, and that is all."""
    lies: bool = False
    """It says that it has arrived, at once."""
    aborts: tuple[int, str] | None = None
    """With which code and text it gives up a goal."""


class StandIn:
    """`robot = StandIn(version=2)`, `with robot: robot.port`."""

    def __init__(
        self,
        version: int = 2,
        *,
        stamped: bool = False,
        start: tuple[float, float, float] = (0.0, 0.0, 0.0),
        speed: float = 3.0,
        without: tuple[str, ...] = (),
        types: Mapping[str, str] | None = None,
        keep_out_filter: bool = False,
        rosapi: bool = True,
        password: bool = False,
        navigates: bool = True,
        head_action: bool = False,
    ) -> None:
        self.version = version
        self.navigates = navigates and version == 2
        self.head_action = head_action
        self.body = Body(*start)
        self.speed = speed
        self.faults = Faults()
        self.goal: Goal | None = None
        self.goals: list[Goal] = []
        self.published: list[tuple[str, Message]] = []
        """What clients published and the robot heard, with their topics."""
        self.services: dict[str, Callable[[Message], Message]] = {}
        self.percentage: float | None = 0.73
        self.joints = {"head_pan": 0.0, "head_tilt": 0.1}
        self.camera: str | None = None
        self.scan: Message | None = None
        self.rosapi = rosapi
        self.map = _floor()
        self._stood = 0.0
        self.heartbeats: list[str] = []
        self.unheard = ""
        """A topic that the robot publishes no more."""
        self._password = password
        self._twist = "geometry_msgs/TwistStamped" if stamped else "geometry_msgs/Twist"
        self.topics = self._topics(keep_out_filter) | dict(types or {})
        for topic in without:
            self.topics.pop(topic, None)
        self._clients: list[Client] = []
        self._status: list[Message] = []
        self._loop = asyncio.new_event_loop()
        self._server: Server | None = None
        self._started = threading.Event()
        self._changed = threading.Condition()
        self.port = 0
        self._thread = threading.Thread(target=self._run, name="stand-in", daemon=True)

    def __enter__(self) -> StandIn:
        self._thread.start()
        assert self._started.wait(10)
        return self

    def __exit__(self, *_: object) -> None:
        asyncio.run_coroutine_threadsafe(self._shut(), self._loop).result(10)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(10)

    # --- what a test does and sees ---------------------------------------------------------------

    def cut(self) -> None:
        """The network is gone: connections end without a goodbye, new ones are refused."""
        asyncio.run_coroutine_threadsafe(self._cut(), self._loop).result(10)

    def cut_off_from_outside(self) -> None:
        """So it is, but for who listens for the heartbeat: that is on the robot itself."""
        asyncio.run_coroutine_threadsafe(self._cut(HEARTBEAT), self._loop).result(10)

    def mend(self) -> None:
        """The network is back."""
        asyncio.run_coroutine_threadsafe(self._listen(), self._loop).result(10)

    def until(self, what: Callable[[], Any], within: float = 10.0) -> Any:
        """Wait for it to be true; the robot's state is looked at whenever it changes."""
        end = time.monotonic() + within
        with self._changed:
            while not (found := what()):
                left = end - time.monotonic()
                assert left > 0, f"it did not come about within {within} s"
                self._changed.wait(min(left, 0.1))
        return found

    def at_the_robot(self, what: Callable[[], None]) -> None:
        """Do it in the robot's own time."""

        async def done() -> None:
            what()

        asyncio.run_coroutine_threadsafe(done(), self._loop).result(10)

    @property
    def stands(self) -> bool:
        return self.body.speed == 0.0 and self.body.turning == 0.0

    @property
    def connections(self) -> int:
        return len(self._clients)

    def listens(self, topic: str) -> bool:
        """Whether anybody has subscribed to it."""
        return any(topic in client.subscribed for client in list(self._clients))

    def heard(self, topic: str) -> list[Message]:
        return [message for where, message in self.published if where == topic]

    # --- topics ----------------------------------------------------------------------------------

    def kind(self, name: str) -> str:
        package, _, what = name.partition("/")
        return name if self.version == 1 else f"{package}/msg/{what}"

    def _topics(self, keep_out_filter: bool) -> dict[str, str]:
        topics = {
            "/cmd_vel": self._twist,
            "/odom": "nav_msgs/Odometry",
            "/amcl_pose": "geometry_msgs/PoseWithCovarianceStamped",
            "/initialpose": "geometry_msgs/PoseWithCovarianceStamped",
            "/map": "nav_msgs/OccupancyGrid",
            "/battery_state": "sensor_msgs/BatteryState",
            "/joint_states": "sensor_msgs/JointState",
            "/head_controller/joint_trajectory": "trajectory_msgs/JointTrajectory",
            "/camera/compressed": "sensor_msgs/CompressedImage",
            "/scan": "sensor_msgs/LaserScan",
            "/say": "std_msgs/String",
        }
        if keep_out_filter:
            topics["/costmap_filter_info"] = "nav2_msgs/CostmapFilterInfo"
            topics["/keepout_filter_mask"] = "nav_msgs/OccupancyGrid"
        if self.version == 1:
            topics |= {
                "/move_base/goal": "move_base_msgs/MoveBaseActionGoal",
                "/move_base/cancel": "actionlib_msgs/GoalID",
                "/move_base/status": "actionlib_msgs/GoalStatusArray",
                "/move_base/result": "move_base_msgs/MoveBaseActionResult",
                "/move_base/feedback": "move_base_msgs/MoveBaseActionFeedback",
            }
        return {topic: self.kind(name) for topic, name in topics.items()}

    @property
    def _action(self) -> str:
        return "/navigate_to_pose"

    # --- the socket ------------------------------------------------------------------------------

    def _run(self) -> None:
        asyncio.set_event_loop(self._loop)
        self._loop.run_until_complete(self._listen())
        moving = self._loop.create_task(self._move())
        self._started.set()
        self._loop.run_forever()
        moving.cancel()
        self._loop.run_until_complete(asyncio.gather(moving, return_exceptions=True))
        self._loop.close()

    async def _listen(self) -> None:
        self._server = await serve(
            self._serve,
            "127.0.0.1",
            self.port,
            max_size=None,
            ping_interval=None,
            process_request=self._may_enter,
        )
        self.port = next(iter(self._server.sockets)).getsockname()[1]

    def _may_enter(self, connection: ServerConnection, request: Any) -> Any:
        login = "Basic bnVyc2U6c2VjcmV0"  # nurse:secret
        if self._password and request.headers.get("Authorization") != login:
            return connection.respond(401, "Who are you?")
        return None

    async def _cut(self, spared: str | None = None) -> None:
        assert self._server is not None
        self._server.close(close_connections=False)
        gone = [client for client in self._clients if spared not in client.subscribed]
        for client in gone:
            client.socket.transport.abort()
            client.free.set()
        while any(client in self._clients for client in gone):
            await asyncio.sleep(0.01)

    async def _shut(self) -> None:
        await self._cut()

    async def _serve(self, connection: ServerConnection) -> None:
        client = Client(connection)
        client.free.set()
        self._clients.append(client)
        sending = asyncio.create_task(self._send_all(client))
        try:
            async for text in connection:
                await client.free.wait()
                message = json.loads(text)
                if self.faults.hears_after:
                    self._loop.call_later(self.faults.hears_after, self._hear, client, message)
                else:
                    self._hear(client, message)
        except ConnectionClosed:
            pass
        finally:
            sending.cancel()
            self._clients.remove(client)
            self._notify()

    async def _send_all(self, client: Client) -> None:
        while True:
            text = await client.outbox.get()
            try:
                await client.socket.send(text)
            except ConnectionClosed:
                return

    def _notify(self) -> None:
        with self._changed:
            self._changed.notify_all()

    def _tell(self, client: Client, message: Message) -> None:
        if self.faults.mute:
            return
        text = json.dumps(message)
        if self.faults.nonsense:
            text = json.dumps({"op": message["op"], "id": message.get("id"), "values": 7})
        if self.faults.answers_after:
            self._loop.call_later(self.faults.answers_after, client.outbox.put_nowait, text)
        else:
            client.outbox.put_nowait(text)

    def _publish(self, topic: str, message: Message) -> None:
        now = time.monotonic()
        if topic == self.unheard:
            return
        for client in self._clients:
            every = client.subscribed.get(topic)
            if every is None or now - client.sent.get(topic, 0.0) < every:
                continue
            client.sent[topic] = now
            self._tell(client, {"op": "publish", "topic": topic, "msg": message})

    # --- the protocol ----------------------------------------------------------------------------

    def _hear(self, client: Client, message: Message) -> None:
        topic = str(message.get("topic", ""))
        match message.get("op"):
            case "subscribe":
                if self.topics.setdefault(topic, message["type"]) == message["type"]:
                    client.subscribed[topic] = message.get("throttle_rate", 0) / 1000
                    self._tell_latched(client, topic)
            case "unsubscribe":
                client.subscribed.pop(topic, None)
            case "advertise":
                known = self.topics.setdefault(topic, message["type"])
                if known == message["type"]:
                    client.advertised[topic] = time.monotonic()
            case "publish":
                self._take(client, topic, message["msg"])
            case "call_service":
                self._call(client, message)
            case "send_action_goal":
                self._pursue(client, message)
            case "cancel_action_goal":
                if self.goal is not None and self.goal.name == message["id"]:
                    self.cancel()
        self._notify()

    def _tell_latched(self, client: Client, topic: str) -> None:
        latched: dict[str, Callable[[], Message]] = {
            "/map": lambda: self.map,
            "/amcl_pose": self._amcl,
        }
        if topic in latched:
            self._tell(client, {"op": "publish", "topic": topic, "msg": latched[topic]()})

    def _take(self, client: Client, topic: str, message: Message) -> None:
        since = client.advertised.get(topic)
        if since is None or time.monotonic() - since < LOST_AFTER_ADVERTISING:
            return
        self.published.append((topic, message))
        match topic:
            case "/cmd_vel":
                stamped = self.topics["/cmd_vel"].endswith("TwistStamped")
                if stamped != ("twist" in message):
                    return  # of another type: rosbridge refuses it
                twist = message["twist"] if stamped else message
                self.body.wanted = twist["linear"]["x"], twist["angular"]["z"]
                self.body.wanted_at = time.monotonic()
            case "/initialpose":
                pose = message["pose"]["pose"]
                body, turn = self.body, pose["orientation"]
                body.odometry_x += body.x - pose["position"]["x"]
                body.x, body.y = pose["position"]["x"], pose["position"]["y"]
                body.theta = 2 * math.atan2(turn["z"], turn["w"])
                self._publish("/amcl_pose", self._amcl())
            case "/nl2robot/heartbeat":
                self.heartbeats.append(message["data"])
                self._publish(topic, message)
            case "/head_controller/joint_trajectory":
                self._bend(message)
            case "/move_base/goal":
                pose = message["goal"]["target_pose"]["pose"]
                self._take_goal(pose, None, message["goal_id"]["id"])
            case "/move_base/cancel":
                if self.goal is not None and message["id"] in ("", self.goal.name):
                    self.cancel()

    def _bend(self, trajectory: Message) -> None:
        angles = trajectory["points"][-1]["positions"]
        if not self.faults.frozen:
            self.joints |= dict(zip(trajectory["joint_names"], angles, strict=True))

    # --- services --------------------------------------------------------------------------------

    def _call(self, client: Client, message: Message) -> None:
        service, arguments = message["service"], message.get("args") or {}
        values: Any = None
        if service.startswith("/rosapi/") and self.rosapi:
            values = self._rosapi(service.removeprefix("/rosapi/"), arguments)
        elif service == f"{self._action}/_action/cancel_goal" and self.navigates:
            values = self._cancel_service(arguments)
        elif service == f"{HEAD}/_action/cancel_goal" and self.head_action:
            values = {"return_code": 0, "goals_canceling": []}
        elif service in self.services:
            values = self.services[service](arguments)
        answer = {"op": "service_response", "id": message["id"], "service": service}
        if values is None:
            answer |= {"values": f"Service {service} does not exist", "result": False}
        else:
            answer |= {"values": values, "result": True}
        self._tell(client, answer)

    def _rosapi(self, service: str, arguments: Message) -> Message | None:
        match service:
            case "topics":
                return {"topics": list(self.topics), "types": list(self.topics.values())}
            case "topic_type":
                return {"type": self.topics.get(arguments["topic"], "")}
            case "publishers":
                return {"publishers": []}
            case "action_servers":
                return {"action_servers": []}  # as in ROS 2 until 2024
            case "service_type":
                known = arguments["service"] in self.services
                return {"type": "std_srvs/srv/Trigger" if known else ""}
            case "get_time":
                return {"time": {"sec": int(time.time()), "nanosec": 0}}
        return None

    def _cancel_service(self, arguments: Message) -> Message:
        uuid = arguments["goal_info"]["goal_id"]["uuid"]
        if any(uuid):
            return {"return_code": 2, "goals_canceling": []}
        if self.goal is not None:
            self.cancel()
        return {"return_code": 0, "goals_canceling": []}

    # --- goals -----------------------------------------------------------------------------------

    def _pursue(self, client: Client, message: Message) -> None:
        if message["action"] == HEAD and self.head_action:
            self._bend(message["args"]["trajectory"])
            result = {"op": "action_result", "id": message["id"], "action": HEAD, "values": {}}
            self._tell(client, result | {"status": 4, "result": True})
            return
        if message["action"] != self._action or not self.navigates:
            return
        if self.faults.goals_block:
            client.free.clear()
        self._take_goal(message["args"]["pose"]["pose"], client, message["id"])

    def pursue(self, x: float, y: float) -> None:
        """A goal that was given on the robot itself."""
        self._take_goal(_pose(x, y, 0.0), None, "its own")

    def _take_goal(self, pose: Message, client: Client | None, name: str) -> None:
        turn = 2 * math.atan2(pose["orientation"]["z"], pose["orientation"]["w"])
        position = pose["position"]
        self.goal = Goal(position["x"], position["y"], turn, client, name)
        self.goals.append(self.goal)
        if self.faults.aborts is not None:
            self._end(6, *self.faults.aborts)
        elif self.faults.lies:
            self._end(4)

    def cancel(self) -> None:
        """Whoever cancels it."""
        assert self.goal is not None
        self.goal.cancelled = True
        if not self.faults.runs_away:
            self._end(5)

    def _end(self, status: int, code: int = 0, text: str = "") -> None:
        """`status` as in ROS 2: 4 succeeded, 5 cancelled, 6 aborted."""
        goal, self.goal = self.goal, None
        assert goal is not None
        if self.version == 1:
            number = {4: 3, 5: 2, 6: 4}[status]
            state = {"goal_id": {"id": goal.name}, "status": number, "text": text}
            self._status = [state]
            self._publish("/move_base/result", {"status": state, "result": {}})
            return
        if goal.client is None:
            return
        goal.client.free.set()
        result = {
            "op": "action_result",
            "id": goal.name,
            "action": self._action,
            "values": {"error_code": code, "error_msg": text},
            "status": status,
            "result": True,
        }
        if goal.client in self._clients:
            self._tell(goal.client, result)

    # --- moving ----------------------------------------------------------------------------------

    async def _move(self) -> None:
        last, ticks = time.monotonic(), 0
        while True:
            await asyncio.sleep(TICK)
            now = time.monotonic()
            self._step(now - last)
            last, ticks = now, ticks + 1
            if not self.faults.no_odometry:
                self._publish("/odom", self._odometry())
            if ticks % 5 == 0:
                self._now_and_then()
            self._notify()

    def _step(self, seconds: float) -> None:
        body = self.body
        ahead, turning = self._wanted()
        step = body.braking * seconds
        body.speed += max(-step, min(step, ahead - body.speed))
        step = body.turns_up * seconds
        body.turning += max(-step, min(step, turning - body.turning))
        self._stood = 0.0 if not self.stands else self._stood + seconds
        if self.faults.frozen:
            body.speed = body.turning = 0.0
        body.roll(seconds)

    def _wanted(self) -> tuple[float, float]:
        body = self.body
        if self.faults.runs_away and (self.goals or body.wanted != (0.0, 0.0)):
            return self.speed, 0.0
        if self.goal is None or self.faults.silent_goals:
            fresh = time.monotonic() - body.wanted_at < VELOCITY_HOLDS
            return body.wanted if fresh else (0.0, 0.0)
        goal = self.goal
        distance = math.hypot(goal.x - body.x, goal.y - body.y)
        there = distance < ARRIVED
        heading = goal.theta if there else math.atan2(goal.y - body.y, goal.x - body.x)
        off = math.remainder(heading - body.theta, math.tau)
        if there and abs(off) < math.radians(1) and self.stands:
            self._end(4)
            return 0.0, 0.0
        if there or abs(off) > math.radians(20):
            turning = max(-3.0, min(3.0, 6 * off))
            return 0.0, turning if abs(off) > math.radians(0.9) else 0.0
        return min(self.speed, math.sqrt(body.braking * distance)), max(-3.0, min(3.0, 6 * off))

    def _now_and_then(self) -> None:
        self._publish("/battery_state", {"percentage": self.percentage, "power_supply_status": 2})
        self._publish(
            "/joint_states",
            {"name": list(self.joints), "position": list(self.joints.values())},
        )
        if self.scan is not None:
            self._publish("/scan", self.scan)
        if self.camera is not None:
            self._publish("/camera/compressed", {"format": "jpeg", "data": self.camera})
        if self._stood < 1.0 or self.faults.nan_pose:
            self._publish("/amcl_pose", self._amcl())
        self._publish("/tf", {"transforms": [self._transform()]})
        goal = self.goal
        if goal is not None and not self.faults.silent_goals:
            left = math.hypot(goal.x - self.body.x, goal.y - self.body.y)
            feedback = {"distance_remaining": left}
            if self.version == 1:
                state = {"goal_id": {"id": goal.name}, "status": 1, "text": ""}
                self._publish("/move_base/feedback", {"status": state, "feedback": {}})
            elif goal.client in self._clients:
                self._tell(
                    goal.client,
                    {
                        "op": "action_feedback",
                        "id": goal.name,
                        "action": self._action,
                        "values": feedback,
                    },
                )
        if self.version == 1:
            active = (
                [{"goal_id": {"id": goal.name}, "status": 1, "text": ""}] if goal else self._status
            )
            self._publish("/move_base/status", {"status_list": active})

    def _odometry(self) -> Message:
        body = self.body
        x = math.nan if self.faults.nan_odometry else body.x - body.odometry_x
        return {
            "pose": {"pose": _pose(x, body.y, body.theta)},
            "twist": {
                "twist": {"linear": {"x": body.speed, "y": 0.0}, "angular": {"z": body.turning}}
            },
        }

    def _transform(self) -> Message:
        """Where odometry began on the map."""
        begin = _pose(self.body.odometry_x, 0.0, 0.0)
        return {
            "header": {"frame_id": "map"},
            "child_frame_id": "odom",
            "transform": {
                "translation": begin["position"],
                "rotation": begin["orientation"],
            },
        }

    def _amcl(self) -> Message:
        x = math.nan if self.faults.nan_pose else self.body.x
        return {"pose": {"pose": _pose(x, self.body.y, self.body.theta)}}


def _pose(x: float, y: float, theta: float) -> Message:
    return {
        "position": {"x": x, "y": y, "z": 0.0},
        "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(theta / 2), "w": math.cos(theta / 2)},
    }


def _floor() -> Message:
    """60 by 40 metres, free but for a wall on the left, with a corner that nobody has seen."""
    width, height = 60, 40
    cells = [0] * (width * height)
    for row in range(height):
        cells[row * width] = 100
    cells[-1] = -1
    return {
        "info": {
            "resolution": 1.0,
            "width": width,
            "height": height,
            "origin": _pose(-20.0, -20.0, 0.0),
        },
        "data": cells,
    }


@contextmanager
def silent_port() -> Iterator[int]:
    """Something that takes connections and says nothing."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        yield server.getsockname()[1]


def free_port() -> int:
    """A port that nobody listens on."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        return int(server.getsockname()[1])
