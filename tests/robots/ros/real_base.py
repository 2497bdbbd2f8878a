"""A base as a real ROS 2 node, for a Python with rclpy: Twist in, odometry out, an action."""

from __future__ import annotations

import math
import time

import rclpy
from geometry_msgs.msg import Twist
from nav_msgs.msg import Odometry
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from test_msgs.action import Fibonacci

TICK = 0.02
VELOCITY_HOLDS = 0.5


class Base(Node):
    def __init__(self) -> None:
        super().__init__("base")
        self.x = self.y = self.theta = 0.0
        self.wanted = (0.0, 0.0)
        self.wanted_at = 0.0
        self.create_subscription(Twist, "/cmd_vel", self.hear, 10)
        self.odometry = self.create_publisher(Odometry, "/odom", 10)
        self.create_timer(TICK, self.roll)
        ActionServer(
            self,
            Fibonacci,
            "/fibonacci",
            self.pursue,
            cancel_callback=lambda _: CancelResponse.ACCEPT,
            callback_group=ReentrantCallbackGroup(),
        )

    def hear(self, twist: Twist) -> None:
        self.wanted, self.wanted_at = (twist.linear.x, twist.angular.z), time.monotonic()

    def roll(self) -> None:
        fresh = time.monotonic() - self.wanted_at < VELOCITY_HOLDS
        ahead, turning = self.wanted if fresh else (0.0, 0.0)
        self.theta += turning * TICK
        self.x += ahead * math.cos(self.theta) * TICK
        self.y += ahead * math.sin(self.theta) * TICK
        told = Odometry()
        told.pose.pose.position.x, told.pose.pose.position.y = self.x, self.y
        told.pose.pose.orientation.z = math.sin(self.theta / 2)
        told.pose.pose.orientation.w = math.cos(self.theta / 2)
        told.twist.twist.linear.x, told.twist.twist.angular.z = ahead, turning
        self.odometry.publish(told)

    def pursue(self, goal: object) -> Fibonacci.Result:
        """Counts until it is cancelled."""
        for number in range(3000):
            if goal.is_cancel_requested:
                goal.canceled()
                return Fibonacci.Result()
            goal.publish_feedback(Fibonacci.Feedback(sequence=[number]))
            time.sleep(TICK)
        goal.succeed()
        return Fibonacci.Result()


rclpy.init()
executor = MultiThreadedExecutor(4)
executor.add_node(Base())
executor.spin()
