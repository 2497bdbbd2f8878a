"""A body that drives: what stands in for Pepper's wheels.

It speeds up, keeps to its greatest speed and brakes as the real one does, and stops before
obstacles. Metres, radians, seconds, on a floor whose middle is where it starts.
"""

from __future__ import annotations

import math
import threading
import time

STEP = 0.004
RADIUS = 0.25
REACH = 0.05
"""Metres before an obstacle at which it stands."""


class Body:
    def __init__(self, braking: float = 1.0, hurry: float = 1.0) -> None:
        """`braking`: metres a second, per second. `hurry`: how much faster than the real one it
        drives when nobody measures it."""
        self.braking = braking
        self.hurry = hurry
        self.pose = (0.0, 0.0, 0.0)
        self.obstacles: list[tuple[float, float, float]] = []
        """x, y, radius."""
        self.locked = False
        """The wheels are: every movement fails at once."""
        self.stood_at = 0.0
        """When it came to a standstill last, on the clock that all processes share."""
        self._speed = 0.0
        self._turning = 0.0
        self._heading = 0.0  # of what speed there is
        self._job = 0
        self._ended: dict[int, bool] = {}
        self._goal: tuple[float, float, float] | None = None
        self._most = (0.35, 1.0, 0.5)
        self._changed = threading.Condition()
        threading.Thread(target=self._drive, daemon=True).start()

    @property
    def velocity(self) -> tuple[float, float, float]:
        angle = self._heading - self.pose[2]
        return (self._speed * math.cos(angle), self._speed * math.sin(angle), self._turning)

    @property
    def moving(self) -> bool:
        return self._goal is not None

    def go(self, goal: tuple[float, float, float], most: tuple[float, float, float]) -> bool:
        """Drive to a pose on the floor; whether it got there. `most`: metres and radians a second,
        metres a second per second."""
        with self._changed:
            if self.locked:
                return False
            if self._goal is not None:
                self._ended[self._job] = False
            self._job += 1
            mine = self._job
            self._goal, self._most = goal, most
            self._changed.notify_all()
            while mine not in self._ended:
                self._changed.wait()
            return self._ended.pop(mine)

    def stop(self) -> None:
        """Brake; what was going on has failed."""
        with self._changed:
            self._finish(False)

    def ahead(self, side: str) -> float:
        """Metres to the nearest obstacle on that side."""
        x, y, theta = self.pose
        if side == "back":
            theta += math.pi
        seen = 5.0
        for ox, oy, radius in self.obstacles:
            angle = math.atan2(oy - y, ox - x) - theta
            if math.cos(angle) > 0.7:
                seen = min(seen, math.hypot(ox - x, oy - y) - radius - RADIUS)
        return max(0.0, seen)

    def _finish(self, arrived: bool) -> None:
        if self._goal is not None:
            self._goal = None
            self._ended[self._job] = arrived
            self._changed.notify_all()

    def _drive(self) -> None:
        before = time.monotonic()
        while True:
            with self._changed:
                while self._goal is None and self._speed == 0 and self._turning == 0:
                    self._changed.wait()
                    before = time.monotonic()
                now = time.monotonic()
                # in steps as small on a busy machine as on any other: it stands before what is in
                # its way, not a long step before it
                passed = min(now - before, 0.05)
                steps = max(1, math.ceil(passed / STEP))
                for _ in range(steps):
                    self._step(passed / steps)
                before = now
            time.sleep(STEP)

    def _step(self, seconds: float) -> None:
        x, y, theta = self.pose
        if self._goal is None:
            self._speed = max(0.0, self._speed - self.braking * self.hurry * seconds)
            self._turning = 0.0 if abs(self._turning) < 0.05 else self._turning * 0.8
            self._advance(x, y, theta, seconds)
            if self._speed == 0 and self._turning == 0:
                self.stood_at = time.monotonic()
            return
        gx, gy, gtheta = self._goal
        speed, turn_rate, acceleration = (each * self.hurry for each in self._most)
        away = math.hypot(gx - x, gy - y)
        turn = math.remainder(gtheta - theta, math.tau)
        if away > 1e-4:
            self._heading = math.atan2(gy - y, gx - x)
            slowing = math.sqrt(2 * acceleration * self.hurry * away)
            faster = self._speed + acceleration * self.hurry * seconds
            self._speed = min(speed, faster, max(slowing, 0.02), away / seconds)
        else:
            self._speed = 0.0
        self._turning = math.copysign(min(turn_rate, abs(turn) / seconds), turn) if turn else 0.0
        self._advance(x, y, theta, seconds)
        if self._goal is None:
            return
        x, y, theta = self.pose
        if (
            math.hypot(gx - x, gy - y) < 1e-3
            and abs(math.remainder(gtheta - theta, math.tau)) < 1e-3
        ):
            self._speed = self._turning = 0.0
            self._finish(True)

    def _advance(self, x: float, y: float, theta: float, seconds: float) -> None:
        nx = x + self._speed * math.cos(self._heading) * seconds
        ny = y + self._speed * math.sin(self._heading) * seconds
        for ox, oy, radius in self.obstacles:
            near = math.hypot(ox - nx, oy - ny) - radius - RADIUS
            if near < REACH and near < math.hypot(ox - x, oy - y) - radius - RADIUS:
                self._speed = self._turning = 0.0
                self._finish(False)
                return
        self.pose = (nx, ny, theta + self._turning * seconds)
