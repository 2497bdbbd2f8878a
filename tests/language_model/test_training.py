"""A model learns how a small ward talks, is interrupted, measured, and goes out with its card."""

from __future__ import annotations

import hashlib
import os
import signal
from collections.abc import Iterator
from pathlib import Path

import msgspec
import numpy as np
import pytest
import yaml

from grammar.planning.planner import Answer, Draft, Drafts, Refusal, Watch
from grammar.planning.turn import Turn
from grammar.understanding import Context
from nl2robot.errors import UserError
from nl2robot.language_model import changes
from nl2robot.language_model.install import install
from nl2robot.language_model.model import Branch, OnnxModel
from nl2robot.models.catalogue import LARGE
from nl2robot.training.planner import __main__ as command
from nl2robot.training.planner import corpus, course, evaluate, export
from nl2robot.training.planner.corpus import Item
from nl2robot.training.planner.example import Examples
from nl2robot.training.planner.examples import make_examples
from nl2robot.training.planner.installed import Installed
from nl2robot.training.planner.recipe import Kept, Recipe
from tests.language_model.tiny import Tiny

LEARNED_FROM = """
author: night nurse
world: harbour.yaml
items:
  - en: wave to everybody
    do: gesture("wave")
  - de: Sag bitte, dass das Essen fertig ist.
    do: say("Das Essen ist fertig.")
  - fr: attends dix secondes
    do: wait(10)
  - en: wait ten seconds, and then wave
    do: |
      wait(10)
      gesture("wave")
"""
HELD_OUT = """
author: night nurse
world: harbour.yaml
items:
  - en: wait five seconds
    do: wait(5)
  - en: wave twice
    do: |
      for i in range(2):
          gesture("wave")
  - de: gib mir ein Schmerzmittel
    do: refuse("medical")
"""
SMALL = Recipe(passes=2, rank=4, at_once=150, noisy=0.5)


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> tuple[Tiny, Path]:
    """A tiny model where the large one would be."""
    folder = tmp_path_factory.mktemp("models") / LARGE
    folder.mkdir()
    tiny = Tiny()
    tiny.write(folder / "tiny.gguf")
    install(folder / "tiny.gguf", folder)
    return tiny, folder


@pytest.fixture(autouse=True)
def ward(
    model: tuple[Tiny, Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> Iterator[None]:
    """A computer with that model and a corpus of seven sentences."""
    written = tmp_path / "corpus"
    written.mkdir()
    (written / "harbour-1.yaml").write_text(LEARNED_FROM, "utf-8")
    (written / "harbour-6.yaml").write_text(HELD_OUT, "utf-8")
    monkeypatch.setattr(corpus, "CORPUS", written)
    monkeypatch.setattr(course, "OFTEN", 0.0)
    monkeypatch.setenv("NL2ROBOT_MODELS", str(model[1].parent))
    yield


@pytest.fixture
def kept(tmp_path: Path, model: tuple[Tiny, Path]) -> Kept:
    """A training for which the examples are made."""
    kept = Kept(tmp_path / "training")
    kept.folder.mkdir()
    make_examples(model[1], kept.examples, lambda line: None, SMALL)
    return kept


def test_the_weights_that_learn_are_those_that_run(model: tuple[Tiny, Path]) -> None:
    tiny, installed = model[0], Installed(model[1])
    assert (installed.layers, installed.heads) == (2, (4, 2))
    assert installed.epsilon == pytest.approx(1e-6)
    for layer in range(2):
        asks = [tiny.weights[f"blk.{layer}.attn_{each}.weight"] for each in "qkv"]
        matrix = installed.matrix(f"blk.{layer}.qkv")
        assert np.abs(matrix - np.concatenate(asks)).max() < 2e-3
        down = tiny.weights[f"blk.{layer}.ffn_down.weight"]
        assert np.abs(installed.matrix(f"blk.{layer}.down") - down).max() < 2e-3
    assert np.abs(installed.embeddings - tiny.weights["token_embd.weight"]).max() < 2e-3
    assert installed.bias("blk.0.told") is None
    assert (installed.normal("blk.1.out") == tiny.weights["output_norm.weight"]).all()


def test_examples_are_made_once_for_every_pass(kept: Kept) -> None:
    made = Examples.load(kept.examples)
    assert [len(each) for each in made.passes] == [4, 4]
    assert len(made.unseen) == 3
    assert made.corpus == corpus.digest()


def test_a_changed_corpus_is_another_corpus(tmp_path: Path) -> None:
    before = corpus.digest()
    file = tmp_path / "corpus" / "harbour-1.yaml"
    file.write_text(LEARNED_FROM.replace("wave to", "nod to"), "utf-8")
    assert corpus.digest() != before


# --- learning, where there is torch


def learn(model: tuple[Tiny, Path], kept: Kept, stop_after: int | None = None) -> list[str]:
    """Learn, and press Ctrl-C when so many steps are told."""
    pytest.importorskip("torch")
    from nl2robot.training.planner.train import torch, train

    torch.set_num_threads(1)
    told: list[str] = []

    def tell(line: str) -> None:
        told.append(line)
        if stop_after is not None and line.startswith(f"Step {stop_after} "):
            os.kill(os.getpid(), signal.SIGINT)

    train(model[1], kept, tell, SMALL)
    return told


def test_what_is_interrupted_goes_on_and_learns_the_same(
    model: tuple[Tiny, Path], kept: Kept, tmp_path: Path
) -> None:
    at_one_go = Kept(tmp_path / "at one go")
    at_one_go.folder.mkdir()
    at_one_go.examples.write_bytes(kept.examples.read_bytes())
    learn(model, at_one_go)
    with pytest.raises(KeyboardInterrupt):
        learn(model, kept, stop_after=3)
    assert kept.state.exists() and not kept.learned.exists()
    told = learn(model, kept)
    assert told[0].startswith("It goes on after step 3 of ")
    assert kept.learned.read_bytes() and not kept.state.with_suffix(".new").exists()
    one, other = changes.read(at_one_go.learned), changes.read(kept.learned)
    assert one.keys() == other.keys()
    assert all((one[key] == other[key]).all() for key in one)
    assert any(np.abs(one[key]).max() > 0 for key in one if key.endswith(".up"))


def test_what_was_learned_makes_the_programs_of_the_ward_likelier(
    model: tuple[Tiny, Path], kept: Kept
) -> None:
    learn(model, kept)
    example = Examples.load(kept.examples).passes[0][0]

    def likely(learned: Path | None) -> float:
        reader = OnnxModel(model[1], threads=1, room=1024, learned=learned)
        places = {token: place for place, token in enumerate(reader.tokens.written)}
        [branch] = reader.read([(Branch(), example.prompt)])
        total = 0.0
        for token in example.program:
            total += float(reader.scores(branch)[places[token]])
            [branch] = reader.read([(branch, [token])])
        return total

    assert likely(kept.learned) > likely(None) + 1


def test_a_training_of_another_recipe_is_not_gone_on_with(
    model: tuple[Tiny, Path], kept: Kept, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(KeyboardInterrupt):
        learn(model, kept, stop_after=1)
    assert command.main(["train", "--out", str(kept.folder)]) == 2
    assert "by another recipe. Delete that folder" in capsys.readouterr().err


# --- measuring


class Nurse:
    """Plans what it was told to, whatever is said."""

    name = "nurse"

    def __init__(self, *answers: str | None) -> None:
        self.answers = list(answers)

    def plan(self, turn: Turn, watch: Watch) -> Answer:
        answer = self.answers.pop(0)
        if answer is None:
            return Refusal("I do not do that.")
        draft = evaluate._wanted(Item("", "", "", turn.language.code, turn.text, answer), turn)
        assert draft is not None
        return Drafts((Draft(draft.plan, "nurse", 1.0, Context(written=answer)),))


def held_out() -> list[Item]:
    return [item for item in corpus.load(corpus.files()) if "-6" in item.where]


def test_scores_are_told_by_language_and_by_kind_of_order(tmp_path: Path) -> None:
    nurse = Nurse("wait(5)", 'gesture("wave")', None)
    rows = evaluate.measure(held_out(), nurse, tmp_path / "evaluated.jsonl")
    by_language = evaluate.scores(rows, "language")
    assert (by_language["en"].orders, by_language["en"].right) == (2, 1)
    assert by_language["en"].something_else == 1
    assert (by_language["de"].ways_out, by_language["de"].kept_back) == (1, 1)
    by_group = evaluate.scores(rows, "group")
    assert [*by_group] == ["single calls", "programs", "to be refused or asked back", "all"]
    assert by_group["single calls"].right == 1 and by_group["programs"].right == 0
    lines = [*evaluate.table(by_language)]
    assert "| en | 2 | 1 (50%) | 1 | 0 |  |" in lines[3]


def test_a_measurement_goes_on_unless_something_else_was_learned(tmp_path: Path) -> None:
    out = tmp_path / "evaluated.jsonl"
    evaluate.measure(held_out()[:2], Nurse("wait(5)", "wait(5)"), out, of="first")
    nurse = Nurse(None, None, None)
    assert len(evaluate.measure(held_out(), nurse, out, of="first")) == 3
    assert len(nurse.answers) == 2
    assert len(evaluate.measure(held_out(), Nurse(None, None, None), out, of="second")) == 3
    assert len(evaluate.rows_of(out, "first")) == 3


def test_a_machine_that_is_too_busy_says_nothing_of_the_model(tmp_path: Path) -> None:
    class Late(Nurse):
        def plan(self, turn: Turn, watch: Watch) -> Answer:
            if self.answers.pop(0) is None:
                return Refusal("It took too long.", absent=True)
            return Refusal("I do not do that.")

    out, told = tmp_path / "evaluated.jsonl", list[str]()
    rows = evaluate.measure(held_out(), Late("no", None, "no"), out, tell=told.append)
    assert [row["say"] for row in rows] == ["wait five seconds", "gib mir ein Schmerzmittel"]
    assert told[-1].startswith("1 sentences got no answer (It took too long.)")
    again = evaluate.measure(held_out(), Nurse('gesture("wave")'), out)
    assert len(again) == 3
    with pytest.raises(UserError, match=r"answered nothing: It took too long\."):
        evaluate.measure(held_out(), Late(None, None, None), tmp_path / "other.jsonl")


# --- going out with the package


def learned_by(kept: Kept, model: tuple[Tiny, Path]) -> None:
    """As if it had been learned here: a machine with torch may be another one."""
    size = model[0].weights["blk.0.attn_output.weight"].shape
    random = np.random.default_rng(1)
    changes.write(
        {
            "0.told.down": random.normal(0, 0.1, (4, size[1])).astype(np.float32),
            "0.told.up": random.normal(0, 0.1, (size[0], 4)).astype(np.float32),
        },
        kept.learned,
    )
    measured = [course.Measured(4, 0.5, 0.25)]
    course.Course(steps=4, device="2 cores", step=4, seconds=7200, measured=measured).save(
        kept.course
    )


def test_what_was_learned_goes_out_with_a_card_that_says_what_is_known_of_it(
    kept: Kept, model: tuple[Tiny, Path], tmp_path: Path
) -> None:
    learned_by(kept, model)
    of = export.file_digest(kept.learned)
    evaluate.measure(held_out(), Nurse("wait(5)", None, None), kept.evaluated, of)
    told: list[str] = []
    path = export.export(LARGE, kept, told.append, tmp_path / "carried")
    card = yaml.safe_load(path.read_text("utf-8"))
    carried = tmp_path / "carried" / f"{LARGE}.npz"
    assert card["file"]["sha256"] == hashlib.sha256(carried.read_bytes()).hexdigest() == of
    assert card["licence"] == "Apache-2.0"
    assert card["corpus"]["learned"] == {"en": 2, "de": 1, "fr": 1, "all": 4}
    assert card["corpus"]["sha256"] == corpus.digest()
    assert card["recipe"]["rank"] == 16 and card["recipe"]["alpha"] == 32
    assert card["times"] == {"hours": 2.0, "on": "2 cores"}
    assert card["scores"]["by_language"]["en"]["right"] == 1
    assert card["scores"]["by_group"]["programs"]["nothing"] == 1
    habits = msgspec.msgpack.decode((tmp_path / "carried" / "habits.msgpack").read_bytes())
    assert isinstance(habits, dict)
    assert "calibrate" in told[-1]


def test_what_nobody_has_measured_is_said_to_be_so(
    kept: Kept, model: tuple[Tiny, Path], tmp_path: Path
) -> None:
    learned_by(kept, model)
    told: list[str] = []
    path = export.export(LARGE, kept, told.append, tmp_path / "carried")
    assert yaml.safe_load(path.read_text("utf-8"))["scores"] == "not measured"
    assert told[0].startswith("Nobody has measured it")


def test_what_is_too_large_to_come_with_every_installation_stays_here(
    kept: Kept,
    model: tuple[Tiny, Path],
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    learned_by(kept, model)
    monkeypatch.setattr(export, "LARGEST", 100)
    assert command.main(["export", "--out", str(kept.folder)]) == 2
    assert "lower rank" in capsys.readouterr().err


def test_the_card_that_comes_with_the_package_is_that_of_what_comes_with_it() -> None:
    card = yaml.safe_load(export.card_file(LARGE).read_text("utf-8"))
    carried = export.FOLDER / card["file"]["name"]
    assert card["file"]["sha256"] == hashlib.sha256(carried.read_bytes()).hexdigest()
    assert card["file"]["bytes"] == carried.stat().st_size < export.LARGEST
    assert {"licence", "base", "corpus", "recipe", "times", "scores"} <= card.keys()


# --- what is missing is said in a sentence


def test_without_torch_it_is_said_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(command, "_is_there", lambda library: library != "torch")
    assert command.main(["train", "--out", str(tmp_path / "out")]) == 2
    assert capsys.readouterr().err == f"{command.TORCH}\n"
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("what", ["train", "evaluate"])
def test_without_a_model_it_is_said_how_to_fetch_it(
    what: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("NL2ROBOT_MODELS", str(tmp_path / "none"))
    assert command.main([what]) == 2
    told = capsys.readouterr().err
    assert "is not installed. Run `nl2robot models get planner-large`" in told


def test_what_was_never_learned_is_not_sent_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert command.main(["export", "--out", str(tmp_path)]) == 2
    assert "nothing has been learned to its end. Run `python -m" in capsys.readouterr().err


def test_examples_of_a_corpus_that_has_changed_are_not_learned_from(
    kept: Kept,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(command, "_is_there", lambda library: True)
    file = tmp_path / "corpus" / "harbour-1.yaml"
    file.write_text(LEARNED_FROM.replace("wave to", "nod to"), "utf-8")
    assert command.main(["train", "--out", str(kept.folder)]) == 2
    assert "The corpus has changed since" in capsys.readouterr().err
