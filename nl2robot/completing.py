"""What a line that somebody is typing may become: sentences that can be said here, and names."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from sim.world import World


def names_said(world: World, language: str) -> list[str]:
    """The names of places, people and things as they are said in a language."""
    kinds = (world.places, world.people, world.objects, world.furniture)
    named = ((each.name, each.aliases) for kind in kinds for each in kind)
    return list(
        dict.fromkeys(said for name, also in named for said in (*also.get(language, ()), name))
    )


def completions(line: str, sentences: Iterable[str], names: Iterable[str]) -> list[str]:
    """What a line may become: sentences that begin like it, and names that begin with its last
    words ("go to the ph" -> "go to the pharmacy"). An empty line becomes the first word of one."""
    begun = line.lstrip()
    if not begun:
        return sorted({sentence.split()[0] for sentence in sentences if sentence.strip()})
    found = {each: None for each in sentences if _begins(each, begun)}
    starts = [at for at in range(len(line)) if at == 0 or line[at - 1] in " '’"]
    for start in starts:  # of several names the one with most words in common
        last = line[start:]
        named = [name for name in names if last.strip() and _begins(name, last)]
        if named:
            found |= {line[:start] + name: None for name in named}
            break
    return [each for each in found if each != line]


def _begins(text: str, start: str) -> bool:
    return text.casefold().startswith(start.casefold())
