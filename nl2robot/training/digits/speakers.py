"""Who says digits in the training of the ear for them: native speakers and such with accents.

    for spoken in neural("en"): spoken.digit, spoken.sound    # Kokoro's speakers
    for spoken in robotic("en"): ...                          # espeak-ng's

An accent is an English word as somebody would write it who writes another language as they speak
it, read by a voice of that language.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Final, TypeVar

import numpy as np

from nl2robot.bench.kokoro import Kokoro, speakers
from nl2robot.speech import scenes
from nl2robot.speech.audio import from_float
from nl2robot.speech.digits import classifier as digits
from nl2robot.speech.scenes import Signal
from nl2robot.speech.speak.voices import Voice, espeak, joined

NONE: Final = len(digits.DIGITS)
"""What is said is no digit."""
_NATIVE: Final = {
    "en": (
        *("en-us", "en-us", "en-gb-x-rp", "en-gb-scotland", "en-029", "en-us-nyc"),
        "en-gb-x-gbclan",
    ),
    "fr": ("fr", "fr-be", "fr-ch"),
    "de": ("de",),
}
"""Languages of espeak-ng."""
_WORDS: Final = {
    "en": "zero one two three four five six seven eight nine",
    # Kokoro lacks the short ü.
    "de": "null eins zwei/zwo drei vier fühnf sechs sieben acht neun",
    "fr": "zéro un/une deux trois quatre cinq six sept huit neuf",
}
_ACCENTS: Final = {
    "en": {
        "de": "siero/sero/ziro wann tu sri/fri/tri foor/voor faif ßicks/sicks sevven/sewwen eet/ejt"
        " nein",
        "fr": "ziro/zéro ouane tou sri/fri/zri/tri faure faïve/faïf sixe sévène ète/eïte naïne",
        "el": "ζίρο/ζέρο ουάν του θρι/τρι φορ φάιβ σιξ σέβεν έιτ νάιν",
        "it": "ziro/siro uan tu tri for faiv six seven/sèven eit/èit nain",
        "es": "siro uan tu tri for faif six seven eit nain",
        "hi": "ज़ीरो वन टू थ्री फोर फाइव सिक्स सेवन एट नाइन",
        "nl": "ziero wan toe srie/trie foor faaif siks seven/sevven eet nain",
        "pl": "ziro łan tu sri/tri/fri for fajf syks sewen ejt najn",
        "ru": "зиро уан ту сри/зри/фри фор файв сикс сэвен эйт найн",
        "tr": "ziro van tu tri/sri for fayv siks sevın eyt nayn",
        "sv": "siro oann to tri får fajv sicks sevven ejt najn",
        "ar": "زيرو وان تو ثري فور فايف سيكس سيفن ايت ناين",
    }
}
_OWN: Final = {"e": "es", "f": "fr", "h": "hi", "i": "it"}
"""The language of a speaker of Kokoro, by the first letter."""
_ENGLISH: Final = "ab"  # first letters of those of English
_VARIANTS: Final = (
    *("", "m1", "m2", "m3", "m4", "m5", "m6", "m7", "m8", "f1", "f2", "f3", "f4", "f5"),
    *("Alex", "Andy", "Annie", "Mario", "Michael", "belinda", "edward", "linda", "steph"),
)
_MARKS: Final = ("", ".", " .", "?", "!", "...")
"""A neural voice speaks otherwise before each."""
_OTHERS: Final = {
    "en": "no, yes, hello, yeah, okay, hmm, um, uh, hi, stop, help, what, when, thank you, please,"
    " later, maybe, I don't know, never mind, ten, eleven, twelve, twenty, hundred, good, tea,"
    " coffee, hey robot, go, sure, not now, sorry, pardon, what time, come here, over there,"
    " the door, a few, many, left, back, down, up, really, see you, bye, oops, wow, the nurse,"
    " room, key, bed, bus, cat, success",
    "de": "ja, hallo, bitte, danke, doch, gut, hm, äh, halt, hilfe, warum, was, wann, zehn, elf,"
    " zwölf, zwanzig, hundert, links, rechts, weiter, tee, kaffee, tür, oben, unten, noch nicht,"
    " vielleicht, weiß nicht, ich, du, das, los, komm, sieh mal, wo, so, schön, tschüss, zimmer,"
    " bett, bus, katze, sonne, später, na ja",
    "fr": "oui, non, bonjour, merci, pardon, hein, stop, aide, pourquoi, quand, dix, onze, douze,"
    " vingt, gauche, encore, thé, café, porte, bien, bon, là, ici, plus tard, peut-être,"
    " je ne sais pas, le, la, les, viens, regarde, où, beau, salut, chambre, lit, bus, chat,"
    " soleil, vite, d'accord, pas du tout",
}
"""What is no digit. Words that sound like one are left out: where one is expected, it was one."""
_ROBOTIC_SHARE: Final = 0.25
_Item = TypeVar("_Item")


@dataclass(frozen=True, eq=False)
class Spoken:
    """A word without the quiet around it."""

    digit: int  # or `NONE`
    sound: Signal


def neural(language: str, times: int) -> Iterator[Spoken]:
    """Each of Kokoro's speakers says each digit so many times, in English nearly half of them with
    an accent. They say nothing else: with 640 words of theirs that are no digit, an ear heard a
    person who speaks fast less well."""
    for speaker in speakers():
        for digit in range(NONE):
            for time in range(times):
                spoken_in, text, speed = _saying(language, speaker, digit, time)
                sound = trimmed(Kokoro(speaker, spoken_in), text, speed)
                if sound is not None:
                    yield Spoken(digit, sound)


def robotic(language: str, rng: np.random.Generator) -> Iterator[Spoken]:
    """The speakers of espeak-ng, a part of what they might say, and what is no digit."""
    sayings = [
        (digit, dialect, variant, word)
        for digit, words in enumerate(_WORDS[language].split())
        for dialect in sorted(set(_NATIVE[language]))
        for variant in _VARIANTS
        for word in dict.fromkeys(words.split("/"))
    ]
    for accent, words in _ACCENTS.get(language, {}).items():
        sayings += [
            (digit, accent, _one(_VARIANTS, rng), word)
            for digit, ways in enumerate(words.split())
            for word in ways.split("/")
            for _ in range(5)
        ]
    sayings = [saying for saying in sayings if rng.random() < _ROBOTIC_SHARE]
    for text in _others(language):
        native = [_one(_NATIVE[language], rng) for _ in range(6)]
        sayings += [(NONE, dialect, _one(_VARIANTS, rng), text) for dialect in native]
    for digit, dialect, variant, text in sayings:
        speed, pitch = float(rng.uniform(0.75, 1.3)), float(rng.uniform(0.7, 1.4))
        sound = trimmed(espeak(dialect, variant), text, speed, pitch)
        if sound is not None:
            yield Spoken(digit, sound)


def _saying(language: str, speaker: str, digit: int, time: int) -> tuple[str, str, float]:
    """The language of espeak-ng, the text and the speed."""
    rng = _chance(f"{language}{speaker}{digit}{time}")
    accents = _ACCENTS.get(language, {})
    if accents and rng.random() < (0.45 if speaker[0] in _ENGLISH else 0.6):
        own = _OWN.get(speaker[0], "")
        spoken_in = own if own in accents and rng.random() < 0.5 else _one(list(accents), rng)
        words = accents[spoken_in]
    else:
        spoken_in, words = _one(_NATIVE[language], rng), _WORDS[language]
    text = _one(words.split()[digit].split("/"), rng) + _one(_MARKS, rng)
    return spoken_in, text, float(np.exp(rng.uniform(np.log(0.75), np.log(1.4))))


def _others(language: str) -> list[str]:
    return [" ".join(text.split()) for text in _OTHERS[language].split(",")]


def trimmed(voice: Voice, text: str, speed: float, pitch: float = 1.0) -> Signal | None:
    """What a voice says, of a peak of 0.5; None where it says nothing."""
    said = joined(voice.speak(text, speed=speed, pitch=pitch))
    frames = (said.samples.reshape(-1, 1) / 32768).astype(np.float32)
    sound = scenes.signal(from_float(frames, said.rate))
    if not len(sound) or np.abs(sound).max() < 1e-3:
        return None
    sound = digits.cut(sound, 0.02)
    return np.asarray(sound * (0.5 / np.abs(sound).max()), np.float32)


def _one(several: Sequence[_Item], rng: np.random.Generator) -> _Item:
    return several[int(rng.integers(len(several)))]


def _chance(what: str) -> np.random.Generator:
    """The same for the same words, so that nobody's words depend on what others say."""
    return np.random.default_rng([ord(letter) for letter in what])
