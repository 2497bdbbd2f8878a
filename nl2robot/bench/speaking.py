"""How soon the robot speaks, how soon it is silent, and whether simulated people are understood.

python -m nl2robot.bench.speaking
"""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Final

from nl2robot.speech.hear.recogniser import load
from nl2robot.speech.hear.replies import Replies
from nl2robot.speech.speak.loudspeaker import LATENCY, Handed, SoundCard
from nl2robot.speech.speak.people import SimulatedVoices
from nl2robot.speech.speak.speaking import Speaker
from nl2robot.speech.speak.voices import Voice, joined, voice
from robot_api.capabilities.matching import match_answer
from robot_api.capabilities.sound import Asked, Unsure

TEXTS: Final = (
    "Good morning.",
    "Hello Alice, would you like coffee or tea?",
    "The pharmacy is closed today, but the night service can help you. Please ring twice.",
)
DRINKS, WARDS, PLACES, YES_NO = (
    ["coffee", "tea", "water"],
    ["ward a", "ward b", "ward c"],
    ["radiology", "pharmacy", "blood lab", "cafeteria"],
    ["yes", "no"],
)
NUMBERS: Final = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"]
ANSWERS: Final[tuple[tuple[str, list[str], str], ...]] = (
    *((drink, DRINKS, drink) for drink in DRINKS),
    *((f"{drink} please", DRINKS, drink) for drink in DRINKS),
    *((f"i would like {drink}", DRINKS, drink) for drink in DRINKS),
    *((ward, WARDS, ward) for ward in WARDS),
    *((f"the {place}", PLACES, place) for place in PLACES),
    *((f"to the {place} please", PLACES, place) for place in PLACES),
    *((said, YES_NO, "yes") for said in ("yes", "yes please", "of course", "sure", "i do")),
    *((said, YES_NO, "no") for said in ("no", "no thank you", "not now", "i don't", "nope")),
    *((number, NUMBERS, number) for number in NUMBERS),
)
"""What is said, the options, and which of them it is."""
PEOPLE: Final = ("Alice", "Bob", "Clara", "Henry", "Grace", "Noah")


def to_first_sound(chosen: Voice, repeats: int = 5) -> dict[str, float]:
    """Milliseconds until a voice has something to play, median, by text."""
    next(chosen.speak("Hello."))  # loads it

    def once(text: str) -> float:
        began = time.perf_counter()
        next(chosen.speak(text))
        return (time.perf_counter() - began) * 1000

    return {text: statistics.median(once(text) for _ in range(repeats)) for text in TEXTS}


def to_silence(voice_for: Callable[[str], Voice], repeats: int = 10) -> list[float]:
    """Milliseconds from `interrupt` until a sound card (miniaudio's null one) has played what it
    was given before: the call itself, and all that its buffer holds."""
    import miniaudio

    card = SoundCard([miniaudio.Backend.NULL])
    speaker = Speaker(card, voice_for=voice_for)
    taken = []
    for _ in range(repeats):
        heard = card.heard
        utterance = speaker.begin(TEXTS[-1])
        while card.heard == heard:
            utterance.over.wait(0.005)
        began = time.perf_counter()
        speaker.interrupt()
        taken.append((time.perf_counter() - began + LATENCY) * 1000)
    speaker.close()
    return taken


def understood() -> list[tuple[str, str, str, str]]:
    """Each answer as another person says it: who, what, which option it is, which was heard, or
    else the words that were."""
    people = SimulatedVoices(
        replies=Replies(load, lambda language: ()),
        genders={"Alice": "female", "Clara": "female", "Grace": "female"},
        speaker=Speaker(Handed(lambda sound, at: None)),
        clock=lambda: 0.0,
    )
    results = []
    for number, (said, options, meant) in enumerate(ANSWERS):
        person = PEOPLE[number % len(PEOPLE)]
        sound = people.sound_of(person, said, "en")
        heard = people.replies.recognised(sound, Asked("en", None, options))
        words = heard.words if isinstance(heard, Unsure) else heard
        results.append((person, said, meant, match_answer(words, options) or words))
    return results


def main() -> None:
    for kind in ("espeak", "piper"):
        chosen = voice("en", kind)
        for text, milliseconds in to_first_sound(chosen).items():
            seconds = joined(chosen.speak(text)).seconds
            print(f"{kind}: first sound after {milliseconds:.0f} ms ({seconds:.1f} s) {text!r}")
        silent = to_silence(lambda language, chosen=chosen: chosen)  # type: ignore[misc]
        print(f"{kind}: silent after {statistics.median(silent):.0f} ms, at most {max(silent):.0f}")
    results = understood()
    right = [meant == heard for _, _, meant, heard in results]
    wrong = [row for row in results if row[2] != row[3]]
    options = {option for _, options, _ in ANSWERS for option in options}
    mistaken = [row for row in wrong if row[3] in options]
    print(f"answers: {sum(right)} of {len(right)} right, {len(mistaken)} taken for another option")
    for person, said, meant, heard in wrong:
        print(f"  {person} said {said!r} ({meant}), heard {heard!r}")


if __name__ == "__main__":
    main()
