"""What a line that somebody is typing may become: sentences that can be said here, and names."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

from grammar.language import load_language, spoken_name
from grammar.naming import the

if TYPE_CHECKING:
    from sim.world.model import World

_WORDS: Final = 3
"""How many words before a name tell best what kind of name stands there."""


@dataclass(frozen=True)
class Named:
    """Somebody or something that a line may be about."""

    kind: str
    name: str
    """As it is said in the language."""
    in_sentence: str
    """With its article, where it has one: "the pharmacy"."""
    also: bool = False
    """Whether it has another name that is said first."""


def names_said(world: World, language: str) -> list[str]:
    """The names of places, people and things as they are said in a language."""
    return list(dict.fromkeys(said for _, _, said in _said(world, language, True)))


def named_here(world: World, language: str) -> list[Named]:
    """The same, each with what it is and how it stands in a sentence."""
    pack = load_language(language)
    aliases_first = bool(pack.speech.get("aliases_first"))
    found: dict[tuple[str, str], Named] = {}
    for kind, number, said in _said(world, language, aliases_first):
        told = said
        if kind != "people":
            told = the(said, pack) if aliases_first else spoken_name(said, pack)
        found.setdefault((kind, said), Named(kind, said, told, number > 0))
    return list(found.values())


def _said(world: World, language: str, aliases_first: bool) -> Iterator[tuple[str, int, str]]:
    """What each is, the how-manieth of its names it is, and the name."""
    for kind in ("places", "people", "objects", "furniture"):
        for each in getattr(world, kind):
            also = each.aliases.get(language, ())
            named = (*also, each.name) if aliases_first else (each.name, *also)
            yield from ((kind, number, said) for number, said in enumerate(named))


def completions(
    line: str,
    sentences: Iterable[str],
    names: Sequence[Named],
    joined_up: Callable[[str], str] = str,
) -> list[str]:
    """What a line may become: sentences that begin like it, and names that begin with its last
    words ("go to the ph" -> "go to the pharmacy"), or behind a blank those of the kind that stand
    behind such words. An empty line becomes the first word of a sentence. `joined_up` runs the
    little words of the language together: what would change the line is left out ("à le")."""
    begun = line.lstrip()
    known = list(sentences)
    if not begun:
        return sorted({sentence.split()[0] for sentence in known if sentence.strip()})
    found = {each: None for each in known if _begins(each, begun)}
    starts = [at for at in range(len(line)) if at == 0 or line[at - 1] in " '’"]
    for start in starts:  # of several names the one with most words in common
        last = line[start:]
        named = [each.name for each in names if last.strip() and _begins(each.name, last)]
        if named:
            found |= {line[:start] + name: None for name in named}
            break
    else:
        if line[-1] in " '’":
            fitting = _fitting(begun, known, names)
            found |= {
                line + name: None for name in fitting if joined_up(line + name).endswith(name)
            }
    return [each for each in found if each != line]


def _fitting(begun: str, sentences: Sequence[str], names: Sequence[Named]) -> list[str]:
    """The names that may stand behind these words, as they would be written there: of the kind, and
    with the article, of those that stand behind the same words in a sentence that can be said."""
    words = begun.split()
    for count in range(min(_WORDS, len(words)), 0, -1):
        before = f" {' '.join(words[-count:])} "
        behind = [f" {each}".partition(before)[2] for each in sentences if _has(f" {each}", before)]
        bare = {_form(each) for each in names for rest in behind if _is(rest, each.name)}
        told = {each.kind for each in names for rest in behind if _is(rest, each.in_sentence)}
        if bare or told:
            return [
                each.in_sentence if each.kind in told else each.name
                for each in names
                if not each.also and (each.kind in told or _form(each) in bare)
            ]
    return []


def _form(named: Named) -> tuple[str, str]:
    """What a name is, and the article that it goes with: "zur" goes before "Apotheke" only."""
    return named.kind, named.in_sentence.removesuffix(named.name)


def _is(rest: str, name: str) -> bool:
    """Whether words begin with just this name."""
    return _begins(rest, name) and not rest[len(name) : len(name) + 1].isalnum()


def _has(text: str, words: str) -> bool:
    return words.casefold() in text.casefold()


def _begins(text: str, start: str) -> bool:
    return text.casefold().startswith(start.casefold())
