"""What is like a proper input, and is none: bytes, texts and data with something odd in them.

All of it comes from the dice that are handed in, so it is the same for the same seed.
"""

from __future__ import annotations

import random
import struct
from collections.abc import Sequence
from typing import Any, Final

NUMBERS: Final = (0, -1, 1, 255, 256, 2**15, 2**31 - 1, -(2**31), 2**32, 2**53 + 1, 2**63, 10**400)
FLOATS: Final = (0.5, -0.0, 1e-320, 1e308, float("nan"), float("inf"), float("-inf"), 0.1 + 0.2)
WORDS: Final = (
    "", " ", "\0", "null", "~", "true", "NaN", "1e400", "-.inf", "0x10", "9" * 400,
    "9" * 5000, "a" * 70_000,
    "é\u0301\u0323" * 9, "\u202egotolleh", "\u200b", "\ufeff", "\ufffe", "𝓇𝑜𝒷𝑜𝓉", "🤖" * 40,
    "\x1b[2J", "\r\n", "'", '"', "`$(true)`", "../../etc/passwd", "/dev/zero", "con", "{{7*7}}",
    "%s%n", "<script>", "&#99999999;", "*a", "&a [*a, *a]", "!!python/object:os.system", "- - - -",
    "2026-11-27", "12:30", "١٢٣", "Ⅻ", "½", "ß", "İ", "ﬁ", "\u2028", "\x85", "\x7f", "ﷺ" * 30,
)  # fmt: skip
HALF_A_SIGN: Final = "\ud800"
"""What JSON can say and UTF-8 cannot."""
_PIECES: Final = (b"\0", b"\xff", b"\x80", b"\x7f", b"\n", b"\xfe\xff", b"\xed\xa0\x80", b"{" * 40)
_SIGNS: Final = "[]{}():,;.'\"\\/&*!|>%@`#?=+-_ \n\t0123456789aeiouäéßstnr\0🤖"


def bytes_like(chance: random.Random, samples: Sequence[bytes]) -> bytes:
    """One of the samples with a few bytes changed, cut out, put in or doubled."""
    data = bytearray(chance.choice(samples))
    for _ in range(_few(chance)):
        at = chance.randrange(len(data) + 1)
        match chance.randrange(8):
            case 0 if at < len(data):
                data[at] ^= 1 << chance.randrange(8)
            case 1 if at < len(data):
                data[at] = chance.choice((0, 1, 0x7F, 0x80, 0xFF, chance.randrange(256)))
            case 2:
                del data[at : at + _length(chance)]
            case 3:
                data[at:at] = chance.randbytes(_length(chance))
            case 4:
                data[at:at] = data[at : at + _length(chance)]
            case 5:  # a length or a size, in either order of bytes
                number = chance.choice(NUMBERS[:9]) & 0xFFFF_FFFF
                data[at : at + 4] = struct.pack(chance.choice("<>") + "I", number)
            case 6:
                data[at:at] = chance.choice(_PIECES)
            case _:
                other = chance.choice(samples)
                data[at:] = other[chance.randrange(len(other) + 1) :]
    return bytes(data[: chance.randrange(len(data) + 1)] if chance.random() < 0.1 else data)


def text_like(
    chance: random.Random, samples: Sequence[str], words: Sequence[str] = WORDS, half: bool = False
) -> str:
    """One of the samples with signs or words changed. `half`: with halves of signs, too."""
    text = chance.choice(samples)
    for _ in range(_few(chance)):
        at = chance.randrange(len(text) + 1)
        end = at + _length(chance)
        match chance.randrange(7):
            case 0:
                text = text[:at] + text[end:]
            case 1:
                text = text[:at] + chance.choice(_SIGNS) + text[at + chance.randrange(2) :]
            case 2:
                text = text[:at] + chance.choice(words) + text[at:]
            case 3:
                text = text[:at] + text[at:end] * chance.randrange(2, 20) + text[end:]
            case 4:
                parts = text.split(" ")
                chance.shuffle(parts)
                text = " ".join(parts)
            case 5:
                text = text[:at] + chance.choice(samples)[:at]
            case _:
                odd = HALF_A_SIGN if half else chr(_sign(chance))
                text = text[:at] + odd + text[at:]
    return text


def data_like(
    chance: random.Random, tree: Any, names: Sequence[str] = (), half: bool = False
) -> Any:
    """Data, as JSON has them, with something in them taken for something else. `names`: of fields
    that are known; the tree stays as it is."""
    for _ in range(_few(chance)):
        tree = _changed(chance, tree, names, half)
    return tree


def _changed(chance: random.Random, tree: Any, names: Sequence[str], half: bool) -> Any:
    inside = bool(tree) and isinstance(tree, dict | list)
    if not inside or chance.random() < 0.15:
        return odd(chance, tree, half)
    if isinstance(tree, list):
        copy = list(tree)
        at = chance.randrange(len(copy))
        match chance.randrange(8):
            case 0:
                del copy[at]
            case 1:
                copy.append(copy[at])
            case 2:
                copy.insert(at, odd(chance, copy[at], half))
            case _:
                copy[at] = _changed(chance, copy[at], names, half)
        return copy
    fields = dict(tree)
    name = chance.choice(list(fields))
    match chance.randrange(9):
        case 0:
            del fields[name]
        case 1:
            other = chance.choice([*names, *fields])
            fields[other] = fields[name]
        case 2:
            fields[chance.choice([*WORDS, *names])] = odd(chance, fields[name], half)
        case 3:
            other = chance.choice(list(fields))
            fields[name], fields[other] = fields[other], fields[name]
        case _:
            fields[name] = _changed(chance, fields[name], names, half)
    return fields


def odd(chance: random.Random, instead_of: Any = None, half: bool = False) -> Any:
    """A value that nobody expects."""
    match chance.randrange(9):
        case 0:
            return chance.choice(NUMBERS)
        case 1:
            return chance.choice(FLOATS)
        case 2:
            return [instead_of]
        case 3:
            return {chance.choice(WORDS): instead_of}
        case 4:
            return chance.choice((None, True, False, [], {}))
        case 5:
            return [chance.choice((0, "a", None))] * chance.choice((2, 100, 1001))
        case 6 if half:
            return f"a{HALF_A_SIGN}b"
        case 7 if isinstance(instead_of, str):
            return text_like(chance, [instead_of], half=half)
        case _:
            return chance.choice(WORDS)


def thinned(chance: random.Random, tree: Any, most: int = 6) -> Any:
    """So much of each list, and most of the fields: what is small is read fast."""
    if isinstance(tree, dict):
        return {
            name: thinned(chance, value, most)
            for name, value in tree.items()
            if chance.random() < 0.8 or name == "name"
        }
    if isinstance(tree, list):
        kept = tree if len(tree) <= most else chance.sample(tree, chance.randint(1, most))
        return [thinned(chance, value, most) for value in kept]
    return tree


def _few(chance: random.Random) -> int:
    return min(12, 1 + int(chance.expovariate(0.6)))


def _length(chance: random.Random) -> int:
    return int(2 ** chance.uniform(0, 7))


def _sign(chance: random.Random) -> int:
    """A sign of any script; no half of one."""
    sign = int(2 ** chance.uniform(0, 20.08))
    return sign if sign < 0xD800 or sign > 0xDFFF else 0xFFFD
