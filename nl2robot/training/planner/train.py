"""Teach a language model from examples.

    python -m nl2robot.training.planner.train MODEL.gguf EXAMPLES.msgpack OUT

The examples are written by `nl2robot.training.planner.examples`. Needs torch (`pip install
torch`), and on two cores hours for each pass; it may be interrupted at any time and goes on from
what it has written to OUT last. On a GPU a pass takes a minute. The result, OUT/learned.npz, is
what `nl2robot` carries in its data.
"""

from __future__ import annotations

import argparse
import json
import math
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final

import torch
from torch.nn import functional

from nl2robot.language_model.changes import write
from nl2robot.training.planner.example import Example, Examples
from nl2robot.training.planner.network import RANK, Network, Row

AT_ONCE: Final = 4096
"""Tokens that are read for one step."""
FASTEST: Final = 8e-4
"""The learning rate at its highest."""
WARM: Final = 0.05
"""The share of all steps in which it rises."""
LEARNED: Final = "learned.npz"
SAVED_EVERY: Final = 600.0
"""Seconds."""


def batches(examples: Sequence[Example], at_once: int) -> Iterator[list[Example]]:
    """Examples together of `at_once` tokens at most, in their order."""
    batch: list[Example] = []
    for each in examples:
        if batch and sum(map(len, [*batch, each])) > at_once:
            yield batch
            batch = []
        batch.append(each)
    if batch:
        yield batch


def scores_of(
    network: Network, batch: Sequence[Example], number: dict[int, int]
) -> tuple[torch.Tensor, torch.Tensor]:
    """The scores for each token of the programs, and which would have been right."""
    device = network.embeddings.device
    tokens: list[int] = []
    wanted: list[int] = []
    for each in batch:
        first = len(tokens) + len(each.prompt) - 1
        wanted += range(first, first + len(each.program))
        tokens += [*each.prompt, *each.program[:-1]]
    row = Row(torch.tensor(tokens, device=device), tuple(len(each) - 1 for each in batch))
    right = torch.tensor([number[token] for each in batch for token in each.program])
    return network(row, torch.tensor(wanted, device=device)), right.to(device)


def rate(step: int, steps: int, fastest: float) -> float:
    """Rising, then falling to nothing (a cosine)."""
    warm = max(1, int(WARM * steps))
    if step < warm:
        return fastest * (step + 1) / warm
    return fastest * 0.5 * (1 + math.cos(math.pi * (step - warm) / max(1, steps - warm)))


def train(
    network: Network, examples: Examples, out: Path, at_once: int = AT_ONCE, fast: float = FASTEST
) -> None:
    """Learn all passes, from where it was interrupted on."""
    out.mkdir(parents=True, exist_ok=True)
    number = {token: place for place, token in enumerate(examples.written)}
    plan = [batch for each in examples.passes for batch in batches(each, at_once)]
    ends = {sum(1 for _ in batches(each, at_once)) for each in examples.passes}
    optimiser = torch.optim.AdamW(network.changes(), lr=fast, weight_decay=0.01)
    state, begun = out / "state.pt", 0
    if state.exists():
        kept = torch.load(state)
        network.restore(kept["learned"])
        optimiser.load_state_dict(kept["optimiser"])
        begun = kept["step"]
    print(f"{len(plan)} steps, from {begun} on; {len(network.changes())} changes", flush=True)
    saved, losses = time.monotonic(), []
    for step in range(begun, len(plan)):
        for group in optimiser.param_groups:
            group["lr"] = rate(step, len(plan), fast)
        loss = functional.cross_entropy(*scores_of(network.train(), plan[step], number))
        optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(network.changes(), 1.0)
        optimiser.step()
        losses.append(loss.detach())
        if step % 20 == 0:
            print(f"step {step} loss {torch.stack(losses).mean().item():.3f}", flush=True)
            losses.clear()
        last = step + 1 == len(plan)
        if last or time.monotonic() - saved > SAVED_EVERY:
            kept = {"learned": network.learned(), "optimiser": optimiser.state_dict()}
            torch.save({**kept, "step": step + 1}, state.with_suffix(".new"))
            state.with_suffix(".new").replace(state)
            saved = time.monotonic()
        if last or (step + 1) % min(ends) == 0:
            loss_, right = measured(network.eval(), examples.unseen, number, at_once)
            told = {"step": step + 1, "loss": round(loss_, 4), "right": round(right, 4)}
            with (out / "course.jsonl").open("a") as course:
                course.write(json.dumps(told) + "\n")
            print(told, flush=True)
    write({key: each.cpu().numpy() for key, each in network.learned().items()}, out / LEARNED)


def measured(
    network: Network, examples: Sequence[Example], number: dict[int, int], at_once: int
) -> tuple[float, float]:
    """The loss of a token, and the share of programs that would be written word for word."""
    lost, tokens, right = 0.0, 0, 0
    with torch.no_grad():
        for batch in batches(examples, at_once):
            scores, wanted = scores_of(network, batch, number)
            lost += functional.cross_entropy(scores, wanted, reduction="sum").item()
            tokens += len(wanted)
            hits = (scores.argmax(-1) == wanted).split([len(each.program) for each in batch])
            right += sum(int(each.all()) for each in hits)
    return lost / tokens, right / len(examples)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("gguf", type=Path)
    parser.add_argument("examples", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("--rank", type=int, default=RANK)
    parser.add_argument("--fastest", type=float, default=FASTEST, help="the learning rate")
    parser.add_argument("--at-once", type=int, default=AT_ONCE, help="tokens for one step")
    given = parser.parse_args()
    torch.manual_seed(0)
    examples = Examples.load(given.examples)
    gpu = torch.cuda.is_available()
    kind = torch.bfloat16 if gpu else torch.float32
    network = Network(given.gguf, examples.written, given.rank, kind)
    network.to("cuda" if gpu else "cpu")
    train(network, examples, given.out, given.at_once, given.fastest)


if __name__ == "__main__":
    main()
