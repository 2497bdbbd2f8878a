"""No page names what is not there: commands, options, settings, files. Python is Python."""

from __future__ import annotations

import argparse
import re
import shlex
from collections.abc import Iterator
from pathlib import Path

import pytest

from nl2robot import environment
from nl2robot.cli.main import COMMANDS, parser_of
from tests.played import commands

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
FILES = [*DOCS.rglob("*.md"), *ROOT.glob("*.md")]
PAGES = sorted(file for file in FILES if "node_modules" not in file.parts)
BLOCK = re.compile(r"^```([^\n`]*)\n(.*?)^```$", re.M | re.S)
OURS = re.compile(rf"(?:^|[/\s])nl2robot ({'|'.join(COMMANDS)})\b(.*)")
EACH = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.relative_to(ROOT).as_posix())


def calls(line: str) -> Iterator[list[str]]:
    """The words of each command of a line of a shell."""
    words = shlex.shlex(line, posix=True, punctuation_chars=True)
    words.whitespace_split = True
    call: list[str] = []
    elsewhere = False  # "> file": where it is written to
    for word in [*words, ";"]:
        if elsewhere:
            elsewhere = False
        elif "<" in word or ">" in word:
            elsewhere = True
            if call and call[-1] in ("1", "2"):
                call.pop()
        elif set(word) <= set(";|&()"):
            yield call
            call = []
        else:
            call.append(word)


@EACH
def test_what_is_to_be_typed_at_a_prompt_is_understood(page: Path) -> None:
    for kind, text in BLOCK.findall(page.read_text("utf-8")):
        if kind != "console":
            continue
        for line, _ in commands(text):
            for program, *words in filter(None, calls(line)):
                if program == "nl2robot":
                    assert words[0] in COMMANDS, f"{line}: there is no {words[0]}"
                    try:
                        parser_of(words[0]).parse_args(words[1:])
                    except SystemExit:
                        pytest.fail(f"{line}: it is not understood")


def named(page: str) -> Iterator[tuple[str, str]]:
    """Each command of ours that a page names, in a block or in its text, and what follows."""
    for _, text in BLOCK.findall(page):
        for line in text.replace("\\\n", " ").splitlines():
            yield from OURS.findall(line.partition(" #")[0])
    for text in re.findall(r"`([^`\n]+)`", BLOCK.sub("", page)):
        yield from OURS.findall(text)
        yield from re.findall(rf"^({'|'.join(COMMANDS)}) (--.*)", text)


def options_of(parser: argparse.ArgumentParser) -> set[str]:
    """Those of a command, and of the commands in it."""
    found: set[str] = set()
    for action in parser._actions:
        found |= set(action.option_strings)
        if isinstance(action, argparse._SubParsersAction):
            found |= {name for inner in action.choices.values() for name in options_of(inner)}
    return found


@EACH
def test_no_option_is_named_that_is_gone(page: Path) -> None:
    for command, rest in named(page.read_text("utf-8")):
        ours = re.split(r"\s[|;&]", re.sub(r'"[^"]*"', "", rest))[0]
        for option in re.findall(r"(?:^|\s)(--?[a-z][\w-]*)", ours):
            assert option in options_of(parser_of(command)), f"{command} has no {option}"


@EACH
def test_python_is_python(page: Path) -> None:
    for kind, text in BLOCK.findall(page.read_text("utf-8")):
        if kind.split(" ")[0] == "python":
            # As the reference has signatures, they are no statements yet.
            stubs = re.sub(r"^robot\.(\w+\(.*\) -> .*)$", r"def \1: ...", text, flags=re.M)
            compile(stubs, page.name, "exec")


# --- settings, and what is kept -------------------------------------------------------------------

VARIABLES = {**environment.RUNNING, **environment.SERVICE, **environment.DEVELOPING}
SOURCES = [
    *(
        file
        for name in ("nl2robot", "robot_api", "grammar", "sandbox", "sim", "tests")
        for file in (ROOT / name).rglob("*.py")
    ),
    *(file for file in (DOCS / "deploy").iterdir() if file.is_file()),
    ROOT / "mkdocs.yml",
    ROOT / "Makefile",
]


def test_the_page_of_settings_has_every_variable_that_is_used() -> None:
    """After a change of one: `python -m nl2robot.environment --write`."""
    assert environment.PAGE.read_text("utf-8") == environment.page()
    table = Path(environment.__file__)
    text = "".join(file.read_text("utf-8") for file in SOURCES if file != table)
    assert set(re.findall(r"\bNL2ROBOT_[A-Z0-9_]+\b", text)) == set(VARIABLES)


def test_every_file_that_is_kept_is_on_the_page_of_what_is_kept() -> None:
    page = (DOCS / "privacy.md").read_text("utf-8")
    text = "".join(file.read_text("utf-8") for file in (ROOT / "nl2robot").rglob("*.py"))
    kept = set(re.findall(r'data_(?:file\(|folder\(\) / )"([\w.-]+)"', text))
    assert {"runs.sqlite", "accounts.sqlite", "certificates", "pictures", "history"} <= kept
    for name in kept:
        assert f"`{name}`" in page or f"`{name}/`" in page, f"privacy.md does not tell of {name}"
