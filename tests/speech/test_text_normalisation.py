"""What the robot says is spoken as people speak: times, doses, rooms, names, in three languages."""

import contextlib
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from grammar.language import languages
from nl2robot.speech.speak.aloud import aloud
from nl2robot.speech.speak.text_normalisation import as_spoken
from nl2robot.speech.speak.wishes import Wishes
from nl2robot.station.robots import _of_its_own
from robot_api.capabilities.base import Hub
from robot_api.capabilities.sound import Sound
from robot_api.capabilities.speech import LoudspeakerSpeech
from robot_api.driver import StopFlag
from robot_api.robots.ros.voice import RosSpeech
from sim.world.loading import load_world

CASES = {
    language: yaml.load(
        (Path(__file__).parent / "spoken" / f"{language}.yaml").read_text(encoding="utf-8"),
        Loader=yaml.BaseLoader,  # "at 1:15" is no number here, nor is "no" False
    )
    for language in languages()
}


@pytest.mark.parametrize(
    ("language", "written", "spoken"),
    [(language, *case) for language, cases in CASES.items() for case in cases.items()],
)
def test_it_is_spoken_as_people_speak(language, written, spoken) -> None:
    assert as_spoken(written, language) == spoken
    assert as_spoken(spoken, language) == spoken


@pytest.mark.parametrize("language", languages())
def test_there_are_many_cases(language) -> None:
    assert len(CASES[language]) >= 60


LANGUAGES = st.sampled_from(languages())
FIGURES = st.text("0123456789.,:-/+%°€$ hmgCkx²'()#@eaApnth", max_size=40)


@given(LANGUAGES, st.one_of(FIGURES, st.text(max_size=60)))
def test_no_figure_is_left_and_a_second_time_changes_nothing(language, written) -> None:
    once = as_spoken(written, language)
    assert not any(sign.isdecimal() for sign in once)
    assert as_spoken(once, language) == once


@given(LANGUAGES, st.integers(0, 23), st.integers(0, 59))
def test_every_time_is_said_in_words(language, hour, minute) -> None:
    told = as_spoken(f"{hour}:{minute:02}", language)
    assert told and not any(sign.isdecimal() or sign == ":" for sign in told)


@given(LANGUAGES, st.lists(st.text("abcdefghijklmnopqrstuvwxyzäöüéèà", min_size=1), min_size=1))
def test_words_stay_as_they_are(language, words) -> None:
    text = " ".join(words)
    assert as_spoken(text, language) == text


def test_a_language_without_rules_is_spoken_as_it_is_written() -> None:
    assert as_spoken("a las 13:00", "es") == "a las 13:00"


# --- whatever speaks ----------------------------------------------------------------------------

WRITTEN, SPOKEN = "Um 13:00 in Zimmer 101.", "Um dreizehn Uhr in Zimmer hunderteins."


class Hears:
    """A loudspeaker, and a robot's own voice."""

    def __init__(self) -> None:
        self.heard: list[str] = []

    @contextlib.contextmanager
    def speaking(self, stop, text, language, volume):
        self.heard.append(text)
        yield


@pytest.fixture
def hub():
    """Where events come by; `told` has the texts of what is shown and logged."""
    hub = Hub()
    hub.told = []
    hub.subscribe(lambda kind, data: hub.told.append(data["text"]))
    return hub


def test_the_servers_voice_speaks_it_and_the_page_shows_it(hub) -> None:
    loudspeaker = Hears()
    voice = LoudspeakerSpeech(hub, Sound(loudspeaker, spoken=as_spoken))
    voice.say(StopFlag(), WRITTEN, "de")
    assert (loudspeaker.heard, hub.told) == ([SPOKEN], [WRITTEN])


def test_a_robot_with_ros_speaks_it(hub) -> None:
    own = Hears()
    say = lambda stop, text, language: own.heard.append(text)  # noqa: E731
    RosSpeech(hub, say, ["de"], Sound(spoken=as_spoken)).say(StopFlag(), WRITTEN)
    assert (own.heard, hub.told) == ([SPOKEN], [WRITTEN])


def test_pepper_speaks_it(hub) -> None:
    reason = "qi has no wheel for this Python"
    PepperSpeech = pytest.importorskip("robot_api.robots.pepper.voice", reason=reason).PepperSpeech

    class Wire(Hears):
        def call(self, service, method, *arguments, within=None):
            return {"getAvailableLanguages": ["German"], "getLanguage": "German"}.get(method)

        def run(self, stop, service, method, text, *arguments, ending=()):
            self.heard.append(text)

    wire = Wire()
    PepperSpeech(wire, hub, Sound(spoken=as_spoken), animated=False).say(StopFlag(), WRITTEN)
    assert (wire.heard, hub.told) == ([SPOKEN], [WRITTEN])


def test_every_robot_is_given_it(tmp_path) -> None:
    sound = _of_its_own(Sound(), load_world("ward"))
    assert sound.spoken(WRITTEN, "de") == SPOKEN
    wishes = Wishes(speak=tmp_path / "said.wav", language="de")
    with aloud(wishes, load_world("ward")) as sound_for:
        assert sound_for(lambda: 0.0).spoken(WRITTEN, "de") == SPOKEN
