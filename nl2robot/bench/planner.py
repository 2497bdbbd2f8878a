"""How fast the language model writes programs here: `nl2robot bench planner`."""

from __future__ import annotations

import statistics
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Final, TypeVar

from grammar.language import load_language
from grammar.planning.model.decoding import Decoder
from grammar.planning.model.prompt import PREFIX, request
from grammar.planning.model.recogniser import Partial
from grammar.planning.model.request import Interrupted, Request
from grammar.planning.turn import Turn
from nl2robot.bench.figures import Figure, percentile
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.language_model.client import Process
from nl2robot.language_model.model import Branch, OnnxModel
from nl2robot.language_model.worker import Reading
from nl2robot.translate.planners import AUTO, installed_model, language_model, learned
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

T = TypeVar("T")

SENTENCES: Final = {
    "en": (
        "I am a bit worried about Alice, would you look in on her and tell me what she says",
        "see whether anybody is still hanging around in the lobby and send them to the pharmacy",
        "Bob swears he left his red cup in the cafeteria; if it is there take it to him",
        "every ten minutes have a look at the waiting room until it is empty, then let me know",
    ),
    "de": (
        "Alice hätte bestimmt gern Gesellschaft, schau mal nach ihr und frag, wie es ihr geht",
        "Sieh nach, ob in der Lobby noch jemand herumsitzt, und schick ihn dann zur Apotheke",
        "Bob meint, seine rote Tasse steht in der Cafeteria; wenn ja, bring sie ihm doch",
    ),
    "fr": (
        "Alice m'inquiète un peu, passe la voir et reviens me raconter ce qu'elle dit",
        "Regarde s'il traîne encore quelqu'un dans le hall et envoie-le à la pharmacie",
        "Bob jure que sa tasse rouge est à la cafétéria ; si elle y est, apporte-la-lui",
    ),
}
PROMPT, CHUNKS = 256, (1, 2, 4, 8)
"""Tokens that are read to measure how fast that is."""


def measure() -> Iterator[Figure]:
    """The figures, as they come. Raises `UserError` where there is no model."""
    language_model()  # says what to do where there is none
    folder = installed_model()
    assert folder is not None
    yield from _reading(folder)
    yield from _planning(folder)


def _figure(what: str, value: float, unit: str, aim: str = "") -> Figure:
    return Figure("planner", what, value, unit, aim)


# --- the model alone


def _reading(folder: Path) -> Iterator[Figure]:
    model, seconds = _timed(lambda: OnnxModel(folder, learned=learned(folder.name)))
    yield _figure(f"loading {folder.name}", seconds, "s")
    prompt = (model.tokens.encode("the robot goes to the pharmacy and waits there. ") * PROMPT)[
        :PROMPT
    ]
    [branch], seconds = _timed(lambda: model.read([(Branch(), prompt)]))
    yield _figure("reading", PROMPT / seconds, "tokens/s")
    for size in CHUNKS:
        model.forget(PROMPT)
        times = [_timed(lambda n=size: model.read_along(branch, prompt[:n]))[1] for _ in range(9)]  # type: ignore[misc]
        yield _figure(f"{size} new tokens at once", statistics.median(times) * 1000, "ms")
    yield from _guessing(model)


def _guessing(model: OnnxModel) -> Iterator[Figure]:
    """What guesses bring, with the same sentences."""
    ways = {"without": Reading(model, habits=None), "with": Reading(model)}
    spent = dict.fromkeys(ways, 0.0)
    tokens = steps = 0
    for turn in _turns():
        asked = request(turn)
        for way, reading in ways.items():
            model.forget(0)
            begin = model.read([(Branch(), _tokens(model, asked))])[0]
            decoder = Decoder(reading)
            first, seconds = _timed(
                lambda d=decoder, b=begin, a=asked: d.first(b, Partial.begin(a.words))  # type: ignore[misc]
            )
            spent[way] += seconds
            if way == "with" and first is not None:
                tokens, steps = tokens + first.tokens, steps + decoder.steps
    yield _figure("tokens of a program by reading once", tokens / steps, "tokens")
    number = sum(map(len, SENTENCES.values()))
    for way, seconds in spent.items():
        yield _figure(f"writing a program {way} guesses, mean", seconds / number, "s")


def _tokens(model: OnnxModel, asked: Request) -> list[int]:
    tokens = model.tokens.encode(asked.prefix, control=True)
    for piece in asked.said:
        tokens += model.tokens.encode(piece.text, control=piece.marks)
    return tokens


# --- from words to a program


def _planning(folder: Path) -> Iterator[Figure]:
    process = Process(folder, learned(folder.name))
    try:
        _, seconds = _timed(lambda: process.get_ready(PREFIX))
        yield _figure("starting its process", seconds, "s")
        firsts, programs = [], []
        for turn in _turns():
            began, seen = time.perf_counter(), list[float]()
            asked = request(turn)
            process.write(asked, lambda _, b=began, s=seen: s.append(time.perf_counter() - b))  # type: ignore[misc]
            firsts.append(seen[0])
            programs.append(time.perf_counter() - began)
        yield _figure("first words, median", statistics.median(firsts), "s", "1")
        yield _figure("program, median", statistics.median(programs), "s", "4")
        yield _figure("program, p95", percentile(programs, 95), "s", "10")
        yield _figure("cancelling, median", statistics.median(_cancelling(process)), "ms", "50")
        memory = process.memory()
        if memory is not None:
            yield _figure("memory of its process", memory, "MB", "1500")
    finally:
        process.close()
    knowledge = Knowledge(load_world(DEFAULT_WORLD))
    times = []
    for language, sentences in SENTENCES.items():
        for sentence in sentences:
            times.append(translate(sentence, knowledge, language, AUTO).ms / 1000)
    yield _figure("translate, median", statistics.median(times), "s", "4")
    yield _figure("translate, p95", percentile(times, 95), "s", "10")


def _cancelling(process: Process) -> Iterator[float]:
    turn = next(_turns())
    for after in (0.3, 0.6, 1.0, 1.4, 1.8):
        cancelled: list[float] = []

        def cancel(told: list[float] = cancelled) -> None:
            told.append(time.perf_counter())
            process.cancel()

        timer = threading.Timer(after, cancel)
        timer.start()
        try:
            process.write(request(turn))
        except Interrupted:
            yield (time.perf_counter() - cancelled[0]) * 1000
        timer.cancel()


def _turns() -> Iterator[Turn]:
    knowledge = Knowledge(load_world(DEFAULT_WORLD))
    for code, sentences in SENTENCES.items():
        for sentence in sentences:
            yield Turn(sentence, knowledge.lexicon(code), load_language(code))


def _timed(what: Callable[[], T]) -> tuple[T, float]:
    began = time.perf_counter()
    return what(), time.perf_counter() - began
