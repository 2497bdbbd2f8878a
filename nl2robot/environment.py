"""The environment variables that nl2robot goes by, and the page about them, docs/settings.md.

python -m nl2robot.environment            prints the page
python -m nl2robot.environment --write    writes docs/settings.md anew
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Final

PAGE = Path(__file__).parents[1] / "docs" / "settings.md"
"""Where the page lives in a checkout."""

RUNNING: Final[Mapping[str, str]] = {
    "NL2ROBOT_HOME": "the data folder, for what is kept: the run log, accounts, certificates,"
    " routines, models; the user's own data folder if it is not set. With it, what can be made"
    " again is kept in its folder `cache`",
    "NL2ROBOT_MODELS": "the folder of the speech and language models, if it is another than"
    " `models` in the data folder",
    "NL2ROBOT_LANGUAGE_MODEL": "the language model: `planner-large`, `planner`, or `none` for the"
    " rules alone; `planner-large` where it is installed, if it is not set",
    "NL2ROBOT_USER": "who approves, for the log, at this terminal; the login name if it is not set",
    "NL2ROBOT_ASK_ALWAYS": "anything but nothing: `run` and `chat` ask also before a program that"
    " only looks or tells, as `--ask-always`",
    "NL2ROBOT_FLEET_KEY": "the key of the robot's fleet, `serve --fleet`, where it is not in"
    " `fleet.key` of the data folder",
    "NL2ROBOT_MQTT_PASSWORD": "the password for the house's MQTT broker, `serve --mqtt`",
    "NL2ROBOT_ROBOT_PASSWORD": "the password of the robot's own login, which no command line should"
    " show",
}
"""Read by commands and servers, with what each is for."""
SERVICE: Final[Mapping[str, str]] = {
    "NL2ROBOT_ROBOT": "the robot's address, which the unit file hands to `serve --robot`",
    "NL2ROBOT_TOKEN": "what programs show instead of signing in, which it hands to `serve --token`",
}
"""Of the unit file for systemd: the server itself does not read them."""
DEVELOPING: Final[Mapping[str, str]] = {
    "NL2ROBOT_BENCH_HOURS": "how many hours of noise `nl2robot bench hotword` listens to",
    "NL2ROBOT_BENCH_LANGUAGE": "of which language alone: en, de or fr",
    "NL2ROBOT_PICTURES": "a folder in which the tests of the console keep pictures of its pages",
    "NL2ROBOT_ROS2": "the Python with ROS 2 for the tests against real ROS 2 nodes",
    "NL2ROBOT_REPOSITORY": "where the project is, for the links of `make docs` that lead there",
    "NL2ROBOT_EDIT": "where a page of the docs is edited, for `make docs`",
}
"""For whoever works on nl2robot."""

FILES: Final = (
    (
        "a world: the floor, its places and people",
        "`--world FILE`",
        "[Worlds](worlds.md#everything-a-world-may-say)",
    ),
    (
        "a robot file: limits, joints, names of one robot",
        "`--robot-file FILE`",
        "[The robot file](robots.md#the-robot-file)",
    ),
    (
        "sentences of your house, with what they should do",
        "`nl2robot test FILE`",
        "[Talking](talking.md#your-own-sentences-as-tests)",
    ),
    ("routines, to hand on", "`nl2robot routines import FILE`", "[Routines](routines.md)"),
    (
        "a certificate and its key",
        "`serve --certificate FILE --key FILE`",
        "[Encryption](building.md#encryption)",
    ),
    (
        "the environment of the service",
        "systemd",
        "[Started by systemd](deployment.md#started-by-systemd)",
    ),
)
"""What people write themselves, by what it is given, and where it is explained."""

_HEAD = """\
# Settings

<!-- Made from its table by `python -m nl2robot.environment --write`; not to be edited. -->

There is no settings file. What a command does, its options say
([The command line](command-line.md)); what holds for a computer, environment variables; what holds
for a robot or a hospital, a file that the options name.

## Environment variables

"""
_FILES = """\
## Files that you write

| file | given by | its page |
|---|---|---|
"""
_TAIL = """
What nl2robot writes itself, in its data folder, is in [What is kept](privacy.md). What people
choose on a page of the console their browser keeps.
"""


def page() -> str:
    """The page, in Markdown."""
    tables = (
        _table("read by commands and servers", RUNNING),
        _table("in the [unit file](deployment.md#started-by-systemd)", SERVICE),
        _table("for developing", DEVELOPING),
    )
    files = (f"| {' | '.join(row)} |\n" for row in FILES)
    return "".join((_HEAD, *tables, _FILES, *files, _TAIL))


def _table(heading: str, variables: Mapping[str, str]) -> str:
    rows = "".join(f"| `{name}` | {about} |\n" for name, about in variables.items())
    return f"| {heading} | |\n|---|---|\n{rows}\n"


if __name__ == "__main__":
    if "--write" in sys.argv[1:]:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page(), end="")
