"""`nl2robot pages`: the pages of the console that other packages add, and a check of one."""

from __future__ import annotations

import argparse

from nl2robot.errors import ExitStatus
from robot_api.plugins import PAGES, plugins


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="check")
    checking = actions.add_parser(
        "check",
        help="open a console with a page, and look whether it keeps to what is promised",
        description="Open a console with a page, and look whether it keeps to what is promised.",
    )
    checking.add_argument("page", metavar="NAME", help="such as `nl2robot pages` lists it")


def run(options: argparse.Namespace) -> int:
    """The exit status of a check is 1 if something is wrong."""
    if options.action != "check":
        for name, plugin in plugins(PAGES).items():
            print(f"{name}  of the package {plugin.package}")
        return ExitStatus.OK
    from nl2robot.console.checker import check_page

    troubles = check_page(options.page)
    print("\n".join(troubles or ["It keeps to what is promised."]))
    return ExitStatus.FAILED if troubles else ExitStatus.OK
