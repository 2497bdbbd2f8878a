"""A program's lines as HTML, its words marked by what they are."""

from __future__ import annotations

from markupsafe import Markup

from nl2robot.plain import visible
from sandbox.source import unix_newlines


def highlighted(program: str) -> list[Markup]:
    """Each line, with the classes of Pygments around its words (`static/console.css` has their
    colours). Any text will do; signs that would hide or turn others are made visible."""
    from pygments import highlight
    from pygments.formatters import HtmlFormatter
    from pygments.lexers import PythonLexer

    source = visible(unix_newlines(program)).rstrip("\n")
    lexer = PythonLexer(stripnl=False, ensurenl=False)
    written: str = highlight(source, lexer, HtmlFormatter(nowrap=True))
    return [Markup(line) for line in written.rstrip("\n").split("\n")]
