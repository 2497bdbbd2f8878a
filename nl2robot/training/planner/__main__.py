"""Teach the language model, measure it, and have the package carry what it learned.

    python -m nl2robot.training.planner train        # goes on where it was interrupted
    python -m nl2robot.training.planner evaluate     # on sentences that it never learned from
    python -m nl2robot.training.planner export       # into nl2robot/data/learned, with its card

Each takes --model (planner-large) and --out (a folder of your data folder). How it learns stands
in recipe.py.
"""

from __future__ import annotations

import argparse
import importlib.util
import random
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from grammar.planning.model.planner import ModelPlanner
from nl2robot.deliberation.sufficing import will_do
from nl2robot.errors import ExitStatus, UserError
from nl2robot.language_model.client import Process
from nl2robot.models.catalogue import LARGE, PLANNER, need
from nl2robot.training.planner.corpus import digest, files, load
from nl2robot.training.planner.course import lasting
from nl2robot.training.planner.evaluate import measure, scores, table
from nl2robot.training.planner.example import Examples
from nl2robot.training.planner.examples import is_held_out, make_examples
from nl2robot.training.planner.export import export, file_digest
from nl2robot.training.planner.recipe import Kept, usual_folder
from nl2robot.translate.planners import learned

TORCH: Final = (
    "Learning needs torch, which is not installed. Run `pip install torch`, then `train` again."
)
RUNTIME: Final = (
    "What runs the language model is not installed. Run `pip install 'nl2robot[planner]'`, then"
    " this again."
)


def main(arguments: Sequence[str] | None = None) -> int:
    parser = argparse.ArgumentParser(
        prog="python -m nl2robot.training.planner",
        description="Teach the language model, measure it, and have the package carry it.",
    )
    parser.add_argument("what", choices=("train", "evaluate", "export"))
    parser.add_argument("--model", choices=(LARGE, PLANNER), default=LARGE)
    parser.add_argument("--out", type=Path, help="where the training is kept")
    parser.add_argument(
        "--most", type=int, help="evaluate: no more held-out sentences than these, by chance"
    )
    given = parser.parse_args(arguments)
    kept = Kept(given.out or usual_folder(given.model))
    try:
        match given.what:
            case "train":
                _train(given.model, kept)
            case "evaluate":
                _evaluate(given.model, kept, given.most)
            case _:
                export(given.model, kept, _tell)
    except UserError as error:
        print(error, file=sys.stderr)
        return error.status
    except KeyboardInterrupt:
        _tell(f"Interrupted. The same command goes on with what is kept in {kept.folder}.")
        return ExitStatus.INTERRUPTED
    return ExitStatus.OK


def _tell(line: str) -> None:
    print(line, flush=True)


def _is_there(library: str) -> bool:
    return importlib.util.find_spec(library) is not None


def _installed(model: str) -> Path:
    """The folder of a model that can be used. Raises `UserError`."""
    folder = need(model)
    if not _is_there("tiktoken"):
        raise UserError(RUNTIME)
    return folder


def _train(model: str, kept: Kept) -> None:
    folder = _installed(model)
    if not _is_there("torch"):
        raise UserError(TORCH)
    kept.folder.mkdir(parents=True, exist_ok=True)
    if not kept.examples.exists():
        _tell("Making the examples from the corpus: that takes some minutes.")
        made = make_examples(folder, kept.examples, _tell)
        _tell(f"{len(made.passes[0])} to learn from, {len(made.unseen)} never learned from.")
    elif Examples.load(kept.examples).corpus != digest():
        raise UserError(
            f"The corpus has changed since {kept.examples} was made from it. Delete that folder, or"
            " name another with --out, to learn from what it is now."
        )
    from nl2robot.training.planner.train import train

    course = train(folder, kept, _tell)
    _tell(
        f"{kept.learned} was learned in {lasting(course.seconds)}. `evaluate` says how good it is,"
        " `export` puts it into the package."
    )


def _evaluate(model: str, kept: Kept, most: int | None) -> None:
    """Of what was learned here, else of what the package carries."""
    folder = _installed(model)
    changes = kept.learned if kept.learned.exists() else learned(model)
    if changes is None:
        raise UserError(
            f"{model} has learned nothing yet. Run `python -m nl2robot.training.planner train"
            f" --model {model}` first."
        )
    kept.folder.mkdir(parents=True, exist_ok=True)
    items = [item for item in load(files()) if is_held_out(item)]
    random.Random(0).shuffle(items)
    _tell(f"{len(items[:most])} of {len(items)} held-out sentences, with {changes}.")
    process = Process(folder, changes)
    try:
        planner = ModelPlanner(process, will_do)
        rows = measure(items[:most], planner, kept.evaluated, file_digest(changes), _tell)
    finally:
        process.close()
    for by in ("language", "group"):
        _tell("\n".join(("", *table(scores(rows, by)))))


if __name__ == "__main__":
    sys.exit(main())
