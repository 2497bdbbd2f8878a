"""What docs/extending.md says, done: its planner, its voice and its page are packages that are
found, checked and used, and what is broken in others is told."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import tomllib
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from nl2robot.cli.main import main
from nl2robot.console.others import others
from nl2robot.errors import UserError
from nl2robot.speech.speak.checker import check_voice
from nl2robot.speech.speak.voices import Sound, VoiceError, joined, voice
from nl2robot.speech.speak.voices import others as other_voices
from nl2robot.station.part import Backstage
from nl2robot.translate import planners
from robot_api import plugins
from tests.console.conftest import serving
from tests.robots.packages import install

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
FILES = dict(re.findall(r"`([\w.]+)`\n```\w+\n(.*?)```", PAGE, re.S))
POINTS: dict[str, dict[str, str]] = {
    group: named
    for source in re.findall(r"```toml\n(.*?)```", PAGE, re.S)
    for group, named in tomllib.loads(source)["project"]["entry-points"].items()
}

Site = Callable[..., Path]


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Site]:
    """Installs a package with an entry point and files, here and for programs begun from here."""
    modules: list[str] = []

    def site(group: str, entry: str, files: dict[str, str]) -> Path:
        folder = install(tmp_path / f"site{len(modules)}", "ward-extra", entry, group, files)
        modules.extend(Path(name).stem for name in files)
        monkeypatch.syspath_prepend(str(folder))
        monkeypatch.setenv("PYTHONPATH", os.pathsep.join((str(folder), str(ROOT))))
        return folder

    planners.planner.cache_clear()
    yield site
    planners.planner.cache_clear()
    for name in modules:
        sys.modules.pop(name, None)


def installed(site: Site, group: str, *files: str) -> None:
    """The example of this group, as it stands on the page."""
    [(name, value)] = POINTS[group].items()
    site(group, f"{name} = {value}", {file: FILES[file] for file in files})


def check(*words: str) -> subprocess.CompletedProcess[str]:
    program = [sys.executable, "-m", "nl2robot.cli.main", *words]
    return subprocess.run(program, capture_output=True, text=True, timeout=100)


def test_the_page_names_every_group_and_its_checker() -> None:
    assert all(f"| `{group}` | `nl2robot " in PAGE for group in plugins.GROUPS)


# --- a planner


def test_the_planner_of_the_page_plans_and_keeps_to_what_is_promised(
    site: Site, capsys: pytest.CaptureFixture[str]
) -> None:
    installed(site, plugins.PLANNERS, "night_planner.py")
    assert main(["translate", "--planner", "night", "please say good night"]) == 0
    assert 'robot.say("Good night.")' in capsys.readouterr().out
    assert main(["plugins", "check", "planner", "night"]) == 0
    assert main(["plugins"]) == 0
    assert "planner night, of the package ward-extra\n" in capsys.readouterr().out


BAD_PLANNER = """
import time
from grammar.planning.planner import Draft, Drafts, Refusal
from grammar.plan import Plan, Call

class Bad:
    name = "bad"
    def plan(self, turn, watch):
        print("thinking")
        if "🙂" in turn.text:
            raise KeyError("smile")
        if "kitchen" in turn.text:
            time.sleep(3)
        if "asdf" in turn.text:
            return "no idea"
        if "1/0" in turn.text:
            return Drafts((Draft(Plan((Call("say", {"text": None}),)), "bad", 2.0, turn.context),))
        return Refusal("")

def broken():
    raise RuntimeError("no weights")
"""


def test_what_is_wrong_with_a_planner_is_told(
    site: Site, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nl2robot.translate.planner_checker.ENDS_WITHIN", 0.1)
    site(plugins.PLANNERS, "bad = bad_planner:Bad", {"bad_planner.py": BAD_PLANNER})
    assert main(["plugins", "check", "planner", "bad"]) == 1
    told = capsys.readouterr().out
    for wrong in (
        "It prints: 'thinking'",
        "It raises at “🙂 🙂” (KeyError",
        "It goes on for more than 0.1 s after it was cancelled",
        "At “asdf qwertz” it answers str",
        "a draft is no whole plan",
        "not sorted by probability",
        "it says nothing to the person",
    ):
        assert wrong in told


def test_a_planner_that_cannot_be_made_is_a_sentence_and_ours_goes_on(
    site: Site, capsys: pytest.CaptureFixture[str]
) -> None:
    site(plugins.PLANNERS, "bad = bad_planner:broken", {"bad_planner.py": BAD_PLANNER})
    with pytest.raises(UserError, match=r"'bad' of the package ward-extra.*no weights.*uninstall"):
        planners.planner("bad")
    assert main(["plugins"]) == 0
    assert "no weights" in capsys.readouterr().out
    assert main(["translate", "stop"]) == 0


# --- a voice


def test_the_voice_of_the_page_hums_and_keeps_to_what_is_promised(site: Site) -> None:
    installed(site, plugins.VOICES, "humming.py")
    humming = voice("en", "hum")
    assert joined(humming.speak("Good morning.")).seconds > 0.5
    assert check_voice(humming, "en") == []
    assert other_voices("de") == ([], {})


class Voice:
    """A voice of which one thing may be wrong."""

    def __init__(self, wrong: str) -> None:
        self.name = self.wrong = wrong

    def speak(self, text: str, **how: Any) -> Iterator[Sound]:
        if self.wrong == "stumbles" and "<" in text:
            raise ValueError("no letter")
        tone = np.sin(np.arange(int(16_000 * 0.07 * len(text))) / 10) * 8_000
        loud = {"quiet": 0.001, "clipped": 1000}.get(self.wrong, 1)
        if self.wrong == "slow":
            tone = np.tile(tone, 9)
        samples = np.clip(tone * loud, -32_767, 32_767).astype(np.int16)
        rate = 4_000 if self.wrong == "low" else 16_000
        stopped = (lambda: False) if self.wrong == "deaf" else how.get("stopped", lambda: False)
        for piece in np.array_split(samples, 8):
            if stopped():
                return
            yield Sound(piece, rate)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ("nothing", None),
        ("low", "Its rate is 4000"),
        ("slow", "were to be expected"),
        ("quiet", "too quiet to be heard"),
        ("clipped", "It is clipped"),
        ("deaf", "after it was stopped"),
        ("stumbles", "It stumbles over '<speak>1</speak>' (ValueError: no letter)"),
    ],
)
def test_what_is_wrong_with_a_voice_is_told(wrong: str, told: str | None) -> None:
    found = check_voice(Voice(wrong), "en")
    assert any(told in each for each in found) if told else found == [], found


def test_a_voice_that_raises_says_so_and_one_that_is_none_is_left_out(site: Site) -> None:
    code = "class V:\n    def speak(self, text, **how):\n        raise OSError('no sound card')\n"
    site(plugins.VOICES, "odd = odd_voice:make", {"odd_voice.py": f"{code}make = lambda c: V()"})
    with pytest.raises(VoiceError, match=r"'odd' cannot speak this.*no sound card"):
        joined(voice("en", "odd").speak("Hello."))
    site(plugins.VOICES, "flat = flat_voice:make", {"flat_voice.py": "make = lambda code: 7"})
    _, troubles = other_voices("en")
    assert "is no Voice: int is something else" in troubles["flat"]


# --- a page of the console


def test_the_page_of_the_page_is_in_the_console_and_keeps_to_what_is_promised(
    site: Site, tmp_path: Path
) -> None:
    installed(site, plugins.PAGES, "ward_visits.py", "ward_visits.yaml")
    checked = check("plugins", "check", "page", "visits")
    assert (checked.returncode, checked.stdout) == (0, "It keeps to what is promised.\n")
    with serving(tmp_path / "home") as served:

        def seen(path: str) -> str:
            request = urllib.request.Request(served.url + path, headers={"Accept-Language": "de"})
            with urllib.request.urlopen(request, timeout=20) as answer:
                return cast(str, answer.read().decode())

        with served.robot() as robot:
            assert robot.request("visits.count", {"people": 3}) == {"today": 3}
        assert re.search(r'<a href="/visits">.*?<span>Besuche</span>', seen("/runs"), re.S)
        assert "Besuch heute: 3" in seen("/visits")


WRONG_PAGE = """
from pathlib import Path
from nicegui import ui
from robot_api.server import Service
from nl2robot.station.part import Link, Part
import threading

TEXTS = Path(__file__).with_suffix(".yaml")

def part(backstage):
    def pages():
        @ui.page("/odd")
        def odd():
            ui.add_head_html('<script src="https://elsewhere.example/x.js"></script>')
        @ui.page("/map/of/ours")
        def ours():
            pass
    return Part(
        services={"odd.do": Service(lambda p, c: None)},
        events={"odd": ""},
        links=[Link(name="odd", address="/odd", icon="", texts=TEXTS)],
        pages=pages,
        close=threading.Event().wait,
    )
"""


def test_what_is_wrong_with_a_page_is_told(site: Site) -> None:
    texts = "title: {en: Odd, de: Seltsam}\nso: {en: 'So {many}', de: 'So', fr: 'Tant'}\n"
    site(plugins.PAGES, "odd = odd_page:part", {"odd_page.py": WRONG_PAGE, "odd_page.yaml": texts})
    checked = check("plugins", "check", "page", "odd")
    assert checked.returncode == 1
    for wrong in (
        "The service 'odd.do' does not say what it does.",
        "The service 'odd.do' takes anything",
        "The event 'odd' does not say",
        "The text 'title' of 'odd' is missing in: fr.",
        "The text 'so' of 'odd' has other gaps",
        "/odd loads https://elsewhere.example/x.js from elsewhere",
        "It has not closed 5 s after",
    ):
        assert wrong in checked.stdout, checked.stdout + checked.stderr


@pytest.mark.parametrize(
    ("name", "made", "sentence"),
    [
        ("odd", "7", "is no Part: int is something else"),
        ("odd", "1 / 0", "cannot be loaded (ZeroDivisionError"),
        ("odd", "Part(events={'program': 'x'})", "adds 'program', which does not begin with 'odd'"),
        ("odd", "Part(services={'robot.stop': None})", "adds 'robot.stop', which does not begin"),
        ("odd", "Part(routes=[Route('/map', print)])", "adds the address '/map'"),
        (
            "odd",
            "Part(links=[Link(name='odd', address='/odd', icon='', texts=Path('x'))])",
            "texts",
        ),
        ("robot", "Part()", "is left out: one of ours has this name"),
        ("runs", "Part()", "is left out: one of ours has this name"),
    ],
)
def test_a_page_that_would_take_what_is_ours_is_left_out(
    site: Site, name: str, made: str, sentence: str
) -> None:
    imports = (
        "from pathlib import Path\nfrom starlette.routing import Route\n"
        "from nl2robot.station.part import Link, Part\n"
    )
    code = f"{imports}def part(backstage):\n    return {made}\n"
    site(plugins.PAGES, f"{name} = odd_page:part", {"odd_page.py": code})
    ours: Any = SimpleNamespace(services={"runs.list": None}, events={}, routes=())
    found = others(cast(Backstage, None), [ours])
    assert not found.parts
    assert sentence in found.troubles[name]
