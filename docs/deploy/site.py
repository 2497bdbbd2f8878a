"""What `mkdocs build` asks of us (`hooks` in mkdocs.yml): links to where the project is.

On the site there is no `../grammar/README.md`. Such a link leads to the project's own page, where
`$NL2ROBOT_REPOSITORY` says that there is one; else its words stand there alone.
"""

from __future__ import annotations

import posixpath
import re
from typing import Any

_LINK = re.compile(r"(?<!!)\[([^\]]+)\]\(((?:\.\./)+[^)\s]+)\)")


def on_config(config: Any) -> Any:
    """Where nobody says where the project is, no page can be edited there."""
    if not config.repo_url:
        config.edit_uri = None
    return config


def on_page_markdown(markdown: str, *, page: Any, config: Any, files: Any) -> str:
    """The page with its links out of the docs followed or taken away."""

    def elsewhere(link: re.Match[str]) -> str:
        words, target = link.groups()
        path = posixpath.normpath(posixpath.join("docs", page.file.src_uri, "..", target))
        if path.startswith("docs/"):
            return link.group()
        return f"[{words}]({config.repo_url}/blob/main/{path})" if config.repo_url else words

    return _LINK.sub(elsewhere, markdown)
