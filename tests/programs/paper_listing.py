"""A robot guide of the shape of the paper's Listing 1, in its style of messages.

python tests/programs/paper_listing.py 127.0.0.1:9090
"""

import re
import sys
from collections.abc import Callable

from robot_api.messages import Robot


def guide(address: str, goes_on: Callable[[], bool] = lambda: True) -> None:
    robot = Robot()
    robot.connect(address)

    robot.send_message(
        robot.displayHTML(html="<html><h1 style='text-align: center'>Starting Up</h1></html>")
    )
    robot.send_message(robot.say("I'm coming"))

    # Returns when the robot has arrived.
    robot.send_message(robot.goto(-605, -1027, -1.3))
    robot.send_message(robot.say("We have arrived at the pharmacy."))

    intensive_care = re.compile("intensive|care|unit")
    pharmacy = re.compile("pharmacy")
    while goes_on():
        response = robot.send_message(
            robot.listen(prompt="Would you like to go to another station")
        )
        speech = response.get("data", {}).get("speech")
        if intensive_care.search(speech):
            robot.send_message(robot.goto(-120, -490, 2.6))
            robot.send_message(robot.say("We have arrived at the intensive care unit."))
        if pharmacy.search(speech):
            robot.send_message(robot.say("Then off to the pharmacy."))
            robot.send_message(robot.goto(157, -71, -1.3))
            robot.send_message(robot.say("We have arrived at the pharmacy."))

    robot.disconnect()


if __name__ == "__main__":
    guide(sys.argv[1])
