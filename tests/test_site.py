"""The documentation as a site: every page has its place, every link and picture leads somewhere.

`make docs` builds it, and is as strict; this is what of it needs no builder.
"""

from __future__ import annotations

import re
import runpy
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
import yaml

from nl2robot.cli import reference

ROOT = Path(__file__).parents[1]
on_page_markdown = runpy.run_path(str(ROOT / "docs/deploy/site.py"))["on_page_markdown"]
DOCS = ROOT / "docs"
PAGES = sorted(page for page in DOCS.rglob("*.md") if "node_modules" not in page.parts)
FILES = [*PAGES, *ROOT.glob("*.md"), *(ROOT / "grammar").glob("*.md")]


class _Plain(yaml.SafeLoader):
    """Reads `!ENV` as what stands there."""


_Plain.add_constructor("!ENV", lambda loader, node: loader.construct_sequence(node))
SITE = yaml.load((ROOT / "mkdocs.yml").read_text("utf-8"), _Plain)


def named(part: Any) -> Iterator[str]:
    if isinstance(part, str):
        yield part
    else:
        for each in part if isinstance(part, list) else part.values():
            yield from named(each)


def prose(page: Path) -> str:
    return re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text("utf-8"), flags=re.S)


def anchors(page: Path) -> set[str]:
    """As GitHub and the site name them."""
    text = re.sub(r"```.*?```", "", page.read_text("utf-8"), flags=re.S)
    heads = re.findall(r"^#+ (.+)$", text, re.M)
    plain = (re.sub(r"[^\w\- ]", "", head.lower().replace("`", "")) for head in heads)
    return {head.strip().replace(" ", "-") for head in plain}


def test_every_page_is_in_the_order_of_the_site() -> None:
    assert sorted(named(SITE["nav"])) == sorted(page.relative_to(DOCS).as_posix() for page in PAGES)


@pytest.mark.parametrize("page", FILES, ids=lambda page: page.relative_to(ROOT).as_posix())
def test_every_link_and_picture_leads_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)\s]+)\)", prose(page)):
        if re.match(r"[a-z]+:", target):
            continue
        path, _, anchor = target.partition("#")
        there = (page.parent / path).resolve() if path else page
        assert there.exists(), f"{page.name} leads to {target}"
        if anchor and there.suffix == ".md":
            assert anchor in anchors(there), f"{page.name} leads to {target}"


@pytest.mark.parametrize(
    ("repository", "written"),
    [
        ("https://example.org/r", "See [roles](https://example.org/r/blob/main/robot_api/x.py)."),
        ("", "See roles."),
    ],
)
def test_links_out_of_the_docs_lead_to_the_project_or_nowhere(
    repository: str, written: str
) -> None:
    page = SimpleNamespace(file=SimpleNamespace(src_uri="building.md"))
    config = SimpleNamespace(repo_url=repository)
    given = "See [roles](../robot_api/x.py)."
    assert on_page_markdown(given, page=page, config=config, files=None) == written
    inner = SimpleNamespace(file=SimpleNamespace(src_uri="robots/pepper.md"))
    stays = "The [face](../face.md)."
    assert on_page_markdown(stays, page=inner, config=config, files=None) == stays


def test_the_page_of_the_command_line_is_made_from_the_commands() -> None:
    """After a change of one: `python -m nl2robot.cli.reference --write`."""
    assert reference.PAGE.read_text("utf-8") == reference.page()
