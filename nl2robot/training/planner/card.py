"""What the corpus holds, as tables in Markdown.  `python -m nl2robot.training.planner.card`

Counted are items by author and language, the constructs of their programs, and near-duplicates:
sentences of the same language of which the words, in any order, are nearly the same.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from typing import Final

from rapidfuzz import fuzz, process

from nl2robot.training.planner.corpus import Item, files, load
from nl2robot.training.planner.examples import is_held_out

CONSTRUCTS: Final[Mapping[str, tuple[str, ...]]] = {
    "refused or asked back": ("refuse(", "clarify("),
    "conditions": ("if ",),
    "rounds": ("for ",),
    "loops with a condition": ("while ",),
    "answers": ("ask(", "touch(", "listen("),
    "records": ("{}", "[]"),
    "times": ("clock()", "minutes_since("),
    "searches": ("find(",),
    "things": ("grab(",),
    "company": ("guide(", "follow("),
}
ALIKE: Final = 92.0
"""Of 100, by rapidfuzz's ratio of their words in the order of the alphabet."""


def card(items: Sequence[Item]) -> Iterator[str]:
    learned = [item for item in items if not is_held_out(item)]
    languages = sorted({item.language for item in items})
    held_out = len(items) - len(learned)
    yield f"{len(items)} items, {len(learned)} to learn from and {held_out} held out."
    yield ""
    yield "| house | author | " + " | ".join(languages) + " |"
    yield "|---|---|" + "---:|" * len(languages)
    houses: dict[str, list[Item]] = defaultdict(list)
    for item in items:
        houses[item.world.removesuffix(".yaml")].append(item)
    for house, mine in sorted(houses.items()):
        said = Counter(item.language for item in mine)
        counts = " | ".join(str(said[code] or "") for code in languages)
        yield f"| {house} | {mine[0].author} | {counts} |"
    yield ""
    yield "| in the program | items |"
    yield "|---|---:|"
    for name, signs in CONSTRUCTS.items():
        yield f"| {name} | {sum(any(sign in item.do for sign in signs) for item in items)} |"
    yield f"| said after something else | {sum(item.after is not None for item in items)} |"
    yield ""
    alike = sum(near_duplicates([i.say for i in items if i.language == code]) for code in languages)
    yield f"{alike} near-duplicates (their sorted words are alike by {ALIKE:.0f} of 100 and more)."


def near_duplicates(sentences: Sequence[str]) -> int:
    """How many of the sentences are nearly the same as one before them."""
    known: dict[str, list[str]] = defaultdict(list)
    alike = 0
    for sentence in sentences:
        words = " ".join(sorted(sentence.lower().split()))
        near = known[words[:1]]
        alike += process.extractOne(words, near, scorer=fuzz.ratio, score_cutoff=ALIKE) is not None
        near.append(words)
    return alike


def main() -> None:
    print(*card(list(load(files()))), sep="\n")


if __name__ == "__main__":
    main()
