"""Put what was learned where the package carries it, with its card: from what data, by which
recipe, how good, how long it took, under which licence."""

from __future__ import annotations

import hashlib
import shutil
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any, Final

import msgspec
import yaml

from nl2robot.errors import UserError
from nl2robot.language_model.changes import SCALE
from nl2robot.language_model.habits import FILE as HABITS
from nl2robot.models.sources import load_registry
from nl2robot.training.planner.corpus import Item, digest, files, load
from nl2robot.training.planner.course import Course
from nl2robot.training.planner.evaluate import Row, rows_of, scores
from nl2robot.training.planner.example import Examples
from nl2robot.training.planner.examples import is_held_out
from nl2robot.training.planner.habits import habits_of, share_guessed
from nl2robot.training.planner.recipe import RECIPE, Kept

FOLDER: Final = HABITS.parent
LARGEST: Final = 40_000_000
"""Bytes that what was learned may have: it comes with every installation."""
LICENCE: Final = "Apache-2.0"
TRIED: Final = 60
"""Held-out programs in which habits are tried."""


def export(model: str, kept: Kept, tell: Callable[[str], None], folder: Path = FOLDER) -> Path:
    """Raises `UserError` if there is nothing whole to put there."""
    course = Course.load(kept.course)
    examples = Examples.load(kept.examples)
    if examples.corpus != digest():
        raise UserError(
            "The corpus has changed since this was learned, and the card would not be true. Run"
            " `python -m nl2robot.training.planner train` with another --out first."
        )
    size = kept.learned.stat().st_size
    if size > LARGEST:
        raise UserError(
            f"What was learned has {size / 1e6:.0f} MB, and may have {LARGEST / 1e6:.0f}: learn"
            " changes of a lower rank (nl2robot/training/planner/recipe.py)."
        )
    rows = rows_of(kept.evaluated, file_digest(kept.learned))
    if not rows:
        tell("Nobody has measured it: the card will say so. Run `evaluate`, then `export` again.")
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copyfile(kept.learned, folder / f"{model}.npz")
    habits = habits_of(examples.passes[0], examples.passes[0][0].program[-1])
    (folder / HABITS.name).write_bytes(msgspec.msgpack.encode(habits))
    guessed = share_guessed(habits, examples.unseen[:TRIED])
    written = card(model, folder / f"{model}.npz", course, list(load(files())), rows)
    path = card_file(model, folder)
    path.write_text(as_text(written), "utf-8")
    tell(
        f"{model}.npz ({size / 1e6:.1f} MB), {len(habits)} habits ({guessed:.0%} of tokens guessed"
        f" right) and the card {path.name} are in {folder}. Now fit what its probabilities mean:"
        f" `python -m nl2robot.training.planner.calibrate {kept.evaluated}`."
    )
    return path


def card_file(model: str, folder: Path = FOLDER) -> Path:
    return folder / f"{model}.card.yaml"


def file_digest(file: Path) -> str:
    """SHA-256."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def card(
    model: str, learned: Path, course: Course, items: list[Item], rows: list[Row]
) -> dict[str, Any]:
    source = load_registry()[model].sources[0]
    seen = [item for item in items if not is_held_out(item)]
    recipe = msgspec.to_builtins(RECIPE)
    return {
        "model": model,
        "file": {
            "name": learned.name,
            "bytes": learned.stat().st_size,
            "sha256": file_digest(learned),
        },
        "licence": LICENCE,
        "base": {
            "sha256": getattr(source, "sha256", None),
            "licence": getattr(source, "licence", None),
        },
        "corpus": {
            "sha256": digest(),
            "learned": dict(Counter(item.language for item in seen)) | {"all": len(seen)},
            "held_out": len(items) - len(seen),
        },
        "recipe": {
            **recipe,
            "alpha": recipe["rank"] * SCALE,
            "steps": course.steps,
        },
        "times": {"hours": round(course.seconds / 3600, 2), "on": course.device},
        "course": msgspec.to_builtins(course.measured),
        "scores": _scores(rows),
    }


def _scores(rows: list[Row]) -> dict[str, Any] | str:
    if not rows:
        return "not measured"
    return {
        "what": "held-out sentences of the corpus; right is what does event by event what the"
        " author's program does",
        "sentences": len(rows),
        "by_language": msgspec.to_builtins(scores(rows, "language")),
        "by_group": msgspec.to_builtins(scores(rows, "group")),
    }


def as_text(written: dict[str, Any]) -> str:
    head = (
        "# What is known of the changes beside it: `python -m nl2robot.training.planner export`"
        " writes it.\n"
    )
    text: str = yaml.safe_dump(written, sort_keys=False, allow_unicode=True, width=120)
    return head + text
