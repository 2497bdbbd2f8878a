"""Teach a language model from the corpus.

    python -m nl2robot.training.planner.train MODEL.gguf INSTALLED_FOLDER OUT [--steps 540]

Needs torch (`pip install torch`), and some hours: it may be interrupted at any time and goes on
from what it has written to OUT last. The result, OUT/learned.npz, is what `nl2robot` carries in
its data.
"""

from __future__ import annotations

import argparse
import json
import math
import random
import time
from collections.abc import Iterator, Sequence
from itertools import count
from pathlib import Path
from typing import Final

import torch
from torch.nn import functional

from nl2robot.language_model.changes import read, write
from nl2robot.language_model.files import TOKENS
from nl2robot.language_model.tokens import Tokens
from nl2robot.training.planner.corpus import Item, files, load
from nl2robot.training.planner.examples import Example, example, is_held_out, learned
from nl2robot.training.planner.network import Network, Row

AT_ONCE: Final = 448
"""Tokens that are read in one step."""
FASTEST: Final = 4e-4
"""The learning rate at its highest."""
WARM: Final = 0.04
"""The share of all steps in which it rises."""
LEARNED: Final = "learned.npz"
SAVED_EVERY: Final = 20
"""Steps."""


def batches(examples: Sequence[Example], chance: random.Random) -> Iterator[list[Example]]:
    """Examples together of `AT_ONCE` tokens at most."""
    shuffled = list(examples)
    chance.shuffle(shuffled)
    batch: list[Example] = []
    for each in shuffled:
        size = sum(len(other.prompt) + len(other.program) for other in [*batch, each])
        if batch and size > AT_ONCE:
            yield batch
            batch = []
        batch.append(each)
    if batch:
        yield batch


def loss_of(network: Network, batch: Sequence[Example], number: dict[int, int]) -> torch.Tensor:
    """How unlikely the programs are to the network, a token on average."""
    tokens: list[int] = []
    wanted: list[int] = []
    right: list[int] = []
    for each in batch:
        first = len(tokens) + len(each.prompt) - 1
        wanted += range(first, first + len(each.program))
        right += (number[token] for token in each.program)
        tokens += [*each.prompt, *each.program[:-1]]
    lengths = tuple(len(each.prompt) + len(each.program) - 1 for each in batch)
    scores = network(Row(torch.tensor(tokens), lengths), torch.tensor(wanted))
    return functional.cross_entropy(scores, torch.tensor(right))


def rate(step: int, steps: int) -> float:
    """Rising, then falling to nothing (a cosine)."""
    warm = max(1, int(WARM * steps))
    if step < warm:
        return FASTEST * (step + 1) / warm
    return FASTEST * 0.5 * (1 + math.cos(math.pi * (step - warm) / max(1, steps - warm)))


def planned(items: Sequence[Item], tokens: Tokens, steps: int) -> Iterator[list[Example]]:
    """The batches of so many steps: one pass over the corpus after the other."""
    for epoch in count():
        for batch in batches(list(learned(items, tokens, epoch)), random.Random(epoch)):
            yield batch
            if not (steps := steps - 1):
                return


def train(gguf: Path, installed: Path, out: Path, steps: int, begin: Path | None) -> None:
    out.mkdir(parents=True, exist_ok=True)
    torch.manual_seed(0)
    tokens = Tokens.load(installed / TOKENS)
    number = {token: place for place, token in enumerate(tokens.written)}
    items = list(load(files()))
    plan = list(planned(items, tokens, steps))
    unseen = [example(item, tokens) for item in items if is_held_out(item)]
    chance = random.Random(1)
    unseen = chance.sample(unseen, min(120, len(unseen)))
    network = Network(gguf, tokens.written)
    optimiser = torch.optim.AdamW(network.changes(), lr=FASTEST, weight_decay=0.01)
    state, begun = out / "state.pt", 0
    if state.exists():
        kept = torch.load(state)
        network.restore(kept["learned"])
        optimiser.load_state_dict(kept["optimiser"])
        begun = kept["step"]
    elif begin is not None:
        network.restore(read(begin))
    print(f"{len(plan)} steps, from {begun} on; {len(network.changes())} changes", flush=True)
    started, done = time.time(), 0
    for step in range(begun, len(plan)):
        for group in optimiser.param_groups:
            group["lr"] = rate(step, len(plan))
        loss = loss_of(network, plan[step], number)
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.changes(), 1.0)
        optimiser.step()
        done += sum(len(each.prompt) + len(each.program) for each in plan[step])
        if step % 5 == 0:
            speed = done / (time.time() - started)
            print(f"step {step} loss {loss.item():.3f} {speed:.1f} tokens/s", flush=True)
        if (step + 1) % SAVED_EVERY == 0 or step + 1 == len(plan):
            _save(network, optimiser, step + 1, state)
        if (step + 1) % (8 * SAVED_EVERY) == 0 or step + 1 == len(plan):
            told = {"step": step + 1, "held_out": _measured(network, unseen, number)}
            with (out / "course.jsonl").open("a") as course:
                course.write(json.dumps(told) + "\n")
            print(told, flush=True)
            write({key: each.numpy() for key, each in network.learned().items()}, out / LEARNED)


def _measured(network: Network, unseen: Sequence[Example], number: dict[int, int]) -> float:
    with torch.no_grad():
        losses = [
            loss_of(network, batch, number).item() for batch in batches(unseen, random.Random(0))
        ]
    return round(sum(losses) / len(losses), 4)


def _save(network: Network, optimiser: torch.optim.Optimizer, step: int, state: Path) -> None:
    kept = {"learned": network.learned(), "optimiser": optimiser.state_dict(), "step": step}
    new = state.with_suffix(".new")
    torch.save(kept, new)
    new.replace(state)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("gguf", type=Path)
    parser.add_argument("installed", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--steps", type=int, default=540, help="540 are about one pass")
    parser.add_argument("--begin", type=Path, help="go on from what was learned before")
    given = parser.parse_args()
    train(given.gguf, given.installed, given.out, given.steps, given.begin)


if __name__ == "__main__":
    main()
