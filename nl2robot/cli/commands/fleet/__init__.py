"""`nl2robot fleet`: several robots: list, give one something to do, call that off, stop."""

from nl2robot.cli.commands.fleet.command import add_arguments, run

__all__ = ["add_arguments", "run"]
