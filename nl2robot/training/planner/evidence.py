"""Which words speak for which deeds: counted over the corpus and over what the rules can say.

    python -m nl2robot.training.planner.evidence

writes `grammar/checking/counted/<code>.msgpack`, which `grammar.checking` reads: for each word
(its beginning, so that its forms count together) how often it was said and how often with each
deed: a robot method, a condition, a round. And the words in which the robot reports that nobody
has said.
"""

from __future__ import annotations

import sys
from collections import Counter, defaultdict
from collections.abc import Iterator

import msgspec

from grammar.checking.deeds import deeds
from grammar.checking.evidence import FOLDER, Evidence, stem
from grammar.checking.literals import literals
from grammar.checking.words import alike, content, forms, words_of
from grammar.language import languages, load_language
from grammar.plan import Plan
from grammar.planning.model.expansion import program_of
from grammar.planning.model.recogniser import CLARIFY, REFUSE
from grammar.planning.turn import Turn
from grammar.prepared import forget
from grammar.program_parser import parse_program
from grammar.roles import FREE
from grammar.sampler import sensible
from nl2robot.knowledge import DEFAULT_WORLD, Knowledge
from nl2robot.training.planner.corpus import files, load
from nl2robot.training.planner.examples import is_held_out
from sim.world.loading import load_world

SAMPLED = 2500
"""Sentences of the rules for each language."""
LEAST_SAID = 2
"""A word of fewer sentences says nothing."""
LEAST_REPORTED = 3


def pairs(language: str) -> Iterator[tuple[Turn, Plan, float]]:
    """Sentences with what they mean, and how much each counts."""
    for item in load(files()):
        ways_out = (f"{REFUSE}(", f"{CLARIFY}(")
        learned = item.language == language and not is_held_out(item)
        if learned and not item.do.startswith(ways_out):
            program = program_of(item.do, load_language(language))
            yield item.turn, parse_program(program, language), 2.0
    lexicon = Knowledge(load_world(DEFAULT_WORLD)).lexicon(language)
    for seed in range(SAMPLED):
        try:
            drawn = sensible(lexicon, language, seed)
        except LookupError:
            continue
        yield Turn(drawn.sentence, lexicon, load_language(language)), drawn.plan, 1.0
        if seed % 250 == 0:
            print(f"{language}: {seed} of {SAMPLED}", file=sys.stderr, flush=True)


def counted(code: str) -> Evidence:
    language = load_language(code)
    said: defaultdict[str, float] = defaultdict(float)
    done: defaultdict[str, Counter[str]] = defaultdict(Counter)
    all_done: Counter[str] = Counter()
    reported: Counter[str] = Counter()
    total = 0.0
    for turn, plan, weight in pairs(code):
        forget()
        total += weight
        found = deeds(plan)
        all_done.update(dict.fromkeys(found, weight))
        named = {
            at
            for each in turn.mentions
            if _is_name(each.sort)
            for at in range(each.start, each.end)
        }
        words = {
            stem(token.norm) for at, token in content(turn.tokens, language) if at not in named
        }
        for word in words:
            said[word] += weight
            done[word].update(dict.fromkeys(found, weight))
        if weight > 1:
            reported.update(_reported(turn, plan))
    kept = {word for word, times in said.items() if times >= LEAST_SAID}
    return Evidence(
        total=total,
        done=dict(all_done),
        said={word: said[word] for word in sorted(kept)},
        together={word: dict(done[word]) for word in sorted(kept)},
        reported=sorted(word for word, times in reported.items() if times >= LEAST_REPORTED),
    )


def _is_name(sort: str) -> bool:
    return sort in ("place", "person", "contact")


def _reported(turn: Turn, plan: Plan) -> set[str]:
    """Words that the robot says and nobody said to it."""
    heard: set[str] = set()
    for token in turn.tokens:
        heard |= forms(token, turn.language)
    for mention in turn.spoken_of:
        heard |= words_of(mention.value, turn.language)
    texts = [each.text for each in literals(plan) if each.role == FREE]
    spoken = set().union(*(words_of(text, turn.language) for text in texts)) if texts else set()
    return {word for word in spoken if not alike({word}, heard)}


def main() -> None:
    for code in languages():
        evidence = counted(code)
        path = FOLDER / f"{code}.msgpack"
        path.write_bytes(msgspec.msgpack.encode(evidence))
        print(f"{path.name} {code}: {len(evidence.said)} words, {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
