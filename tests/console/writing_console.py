"""A console with a language model that knows its programs by heart (`ScriptedWriter`), which a test
holds while it writes: `python writing_console.py [what nl2robot serve takes]`.

Each line on its input is answered by the same on its output: "hold" lets nothing be written beyond
a first line, "go on" does, "idle" waits until nothing is being written.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Callable
from pathlib import Path

from grammar.planning.model.planner import ModelPlanner
from grammar.planning.model.request import Request, Written
from nl2robot.cli.main import main
from nl2robot.language_model.scripted import ScriptedWriter
from nl2robot.translate import planners

TEA = "wheel the tea round to the lobby, would you"
JOKE = "pop round to the lobby and crack a joke"
EITHER = "brighten up the pharmacy with a greeting"
CHEER = "heiter mal die Leute in der Lobby auf"
SPOKEN = "make the people in the lobby happy please"
PROGRAMS = {
    SPOKEN: ['goto("lobby")\nemotion("happy")'],
    TEA: ['goto("lobby")\nsay("Tea!")'],
    JOKE: ['goto("lobby")\nsay("Why did the robot cross the road? It was programmed to.")'],
    EITHER: ['goto("pharmacy")\nsay("Hello!")', 'goto("pharmacy")\nsay("Good morning!")'],
    CHEER: ['goto("lobby")\nemotion("happy")\nsay("Guten Morgen!")'],
}


class Writer(ScriptedWriter):
    """Finds all programs equally likely, and can be waited for."""

    def __init__(self) -> None:
        super().__init__(PROGRAMS)
        self.idle = threading.Event()
        self.idle.set()

    def write(
        self, request: Request, on_text: Callable[[str], None] | None = None
    ) -> list[Written]:
        self.idle.clear()
        try:
            written = super().write(request, on_text)
            return [Written(each.text, -0.1, each.surest, each.tokens) for each in written]
        finally:
            self.idle.set()


def obey(writer: Writer) -> None:
    for line in sys.stdin:
        match line.strip():
            case "hold":
                writer.held.set()
            case "go on":
                writer.held.clear()
            case "idle":
                writer.idle.wait()
        print(line, end="", flush=True)


if __name__ == "__main__":
    writer = Writer()
    planners.PLANNERS["model"] = lambda: ModelPlanner(writer)
    planners.installed_model = lambda: Path("scripted")  # type: ignore[assignment]
    threading.Thread(target=obey, args=(writer,), daemon=True).start()
    sys.exit(main(["serve", *sys.argv[1:]]))
