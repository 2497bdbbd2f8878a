"""The pages for those who work with the robot, in German and French: they stand side by side, call
every button as the console does, and what they say can be said is understood."""

from __future__ import annotations

import re
import runpy
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.translate.routines import Routines
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
QUOTED = {"de": "„(.+?)“", "fr": "« (.+?) »"}
PAGES = [page for language in QUOTED for page in sorted((DOCS / language).rglob("*.md"))]
NAMES = sorted({page.relative_to(DOCS).as_posix().partition("/")[2] for page in PAGES})
SENTENCES = "talking.md"
"""Has its own list of what can be said (tests/grammar/test_docs.py)."""
on_page = pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(DOCS)))


def language_of(page: Path) -> str:
    return page.relative_to(DOCS).parts[0]


def prose(page: Path) -> str:
    """What is read of a page, without code, in one line."""
    text = re.sub(r"```.*?```|`[^`\n]*`", "", page.read_text("utf-8"), flags=re.S)
    return re.sub(r"\s+", " ", text.replace("’", "'"))


@pytest.mark.parametrize("name", NAMES)
def test_a_page_is_there_in_every_language_part_by_part(name: str) -> None:
    assert (DOCS / name).exists()
    german, french = ((DOCS / language / name).read_text("utf-8") for language in QUOTED)
    for part in (r"^#+(?= )", r"^```\w*", r"^\|", r"^!\["):
        assert re.findall(part, german, re.M) == re.findall(part, french, re.M)


@on_page
def test_a_page_calls_things_as_the_console_does(page: Path) -> None:
    """In bold is what one presses or looks for, in italics what the console tells."""
    shown = {
        text[language_of(page)].replace("’", "'")
        for file in (ROOT / "nl2robot/console/texts").glob("*.yaml")
        for text in yaml.safe_load(file.read_text("utf-8")).values()
    }
    named = {name for _, name in re.findall(r"(\*\*?)([^*]+)\1", prose(page))}
    assert named <= shown, named - shown


@on_page
def test_what_a_page_says_can_be_said_is_understood(page: Path, tmp_path: Path) -> None:
    """From top to bottom, by one who has the conversations of its blocks first."""
    knowledge = Knowledge(load_world(DEFAULT_WORLD), routines=Routines(tmp_path / "routines.yaml"))
    language, talk = language_of(page), Talk()
    text = page.read_text("utf-8")
    talks = "".join(re.findall(r"^```text\n(.*?)^```$", text, re.M | re.S))
    for said, told in re.findall(r"\w+: (.+)\n\w+: (.+)\n", talks):
        assert translate(said, knowledge, language, "grammar", talk).message == told
    if page.name == SENTENCES:
        return
    for said in re.findall(QUOTED[language], prose(page)):
        answer = translate(said, knowledge, language, "grammar", talk)
        assert answer.status != "rejected", f"{said}: {answer.message}"


def test_a_reader_finds_the_same_page_in_another_language_among_those_of_that_language() -> None:
    site = SimpleNamespace(**runpy.run_path(str(DOCS / "deploy/site.py")))
    languages = [
        {"name": "English", "lang": "en", "link": "./"},
        {"name": "Deutsch", "lang": "de", "link": "./de/"},
    ]
    config = SimpleNamespace(repo_url="", theme={}, extra={"alternate": languages})
    files = ("index.md", "console.md", "hotword.md", "de/index.md", "de/console.md")
    front, console, hotword, german_front, german = pages = [
        SimpleNamespace(file=SimpleNamespace(src_uri=file), url=f"/{file}", title="")
        for file in files
    ]
    section = SimpleNamespace(title="Deutsch", children=[german_front, german])
    nav = SimpleNamespace(items=[front, console, hotword, section], pages=pages, homepage=front)

    def looked_at(page: SimpleNamespace) -> tuple[list[str], SimpleNamespace]:
        context = site.on_page_context({}, page=page, config=config, nav=nav)
        return [each["link"] for each in languages], context["nav"]

    site.on_config(config)
    links, shown = looked_at(console)
    assert links == ["/console.md", "/de/console.md"] and config.theme["language"] == "en"
    assert shown.items == [front, console, hotword] and shown.homepage is front
    links, shown = looked_at(german)
    assert links == ["/console.md", "/de/console.md"] and config.theme["language"] == "de"
    assert shown.items == section.children and shown.homepage is german_front
    assert looked_at(hotword)[0] == ["/hotword.md", "/de/index.md"]

    site.on_nav(nav, config=config, files=None)
    assert hotword.next_page is None and german_front.previous_page is None
