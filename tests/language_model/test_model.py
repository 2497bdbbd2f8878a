"""The model on onnxruntime says what the weights say, whatever it reads side by side."""

from __future__ import annotations

import threading
from pathlib import Path

import numpy as np
import pytest

from grammar.planning.model.decoding import Full
from nl2robot.language_model.changes import SCALE, write
from nl2robot.language_model.files import FILES, GRAPH
from nl2robot.language_model.install import Unreadable, install
from nl2robot.language_model.model import Branch, Cancelled, OnnxModel
from nl2robot.language_model.tokens import Tokens, is_latin
from tests.language_model.tiny import Tiny

CLOSE = 0.15
"""Inputs of products are rounded to eight bits; what is wrong is off by more than 1."""


@pytest.fixture(scope="module")
def tiny() -> Tiny:
    return Tiny()


@pytest.fixture(scope="module")
def folder(tiny: Tiny, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tiny")
    tiny.write(folder / "tiny.gguf")
    install(folder / "tiny.gguf", folder)
    return folder


@pytest.fixture
def model(folder: Path) -> OnnxModel:
    return OnnxModel(folder, threads=1, room=64)


def wanted(tiny: Tiny, model: OnnxModel, read: list[int]) -> np.ndarray:
    """The logarithms of probabilities that the weights give for what follows the last token."""
    scores = tiny.scores(read)[-1][list(model.tokens.written)].astype(np.float64)
    scores -= scores.max()
    return scores - np.log(np.exp(scores).sum())


def test_a_model_is_installed_as_the_files_that_are_checked(folder: Path) -> None:
    assert {path.name for path in folder.iterdir()} == {*FILES, "tiny.gguf"}


def test_what_may_follow_is_what_the_weights_say(tiny: Tiny, model: OnnxModel) -> None:
    read = [1, 40, 7, 99, 12, 3]
    [branch] = model.read([(Branch(), read)])
    assert np.abs(model.scores(branch) - wanted(tiny, model, read)).max() < CLOSE


def test_reading_in_pieces_comes_to_the_same(tiny: Tiny, model: OnnxModel) -> None:
    branch = Branch()
    for piece in ([1, 40], [7], [99, 12, 3]):
        [branch] = model.read([(branch, piece)])
    assert branch.tokens == (1, 40, 7, 99, 12, 3)
    assert np.abs(model.scores(branch) - wanted(tiny, model, list(branch.tokens))).max() < CLOSE


def test_reading_along_tells_what_may_follow_each(tiny: Tiny, model: OnnxModel) -> None:
    [trunk] = model.read([(Branch(), [1, 40])])
    model.read([(trunk, [8, 9])])  # another branch, that is not seen
    for number, branch in enumerate(model.read_along(trunk, [7, 99, 12]), 1):
        read = [1, 40, 7, 99, 12][: 2 + number]
        assert branch.tokens == tuple(read)
        assert np.abs(model.scores(branch) - wanted(tiny, model, read)).max() < CLOSE
    [further] = model.read([(branch, [3])])
    assert np.abs(model.scores(further) - wanted(tiny, model, [1, 40, 7, 99, 12, 3])).max() < CLOSE


def test_what_may_follow_is_only_known_of_what_was_read_last(model: OnnxModel) -> None:
    [trunk] = model.read([(Branch(), [1, 40])])
    model.read([(trunk, [7])])
    with pytest.raises(AssertionError, match="something else was read"):
        next(model.following(trunk))


def test_branches_that_grow_side_by_side_do_not_see_each_other(
    tiny: Tiny, model: OnnxModel
) -> None:
    [trunk] = model.read([(Branch(), [1, 40, 7])])
    left, right = model.read([(trunk, [8, 9]), (trunk, [50])])
    left, right = model.read([(left, [10]), (right, [51, 52, 53])])
    for branch in (left, right):
        alone = wanted(tiny, model, list(branch.tokens))
        assert np.abs(model.scores(branch) - alone).max() < CLOSE
    assert right.tokens == (1, 40, 7, 50, 51, 52, 53)


PARTS = {
    "qkv": ("attn_q", "attn_k", "attn_v"),
    "told": ("attn_output",),
    "gate": ("ffn_gate",),
    "up": ("ffn_up",),
    "down": ("ffn_down",),
}
"""The matrices that a product of the graph is made of."""


def test_what_was_learned_changes_the_products_as_it_says(folder: Path, tmp_path: Path) -> None:
    tiny, random, learned = Tiny(), np.random.default_rng(7), {}
    tiny.write(tmp_path / "same.gguf")
    for product, parts in PARTS.items():
        names = [f"blk.1.{part}.weight" for part in parts]
        rows = [len(tiny.weights[name]) for name in names]
        down = random.normal(0, 0.1, (3, tiny.weights[names[0]].shape[1])).astype(np.float32)
        up = random.normal(0, 0.1, (sum(rows), 3)).astype(np.float32)
        learned |= {f"1.{product}.down": down, f"1.{product}.up": up}
        change = SCALE * up @ down
        for name, part in zip(names, np.split(change, np.cumsum(rows)[:-1]), strict=True):
            tiny.weights[name] = tiny.weights[name] + part
    write(learned, tmp_path / "learned.npz")
    model = OnnxModel(folder, threads=1, room=64, learned=tmp_path / "learned.npz")
    read = [1, 40, 7, 99, 12, 3]
    [branch] = model.read([(Branch(), read)])
    assert np.abs(model.scores(branch) - wanted(tiny, model, read)).max() < CLOSE
    other = OnnxModel(folder, threads=1, room=64)
    [unlearned] = other.read([(Branch(), read)])
    assert np.abs(model.scores(branch) - other.scores(unlearned)).max() > 2 * CLOSE


def test_what_another_model_has_learned_is_told(folder: Path, tmp_path: Path) -> None:
    write({"0.qkv.down": np.zeros((8, 1536), np.float32)}, tmp_path / "other.npz")
    with pytest.raises(ValueError, match=r"not learned by this model: 0\.qkv\.down"):
        OnnxModel(folder, threads=1, room=64, learned=tmp_path / "other.npz")


def test_the_likeliest_come_first_and_all_come_in_the_end(model: OnnxModel) -> None:
    [branch] = model.read([(Branch(), [1, 2, 3])])
    following = list(model.following(branch))
    scores = [score for _, score in following]
    assert scores == sorted(scores, reverse=True)
    assert {token for token, _ in following} == {*model.tokens.written}
    assert sum(np.exp(scores)) == pytest.approx(1.0, abs=1e-4)


def test_a_long_text_is_read_in_pieces(tiny: Tiny, folder: Path) -> None:
    model = OnnxModel(folder, threads=1, room=256)
    read = [number % 250 for number in range(150)]
    [branch] = model.read([(Branch(), read)])
    assert np.abs(model.scores(branch) - wanted(tiny, model, read)).max() < CLOSE


def test_a_model_that_can_remember_no_more_says_so_and_forgets_nothing(
    tiny: Tiny, model: OnnxModel
) -> None:
    [branch] = model.read([(Branch(), list(range(60)))])
    with pytest.raises(Full):
        model.read([(branch, [1, 2, 3, 4, 5])])
    model.forget(60)
    [branch] = model.read([(branch, [61])])
    assert np.abs(model.scores(branch) - wanted(tiny, model, [*range(60), 61])).max() < CLOSE


def test_cancelling_holds_until_somebody_resumes(model: OnnxModel) -> None:
    threading.Thread(target=model.cancel).run()
    with pytest.raises(Cancelled):
        model.read([(Branch(), [1, 2])])
    model.resume()
    assert model.read([(Branch(), [1, 2])])


def test_words_that_look_like_marks_are_words_where_people_say_them(folder: Path) -> None:
    tokens = Tokens.load(folder / "tokens.msgpack")
    assert tokens.end in tokens.encode("say<|im_end|>", control=True)
    assert tokens.end not in tokens.encode("say<|im_end|>")


def test_only_what_people_here_read_is_written(folder: Path) -> None:
    tokens = Tokens.load(folder / "tokens.msgpack")
    written = {tokens.text(token) for token in tokens.written}
    assert {"say", "é", "\n", ""} <= written
    assert not any("家" in text or "\t" in text for text in written)
    assert is_latin("Straße".encode()) and not is_latin("é".encode()[:1])


@pytest.mark.parametrize("content", [b"", b"GGUF", b"no model at all" * 100])
def test_a_file_that_is_no_model_is_named(content: bytes, tmp_path: Path) -> None:
    file = tmp_path / "model.gguf"
    file.write_bytes(content)
    with pytest.raises(Unreadable, match=r"model\.gguf"):
        install(file, tmp_path)


def test_a_model_of_another_kind_is_not_taken_for_one(tmp_path: Path) -> None:
    Tiny().write(tmp_path / "llama.gguf", architecture="llama")
    with pytest.raises(Unreadable, match="llama"):
        install(tmp_path / "llama.gguf", tmp_path)
    assert not (tmp_path / GRAPH).exists()
