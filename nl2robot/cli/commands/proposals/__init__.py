"""`nl2robot proposals`: what assistants propose to a server's robot: approve it, or say no."""

from nl2robot.cli.commands.proposals.command import add_arguments, run

__all__ = ["add_arguments", "run"]
