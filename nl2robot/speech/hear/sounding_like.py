"""Words that sound like a name of the world: who is not understood may have said that.

    next(respelled("bring me the fourth", ["fork", "cup"], "en"))    # "bring me the fork"

A recogniser prefers the words that people say most; where there are forks and the sentence makes no
sense otherwise, "fourth" was "fork". Sounds are espeak-ng's; without it nothing is respelled.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator
from functools import lru_cache
from typing import Final

from nl2robot.speech.speak.voices import VoiceError, phonemes

LONGEST: Final = 3
"""Words of a name, or of what was heard instead of it."""
SOUNDS_A_SLIP: Final = 4
"""One sound in so many may be another; of fewer than three, none."""
_LEAST: Final = 3
_STRESS: Final = re.compile(r"[ˈˌːˑ.\s\-_|]")


def respelled(
    text: str, names: Iterable[str], language: str, stay: Collection[str] = ()
) -> Iterator[str]:
    """The text with a name in the place of words that sound much like it, the nearest first. Words
    that `stay` are names themselves: "patient" is no "Peyton"."""
    from rapidfuzz.distance import Levenshtein

    words = text.split()
    known = [(name, sound) for name in names if (sound := sounds(name.lower(), language))]
    if not known:
        return
    called = {name.lower() for name, _ in known}
    found: list[tuple[float, int, str]] = []
    for length in range(1, min(LONGEST, len(words)) + 1):
        for at in range(len(words) - length + 1):
            heard = " ".join(words[at : at + length]).lower().strip(".,!?")
            if heard in called or heard in stay:
                continue
            sound = sounds(heard, language)
            for name, named in known:
                most = (max(len(sound), len(named)) + 1) // SOUNDS_A_SLIP
                if min(len(sound), len(named)) < _LEAST or most == 0:
                    continue
                slips = Levenshtein.distance(sound, named, score_cutoff=most)
                if slips <= most:
                    instead = " ".join((*words[:at], name, *words[at + length :]))
                    found.append((slips / len(named), len(found), instead))
    yield from dict.fromkeys(instead for _, _, instead in sorted(found))


def sounds(words: str, language: str) -> str:
    """The sounds of some words, a letter of the IPA each; empty where nobody can tell."""
    try:
        return _told(words, language)
    except VoiceError:  # not kept: what tells may be there again the next time
        return ""


@lru_cache(maxsize=4096)
def _told(words: str, language: str) -> str:
    return _STRESS.sub("", phonemes(words, language))
