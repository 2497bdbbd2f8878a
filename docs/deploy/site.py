"""What `mkdocs build` asks of us (`hooks` in mkdocs.yml): links to where the project is, and the
languages.

On the site there is no `../grammar/README.md`. Such a link leads to the project's own page, where
`$NL2ROBOT_REPOSITORY` says that there is one; else its words stand there alone.

`de/console.md` is `console.md` in German. Which languages there are says `extra.alternate` in
mkdocs.yml; the section of `nav` that is called like a language has the pages of it.
"""

from __future__ import annotations

import posixpath
import re
from copy import copy
from itertools import pairwise
from typing import Any

_LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(((?:\.\./)+[^)\s]+)\)")


def on_config(config: Any) -> Any:
    """Where nobody says where the project is, no page can be edited there."""
    if not config.repo_url:
        config.edit_uri = None
    for language in config.extra["alternate"]:
        language["folder"] = language["link"].removeprefix("./")
    return config


def on_nav(nav: Any, *, config: Any, files: Any) -> Any:
    """Nobody reads on from the last page of a language to the first of another."""
    for page, following in pairwise(nav.pages):
        if _language(page, config) is not _language(following, config):
            page.next_page = following.previous_page = None
    return nav


def on_page_markdown(markdown: str, *, page: Any, config: Any, files: Any) -> str:
    """The page with its links out of the docs followed or taken away."""

    def elsewhere(link: re.Match[str]) -> str:
        words, target = link.groups()
        path = posixpath.normpath(posixpath.join("docs", page.file.src_uri, "..", target))
        if path.startswith("docs/"):
            return link.group()
        return f"[{words}]({config.repo_url}/blob/main/{path})" if config.repo_url else words

    return _LINK.sub(elsewhere, markdown)


def on_page_context(context: Any, *, page: Any, config: Any, nav: Any) -> Any:
    """The page among those of its language, in a frame that speaks it. Whoever chooses another
    comes to the same page there, or to the first where that language does not have it."""
    languages = config.extra["alternate"]
    own = _language(page, config)
    pages = {each.file.src_uri: each for each in nav.pages}
    name = page.file.src_uri.removeprefix(own["folder"])
    for language in languages:
        first = pages[f"{language['folder']}index.md"]
        language["link"] = pages.get(language["folder"] + name, first).url
    config.theme["language"] = own["lang"]

    shown = copy(nav)
    shown.homepage = pages[f"{own['folder']}index.md"]
    names = [language["name"] for language in languages]
    section = next((each for each in nav.items if each.title == own["name"]), None)
    rest = [each for each in nav.items if each.title not in names]
    shown.items = section.children if section else rest
    return {**context, "nav": shown}


def _language(page: Any, config: Any) -> Any:
    """The language of a page, by its folder; that of the first, if it is in no language's."""
    first, *others = config.extra["alternate"]
    return next((o for o in others if page.file.src_uri.startswith(o["folder"])), first)
