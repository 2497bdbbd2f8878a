"""`nl2robot schedule`: approved programs at set times: list, add, approve anew, call off.

What changes the book alone is done in the book of this computer, or at the server that `--robot`
names; to add or approve one opens the robot as `nl2robot run` does, for the review.
"""

from nl2robot.cli.commands.schedule.command import add_arguments, run

__all__ = ["add_arguments", "run"]
