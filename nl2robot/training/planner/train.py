"""Teach a language model from examples, on whatever computer there is: on a GPU a pass over the
corpus takes a minute, on two cores a day. Needs torch.

It may be interrupted at any moment: Ctrl-C keeps what was learned up to the last whole step, and
whatever else ends it leaves what was kept within the last ten minutes. What is learned does not
depend on that.
"""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, Final

import msgspec
import torch
from torch.nn import functional

from nl2robot.ctrl_c import ctrl_c_later
from nl2robot.errors import UserError
from nl2robot.language_model.changes import write
from nl2robot.training.planner.course import Course, Measured, Steps
from nl2robot.training.planner.example import Example, Examples
from nl2robot.training.planner.installed import Installed
from nl2robot.training.planner.network import Network, Row
from nl2robot.training.planner.recipe import RECIPE, Kept, Recipe

KEPT_EVERY: Final = 600.0
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


def rate(step: int, steps: int, recipe: Recipe) -> float:
    """Rising, then falling to nothing (a cosine)."""
    warm = max(1, int(recipe.warm * steps))
    if step < warm:
        return recipe.fastest * (step + 1) / warm
    share = (step - warm) / max(1, steps - warm)
    return recipe.fastest * 0.5 * (1 + math.cos(math.pi * share))


class Learner:
    """A network, what it has to learn, and how far it is."""

    def __init__(self, network: Network, examples: Examples, kept: Kept, recipe: Recipe) -> None:
        self.network, self.examples, self.kept, self.recipe = network, examples, kept, recipe
        passes = [[*batches(each, recipe.at_once)] for each in examples.passes]
        self.plan = [batch for each in passes for batch in each]
        self.ends = {sum(map(len, passes[: number + 1])) for number in range(len(passes))}
        """Steps after which a pass is over."""
        self.optimiser = torch.optim.AdamW(
            network.changes(), lr=recipe.fastest, weight_decay=recipe.decay
        )
        self.course = Course(steps=len(self.plan), device=device_name())
        self._numbers = {token: place for place, token in enumerate(examples.written)}

    @property
    def is_done(self) -> bool:
        return self.course.step == len(self.plan) and not self._is_to_be_measured

    @property
    def _is_to_be_measured(self) -> bool:
        step = self.course.step
        return step in self.ends and all(each.step != step for each in self.course.measured)

    def go_on(self) -> float | None:
        """One step, or a measurement where a pass is over: the loss of the step."""
        began = time.monotonic()
        if self._is_to_be_measured:
            measured = self._measured()
            self.course.measured.append(measured)
            self.course.seconds += time.monotonic() - began
            return None
        step = self.course.step
        torch.manual_seed(self.recipe.seed + step)  # the same whether it was interrupted or not
        for group in self.optimiser.param_groups:
            group["lr"] = rate(step, len(self.plan), self.recipe)
        loss = functional.cross_entropy(*self._scores(self.network.train(), self.plan[step]))
        self.optimiser.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(self.network.changes(), 1.0)
        with ctrl_c_later():
            self.optimiser.step()
            self.course.step += 1
            self.course.seconds += time.monotonic() - began
        return loss.item()

    def _measured(self) -> Measured:
        """The loss of a token of what is never learned, and the share of programs that would be
        written word for word."""
        lost, tokens, right = 0.0, 0, 0
        self.network.eval()
        with torch.no_grad():
            for batch in batches(self.examples.unseen, self.recipe.at_once):
                scores, wanted = self._scores(self.network, batch)
                lost += functional.cross_entropy(scores, wanted, reduction="sum").item()
                tokens += len(wanted)
                hits = (scores.argmax(-1) == wanted).split([len(each.program) for each in batch])
                right += sum(int(each.all()) for each in hits)
        examples = max(1, len(self.examples.unseen))
        loss = round(lost / max(1, tokens), 4)
        return Measured(self.course.step, loss, round(right / examples, 4))

    def _scores(
        self, network: Network, batch: Sequence[Example]
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
        right = torch.tensor([self._numbers[token] for each in batch for token in each.program])
        return network(row, torch.tensor(wanted, device=device)), right.to(device)

    # --- what is kept

    def _of(self) -> dict[str, Any]:
        """What has to be the same for a training to be gone on with."""
        return {"corpus": self.examples.corpus, "recipe": msgspec.to_builtins(self.recipe)}

    def keep(self) -> None:
        state = {
            "of": self._of(),
            "learned": self.network.learned(),
            "optimiser": self.optimiser.state_dict(),
            "course": msgspec.to_builtins(self.course),
        }
        new = self.kept.state.with_suffix(".new")
        with ctrl_c_later():
            torch.save(state, new)
            new.replace(self.kept.state)

    def resume(self) -> None:
        """Go on from what was kept, if anything was. Raises `UserError` if that is of another
        corpus or recipe."""
        if not self.kept.state.exists():
            return
        state = torch.load(self.kept.state, map_location=self.network.embeddings.device)
        if state["of"] != self._of():
            raise UserError(
                f"What was begun in {self.kept.folder} learns from another corpus, or by another"
                " recipe. Delete that folder, or name another with --out, to begin anew."
            )
        self.network.restore(state["learned"])
        self.optimiser.load_state_dict(state["optimiser"])
        self.course = msgspec.convert(state["course"], Course)

    def finish(self) -> None:
        """Write what comes of it."""
        learned = {key: each.cpu().numpy() for key, each in self.network.learned().items()}
        self.course.save(self.kept.course)
        new = self.kept.learned.with_suffix(".new.npz")
        write(learned, new)
        new.replace(self.kept.learned)


def device_name() -> str:
    if torch.cuda.is_available():
        return str(torch.cuda.get_device_name())
    return f"{torch.get_num_threads()} cores"


def train(folder: Path, kept: Kept, tell: Callable[[str], None], recipe: Recipe = RECIPE) -> Course:
    """Learn all passes, from where it was interrupted on; the examples are there. `folder` is that
    of the installed model. Raises `UserError`; `KeyboardInterrupt` once what was learned is
    kept."""
    examples = Examples.load(kept.examples)
    torch.manual_seed(recipe.seed)
    gpu = torch.cuda.is_available()
    network = Network(Installed(folder), recipe, torch.bfloat16 if gpu else torch.float32)
    learner = Learner(network.to("cuda" if gpu else "cpu"), examples, kept, recipe)
    learner.resume()
    told = Steps(learner.course, tell)
    saved = time.monotonic()
    try:
        while not learner.is_done:
            told.step(learner.go_on())
            if time.monotonic() - saved > KEPT_EVERY:
                learner.keep()
                saved = time.monotonic()
    except KeyboardInterrupt:
        learner.keep()
        raise
    learner.keep()
    learner.finish()
    return learner.course
