"""Frames that are nearly what a robot's server understands: as calls, as JSON, as bytes."""

from __future__ import annotations

import hashlib
import json
import math
import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from robot_api.frame import MAX_FRAME
from tests.attacks.mutations import (
    FLOATS,
    NUMBERS,
    WORDS,
    bytes_like,
    data_like,
    odd,
    text_like,
)

PROGRAMS: Final = (
    'robot.say("Good night.")\n',
    'robot.goto("lobby")\nrobot.say("There.")\n',
    "while True:\n    robot.battery()\n    robot.wait(1)\n",
)
"""What is approved by whoever attacks; nothing else is."""
HEAVY: Final = {"rpc.discover", "scene.floor", "runs.list", "places.export", "program.phrases"}
"""Answers of many kilobytes, or what takes tens of milliseconds: called now and then."""
HEAVY_PARTS: Final = ("program.check", "program.approve", "program.translate", "routines.")
KNOWN: Final = ("pharmacy", "lobby", "ward a", "Alice", "cup", "en", "de", "wave", "happy", "Kim")
ENDS_IT: Final = ("robot.stop",)
_WRAPPING: Final = ("jsonrpc", "id", "method", "params")


@dataclass(frozen=True)
class Frame:
    """One to be sent."""

    data: str | bytes
    ids: tuple[str, ...] = ()
    """Of those in it that have to be answered."""


class Frames:
    """Makes them, of what the server says that it knows (`rpc.discover`)."""

    def __init__(self, document: Mapping[str, Any]) -> None:
        self.methods = {
            each["name"]: {param["name"]: param["schema"] for param in each["params"]}
            for each in document["methods"]
            if each["name"] not in ENDS_IT
        }
        self._light = [name for name in self.methods if not _is_heavy(name)]
        self._heavy = [name for name in self.methods if _is_heavy(name)]

    def made(self, chance: random.Random, name: str) -> Frame:
        """`name`: begins the ids."""
        way = chance.random()
        if way < 0.55:
            return self._whole(chance, name)
        if way < 0.7:
            tree = data_like(chance, self._call(chance, name), _WRAPPING, half=True)
            return Frame(_json(tree))
        if way < 0.78:
            return self._batch(chance, name)
        text = _json(self._call(chance, name))
        if way < 0.88:
            return Frame(_sendable(text_like(chance, [text], WORDS)))
        if way < 0.97:
            data = bytes_like(chance, [text.encode()])
            return Frame(data if chance.random() < 0.1 else data.decode("utf-8", "replace"))
        return Frame(_monster(chance))

    def _whole(self, chance: random.Random, name: str) -> Frame:
        """A call with an id, whatever its params are: it has to be answered."""
        return Frame(_json(self._call(chance, name)), (name,))

    def _batch(self, chance: random.Random, name: str) -> Frame:
        names = [f"{name} {at}" for at in range(chance.choice((1, 2, 5, 64, 65)))]
        calls = [self._call(chance, each, light=True) for each in names]
        if chance.random() < 0.5:
            return Frame(_json(calls), tuple(names) if len(calls) < 65 else ())
        return Frame(_json(data_like(chance, calls, _WRAPPING, half=True)))

    def _call(self, chance: random.Random, name: str, light: bool = False) -> dict[str, Any]:
        heavy = not light and chance.random() < 0.01
        method = chance.choice(self._heavy if heavy else self._light)
        schemas = self.methods[method]
        given: Any = {
            each: valued(chance, each, schema)
            for each, schema in schemas.items()
            if chance.random() < 0.8
        }
        if "sha256" in given:
            given["program"] = chance.choice(PROGRAMS)
            given["sha256"] = hashlib.sha256(chance.choice(PROGRAMS).encode()).hexdigest()
        if chance.random() < 0.4:
            given = data_like(chance, given, list(schemas), half=True)
        elif chance.random() < 0.2:
            given = list(given.values())
        if chance.random() < 0.02:
            method = text_like(chance, [method], half=False)
        return {"jsonrpc": "2.0", "id": name, "method": method, "params": given}


def _is_heavy(name: str) -> bool:
    return name in HEAVY or name.startswith(HEAVY_PARTS)


def valued(chance: random.Random, name: str, schema: Mapping[str, Any]) -> Any:
    """A value of that schema, more or less."""
    if name == "program":
        return chance.choice(PROGRAMS)
    if "anyOf" in schema:
        return valued(chance, name, chance.choice(schema["anyOf"]))
    if "enum" in schema:
        return chance.choice([*schema["enum"], "?"])
    kind = schema.get("type")
    if isinstance(kind, list):
        kind = chance.choice(kind)
    low, high = schema.get("minimum", -1000), schema.get("maximum", 1000)
    match kind:
        case "string":
            longest = schema.get("maxLength", 2000)
            return chance.choice((*KNOWN, chance.choice(WORDS), "a" * (longest + 1)))
        case "integer":
            return chance.choice((low, high, high + 1, chance.randint(int(low), int(high))))
        case "number":
            return chance.choice((low, high, high * 1.01, chance.uniform(low, high), 0))
        case "boolean":
            return chance.random() < 0.5
        case "array":
            inner, most = schema.get("items", {}), schema.get("maxItems", 20)
            count = chance.choice((0, 1, 2, 3, min(most, 200), min(most, 200) + 1))
            return [valued(chance, name, inner) for _ in range(count)]
        case "object":
            inside = schema.get("properties", {})
            return {each: valued(chance, each, value) for each, value in inside.items()}
        case "null":
            return None
    return odd(chance)


def _json(tree: Any) -> str:
    """With numbers that JSON has not got, too, and halves of signs as it writes them."""
    return json.dumps(tree)


def _sendable(text: str) -> str:
    return text.encode("utf-8", "replace").decode("utf-8")[: MAX_FRAME - 1]


def _monster(chance: random.Random) -> str | bytes:
    """Long, deep, wide or none at all."""
    count = int(2 ** chance.uniform(1, 13))
    piece = chance.choice(
        ("[", '{"a":', '"', "\\", "0", "[],", '"a",', "[1e999,", "{}", "-", "\\u")
    )
    match chance.randrange(6):
        case 0:
            return piece * count
        case 1:
            return json.dumps(["a" * count, [0] * count])
        case 2:
            return "[" * count + "]" * chance.choice((count, count - 1))
        case 3:
            number = chance.choice((*NUMBERS, *(each for each in FLOATS if not math.isnan(each))))
            return f'{{"jsonrpc":"2.0","id":{number},"method":"robot.wait","params":[{number}]}}'
        case 4:
            return chance.randbytes(min(count, 4096))
        case _:
            signs: Sequence[str] = '[]{}",:\\0aN .-eE\n'
            return "".join(chance.choices(signs, k=count))
