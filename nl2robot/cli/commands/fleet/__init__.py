"""`nl2robot fleet`: several robots at once: list them, give one something to do, stop them."""

from nl2robot.cli.commands.fleet.command import add_arguments, run

__all__ = ["add_arguments", "run"]
