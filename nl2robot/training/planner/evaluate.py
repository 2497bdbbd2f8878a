"""How good the language model is on sentences that it has not learned from.

Each held-out sentence of the corpus is planned as `nl2robot translate` would have the model do it,
and what the program does in a few scenes is compared with what the program of the corpus does
there: what is right in another way counts as something else (of 47 of them that somebody has read,
nine were).
"""

from __future__ import annotations

import json
import math
import re
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import msgspec

from grammar.normal import normal
from grammar.planning.model.expansion import expanded
from grammar.planning.model.prompt import vocabulary
from grammar.planning.model.recogniser import CLARIFY, REFUSE
from grammar.planning.planner import Answer, Draft, Drafts, Planner, Refusal, Watch
from grammar.planning.turn import Turn
from grammar.program_parser import NotAPlan
from nl2robot.deliberation.confidence import features
from nl2robot.deliberation.considering import consider
from nl2robot.deliberation.voting import count, same
from nl2robot.errors import UserError
from nl2robot.training.planner.corpus import Item, knowledge
from nl2robot.training.planner.course import OFTEN, lasting

Row = dict[str, Any]
"""What became of a sentence."""

GROUPS: Final = ("single calls", "errands", "programs", "to be refused or asked back")
_CONTROL: Final = re.compile(r"^\s*(if|for|while|try)\b", re.MULTILINE)


def group(do: str) -> str:
    """What kind of order it is, by its program in the dialect: a call, several in a row, one with
    conditions or rounds, or one of the two ways out."""
    if do.startswith((f"{REFUSE}(", f"{CLARIFY}(")):
        return GROUPS[3]
    if _CONTROL.search(do):
        return GROUPS[2]
    return GROUPS[1] if "\n" in do else GROUPS[0]


def measure(
    items: Sequence[Item],
    planner: Planner,
    out: Path,
    of: str = "",
    tell: Callable[[str], None] = print,
) -> list[Row]:
    """What became of each of these; of what `out` holds already nothing is done again, unless it
    is `of` something else, such as what was learned before. Where the model could not think to the
    end, which says something of the machine and nothing of the model, there is no row. Raises
    `UserError` if there is none at all."""
    kept = (
        [json.loads(line) for line in out.read_text("utf-8").splitlines()] if out.exists() else []
    )
    by_place = {row["where"]: row for row in kept if row.get("of", "") == of}
    todo = [item for item in items if item.where not in by_place]
    begun = told = time.monotonic()
    why_not, absent = "", 0
    with out.open("a", encoding="utf-8") as written:
        for number, item in enumerate(todo):
            now = time.monotonic()
            if number and now - told > OFTEN:
                left = lasting((now - begun) / number * (len(todo) - number))
                tell(f"{len(items) - len(todo) + number} of {len(items)} sentences, {left} left.")
                told = now
            answer = planner.plan(item.turn, Watch())
            seconds = round(time.monotonic() - now, 2)
            if isinstance(answer, Refusal) and answer.absent:
                why_not, absent = answer.message, absent + 1
                continue
            row = by_place[item.where] = {
                "where": item.where,
                "language": item.language,
                "group": group(item.do),
                **_outcome(item, answer),
                "seconds": seconds,
                "of": of,
            }
            written.write(json.dumps(row, ensure_ascii=False) + "\n")
            written.flush()
    if absent == len(items):
        raise UserError(f"The model answered nothing: {why_not}")
    if absent:
        tell(
            f"{absent} sentences got no answer ({why_not}) They are not counted; say the same again"
            " when this machine has less to do."
        )
    return [by_place[item.where] for item in items if item.where in by_place]


def rows_of(file: Path, of: str) -> list[Row]:
    """What is kept in a file of what became of sentences, `of` this."""
    if not file.exists():
        return []
    rows = map(json.loads, file.read_text("utf-8").splitlines())
    return [row for row in rows if row["of"] == of]


def _outcome(item: Item, answer: Answer) -> Row:
    turn = item.turn
    wanted = _wanted(item, turn)
    told: Row = {"say": item.say, "wanted": item.do, "way_out": wanted is None}
    if not isinstance(answer, Drafts):
        return {**told, "outcome": type(answer).__name__.lower(), "message": str(answer)}
    told["drafts"] = [each.context.written for each in answer.drafts]
    votes = count(turn, answer.drafts, knowledge(item.world))
    if not votes.votes:
        objections = [
            f"{each.kind}: {each.about}" for it in votes.dropped for each in it.checked.objections
        ]
        return {**told, "outcome": "dropped", "objections": objections}
    right = [wanted is not None and _does(turn, vote.first.draft, wanted) for vote in votes.votes]
    return {
        **told,
        "outcome": "drafts",
        "right": right,
        "shares": [round(each.share, 4) for each in votes.votes],
        "features": features(turn, votes.votes[0], votes),
    }


def _wanted(item: Item, turn: Turn) -> Draft | None:
    """The program of the corpus as a draft; None for a way out."""
    try:
        plan = normal(expanded(item.do, vocabulary(turn).people, turn.lexicon, turn.language))
    except NotAPlan:
        return None
    return Draft(plan, "corpus", 1.0, turn.context)


def _does(turn: Turn, draft: Draft, wanted: Draft) -> bool:
    """Whether a draft does what was wanted."""
    one, other = consider(turn, draft), consider(turn, wanted)
    return one is not None and other is not None and same(turn, one, other)


# --- scores


class Score(msgspec.Struct, frozen=True):
    """Of sentences of a language or a group."""

    orders: int
    """Sentences that are to become a program."""
    right: int
    """Of the orders: they do event by event what the author's program does."""
    something_else: int
    nothing: int
    """Orders that became no program: refused, asked back, or dropped by the check."""
    ways_out: int
    """Sentences that are to be refused or asked back."""
    kept_back: int
    """Of those: they became no program."""
    seconds_median: float
    seconds_p95: float


def scores(rows: Sequence[Row], by: str) -> dict[str, Score]:
    """For each value of a key, such as "language", and of all."""
    values = sorted({row[by] for row in rows}, key=_place)
    return {
        **{value: _score([row for row in rows if row[by] == value]) for value in values},
        "all": _score(rows),
    }


def _place(value: str) -> tuple[int, str]:
    return (GROUPS.index(value) if value in GROUPS else 0), value


def _score(rows: Sequence[Row]) -> Score:
    orders = [row for row in rows if not row["way_out"]]
    drafted = [row for row in orders if row["outcome"] == "drafts"]
    ways_out = [row for row in rows if row["way_out"]]
    right = sum(row["right"][0] for row in drafted)
    seconds = sorted(row["seconds"] for row in rows)
    return Score(
        orders=len(orders),
        right=right,
        something_else=len(drafted) - right,
        nothing=len(orders) - len(drafted),
        ways_out=len(ways_out),
        kept_back=sum(row["outcome"] != "drafts" for row in ways_out),
        seconds_median=seconds[len(seconds) // 2],
        seconds_p95=seconds[math.ceil(0.95 * len(seconds)) - 1],
    )


def table(scored: dict[str, Score]) -> Iterator[str]:
    """In Markdown."""
    yield "| | orders | right | something else | nothing | refused or asked back | median, p95 |"
    yield "|---|---:|---:|---:|---:|---:|---:|"
    for name, each in scored.items():
        share = f"{each.right} ({each.right / each.orders:.0%})" if each.orders else ""
        out = f"{each.kept_back} of {each.ways_out}" if each.ways_out else ""
        numbers = (share, each.something_else, each.nothing) if each.orders else ("", "", "")
        yield (
            f"| {name} | {each.orders or ''} | "
            + " | ".join(map(str, numbers))
            + f" | {out} | {each.seconds_median:.1f} s, {each.seconds_p95:.1f} s |"
        )
