"""The reference page of the command line, docs/command-line.md, made from the commands' parsers.

python -m nl2robot.cli.reference            prints the page
python -m nl2robot.cli.reference --write    writes docs/command-line.md anew
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path

from nl2robot.cli.main import COMMANDS, parser_of
from nl2robot.errors import MEANINGS

PAGE = Path(__file__).parents[2] / "docs" / "command-line.md"
"""Where the page lives in a checkout."""

_HEAD = """\
# The command line

<!-- Made from the commands by `python -m nl2robot.cli.reference --write`; not to be edited. -->

`nl2robot COMMAND --help` says the same in a terminal, and `nl2robot completion` makes Tab complete
it. Every command has `--debug`, which shows the traceback when something goes wrong. What stands in
brackets may be left out.

## Exit statuses

| status | when |
|---:|---|
"""


def page() -> str:
    """The page, in Markdown."""
    statuses = (f"| {status.value} | {meaning} |\n" for status, meaning in MEANINGS.items())
    return _HEAD + "".join(statuses) + "".join(map(_command, COMMANDS))


def _command(name: str) -> str:
    parser = parser_of(name)
    return f"\n## nl2robot {name}\n\n{_first_up(COMMANDS[name])}.\n{''.join(_parts(parser))}"


def _parts(parser: argparse.ArgumentParser) -> Iterator[str]:
    rows = [_row(action) for action in parser._actions if not _is_everywhere(action)]
    if any(rows):
        yield "\n| | |\n|---|---|\n" + "".join(rows)
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            helps = {each.dest: each.help for each in action._choices_actions}
            for name, inner in action.choices.items():
                yield f"\n### {inner.prog}\n\n{_first_up(helps.get(name) or '')}.\n"
                yield from _parts(inner)


def _is_everywhere(action: argparse.Action) -> bool:
    told = action.dest in ("help", "debug") or action.help == argparse.SUPPRESS
    return told or isinstance(action, argparse._SubParsersAction)


def _row(action: argparse.Action) -> str:
    value = action.metavar if isinstance(action.metavar, str) else None
    if value is None and action.choices is not None:
        value = "{" + ",".join(map(str, action.choices)) + "}"
    if action.option_strings:
        takes = "" if action.nargs == 0 else f" {value or action.dest.upper()}"
        shown = ", ".join(f"{name}{takes}" for name in action.option_strings)
    else:
        shown = value or action.dest
        if action.nargs in ("*", "+"):
            shown += " ..."
        if action.nargs in ("*", "?"):
            shown = f"[{shown}]"
    text = (action.help or "") % {**vars(action), "prog": "nl2robot"}
    return f"| `{_cell(shown)}` | {_cell(text)} |\n"


def _cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|").replace("<", "&lt;")


def _first_up(text: str) -> str:
    return text[:1].upper() + text[1:]


if __name__ == "__main__":
    if "--write" in sys.argv[1:]:
        PAGE.write_text(page(), encoding="utf-8")
    else:
        print(page(), end="")
