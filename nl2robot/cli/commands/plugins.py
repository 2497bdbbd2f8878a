"""`nl2robot plugins`: what other packages add, and a check of a planner, a voice or a page."""

from __future__ import annotations

import argparse

from grammar.language import languages
from grammar.language import troubles as languages_left_out
from nl2robot.cli.options.world import add_world, names_of
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from nl2robot.speech.speak.checker import check_voice
from nl2robot.speech.speak.voices import others, voice, voices
from nl2robot.translate.planner_checker import check_planner
from nl2robot.translate.planners import planner
from nl2robot.translate.planners import troubles as planners_left_out
from robot_api.plugins import GROUPS, plugins
from robot_api.robots.registry import known


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="check")
    checking = actions.add_parser(
        "check",
        help="look whether a planner, a voice or a page keeps to what is promised",
        description="Look whether a planner, a voice or a page keeps to what is promised. Robots"
        " and languages have checks of their own: `nl2robot robots check`, `nl2robot languages"
        " check`.",
    )
    checking.add_argument("kind", choices=("planner", "voice", "page"))
    checking.add_argument("name", metavar="NAME", help="such as grammar, piper, or a package's")
    checking.add_argument(
        "--lang", choices=languages(), help="voice: in this language (default: all that it speaks)"
    )
    add_world(checking)


def run(options: argparse.Namespace) -> int:
    """The exit status of a check is 1 if something is wrong."""
    if options.action != "check":
        return _list()
    found = _checked(options)
    print("\n".join(found or ["It keeps to what is promised."]))
    return ExitStatus.FAILED if found else ExitStatus.OK


def _list() -> int:
    for group, kind in GROUPS.items():
        for name, plugin in plugins(group).items():
            print(f"{kind} {name}, of the package {plugin.package}")
    spoken = [others(code)[1] for code in languages()]
    for troubles in (known().troubles, planners_left_out(), languages_left_out(), *spoken[:1]):
        for trouble in troubles.values():
            print(trouble)
    return ExitStatus.OK


def _checked(options: argparse.Namespace) -> list[str]:
    match options.kind:
        case "planner":
            return check_planner(planner(options.name), Knowledge(names_of(options)))
        case "voice":
            codes = [options.lang] if options.lang else _languages_of(options.name)
            return [
                f"{code}: {trouble}"
                for code in codes or ["en"]
                for trouble in check_voice(voice(code, options.name), code)
            ]
    from nl2robot.console.checker import check_page  # NiceGUI takes a second to import

    return check_page(options.name)


def _languages_of(name: str) -> list[str]:
    return [
        code
        for code in languages()
        if any(each.name == name or each.name.startswith(f"{name}-") for each in voices(code))
    ]
