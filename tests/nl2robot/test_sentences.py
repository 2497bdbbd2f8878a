"""Whoever speaks German or French is told in it what the robot's software says in English."""

from __future__ import annotations

import argparse
import ast
import contextlib
import json
import re
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
import yaml

from nl2robot.cli.main import main
from nl2robot.errors import ExitStatus
from nl2robot.knowledge import Knowledge
from nl2robot.run.trouble import error_told, told
from nl2robot.sentences import DATA, GAP, entries, in_language
from robot_api import errors
from robot_api.errors import RobotError
from sim.errors import SimError
from sim.simulation import Simulation
from sim.world.loading import load_world

ROOT = Path(__file__).parents[2]
WHILE_IT_WORKS = {"UnknownPlace", "UnknownPerson", "NotFound", "NotPossible", "Blocked", "TimedOut"}
"""The errors that whoever sent the robot is told of, whatever robot it is."""
AT_ANY_ROBOT = {each.__name__ for each in vars(errors).values() if isinstance(each, type)}
"""The same where the code is of all robots, and not of one that is set up by those who know it."""
SAYING = {
    "sim": WHILE_IT_WORKS,
    "robot_api/capabilities": AT_ANY_ROBOT,
    "robot_api/composed.py": AT_ANY_ROBOT,
    "robot_api/moments.py": AT_ANY_ROBOT,
    "robot_api/robots/link.py": AT_ANY_ROBOT,
    "robot_api/robots/places.py": AT_ANY_ROBOT,
    "robot_api/robots": WHILE_IT_WORKS,
    "nl2robot/console/floor/zones.py": {"UserError"},
    "nl2robot/console/floor/places.py": {"UserError"},
    "nl2robot/console/floor/goals.py": {"UserError"},
    "nl2robot/console/floor/localising.py": {"UserError"},
    "nl2robot/console/drive/helm.py": WHILE_IT_WORKS | {"AccessDenied"},
    "nl2robot/console/face/video.py": WHILE_IT_WORKS,
    "nl2robot/cli": {"UserError", "ArgumentTypeError"},
    "nl2robot/station/accounts.py": {"UserError"},
    "nl2robot/station/certificates.py": {"UserError"},
    "nl2robot/checks/canned.py": {"UserError"},
    "nl2robot/station/world_file.py": {"UserError"},
    "nl2robot/station/robots.py": {"UserError"},
    "nl2robot/building": {"BadBroker"},
    "nl2robot/schedule": {"UserError", "BadRhythm", "BadTrigger", "BookError", "AccessDenied"},
    "nl2robot/proposals": {"UserError", "AccessDenied"},
    "nl2robot/fleet": {"UserError", "BadFleet", "AccessDenied"},
    "nl2robot/station/station.py": {"UserError"},
    "nl2robot/models/catalogue.py": {"ModelError"},
    "nl2robot/translate/planners.py": {"UserError"},
    "nl2robot/speech/audio.py": {"AudioError"},
    "nl2robot/speech/hear/microphone.py": {"AudioError"},
    "nl2robot/speech/speak/voices.py": {"VoiceError"},
}
BEFORE_THERE_IS_A_ROBOT = {
    "The world {} has no map to drive on. Give its places a pose, or choose another world.",
    "The map of {} has too many specks to find ways between. Clean its image, or scale it down.",
    "The robot cannot start at {}, {} in {}: there the map shows no floor."
    " Let it start on free floor.",
}
"""Said to whoever makes a world."""
OF_SOUND_ITSELF = {
    "The file {} is broken, or its sound is not of the kind that browsers record (Opus)."
    " Use a {} file.",
    "The recording {} says that it has {} samples a second in {} channels, which no voice has."
    " It is probably broken; record it again.",
    "Sound with {} samples a second in {} channels cannot be used."
    " Send one channel at 16000 or 48000.",
}
"""Said to whoever sends sound from a program of their own."""

OF_PROGRAMS = {
    GAP.sub("{}", said["en"])
    for said in yaml.safe_load((DATA / "programs.yaml").read_text(encoding="utf-8"))
}
"""Put together by the check of programs: see test_program_sentences.py."""

WITH_ITS_LINE = {"{}:{}: {}."}
"""Of a file, and then a sentence that may be known."""

PUT_TOGETHER = {
    # How a run failed, and then how its stop did.
    "{} The robot has not confirmed that it stands. Use the robot's own button.",
    "Something went wrong inside nl2robot ({})."
    " Run it again with --debug and report what it prints.",
    *("{} speech model", "second {} speech model"),
    # The names of models, as `models.yaml` has them.
    *("speech model Whisper", "small language model", "large language model", "any language"),
    *("neural voices for training", "English, German and French", "English", "German", "French"),
}


def skeleton(sentence: str) -> str:
    return re.sub(r"\{[^}]*\}", "{}", sentence)


def sentences(node: ast.expr | None) -> list[str]:
    """What an expression may come to, with {} for what is filled in; nothing if it is computed."""
    match node:
        case ast.Constant(value=str(text)):
            return [skeleton(text)]  # filled in by `format`
        case ast.JoinedStr(values=values):
            return ["".join(v.value if isinstance(v, ast.Constant) else "{}" for v in values)]  # type: ignore[misc]
        case ast.IfExp(body=one, orelse=other):
            return [*sentences(one), *sentences(other)]
        case ast.BinOp(left=left, op=ast.Add(), right=right):
            return [a + b for a in sentences(left) for b in sentences(right)]
        case _:
            return []


def said_by_argparse() -> set[str]:
    tree = ast.parse(Path(argparse.__file__).read_text(encoding="utf-8"))
    constants = (node for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return {node.value for node in constants if isinstance(node.value, str)}


def files(under: str) -> list[Path]:
    path = ROOT / under
    assert path.exists(), f"{under} is there no more: say where what it said is said now"
    return [path] if path.is_file() else sorted(path.rglob("*.py"))


def raised(path: Path, kinds: set[str]) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Call) and node.args:
            name = getattr(node.func, "id", getattr(node.func, "attr", ""))
            if name in kinds:
                yield from sentences(node.args[0])


KNOWN = {skeleton(entry.said["en"]) for entry in entries()} | {"{}"}


@pytest.mark.parametrize("under", SAYING)
def test_every_error_that_people_are_told_of_has_its_sentence_in_each_language(under: str) -> None:
    said = {text for path in files(under) for text in raised(path, SAYING[under])}
    untold = BEFORE_THERE_IS_A_ROBOT | OF_SOUND_ITSELF | WITH_ITS_LINE
    assert said - KNOWN - untold == set()


def test_no_sentence_is_kept_that_nothing_says_any_more() -> None:
    code = {
        text
        for folder in ("sim", "robot_api", "nl2robot")
        for path in files(folder)
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.expr)
        for text in sentences(node)
    }
    code |= {text.strip("\n") for text in code}
    code |= {re.sub(r"%(?:\(\w+\))?[rs]", "{}", text) for text in said_by_argparse()}
    gone = KNOWN - code - PUT_TOGETHER - OF_PROGRAMS
    assert gone == set()


@pytest.mark.parametrize("entry", entries(), ids=lambda entry: entry.said["en"][:40])
def test_each_language_tells_it_whole_and_fills_no_gap_that_there_is_not(entry) -> None:
    assert set(entry.said) == {"en", "de", "fr"}
    for text in entry.said.values():
        assert set(GAP.findall(text)) <= set(GAP.findall(entry.said["en"]))


# --- a ward that speaks German -------------------------------------------------------------------


@pytest.fixture(scope="module")
def knowledge() -> Knowledge:
    return Knowledge(load_world("city-hospital"))


@pytest.mark.parametrize(
    ("error", "german", "french"),
    [
        (
            'NotPossible: pharmacy lies in the keep-out zone "wet floor". Choose another place, or'
            " have the zone removed.",
            "Die Apotheke liegt in der Sperrzone „wet floor“. Wählen Sie einen anderen Ort, oder"
            " lassen Sie die Zone entfernen.",
            "C'est dans la zone interdite « wet floor » : la pharmacie. Choisissez un autre lieu,"
            " ou faites enlever la zone.",
        ),
        (
            "Blocked: The way to emergency room is blocked: the door of pharmacy is closed. Have it"
            " opened, or choose another place.",
            "Der Weg zur Notaufnahme ist versperrt, weil dies geschlossen ist: die Tür von der"
            " Apotheke. Lassen Sie öffnen, oder wählen Sie einen anderen Ort.",
            "Le chemin n'est pas libre (les urgences), car ceci est fermé : la porte de la"
            " pharmacie. Faites ouvrir, ou choisissez un autre lieu.",
        ),
        (
            "Blocked: There is no way for the robot from the point 1.5, 2.0 to kitchen. Choose"
            " another place.",
            "Für den Roboter gibt es keinen Weg vom Punkt 1,5; 2,0 zur Küche. Wählen Sie einen"
            " anderen Ort.",
            "Il n'y a pas de chemin pour le robot d'ici (le point 1,5 ; 2,0) jusque-là (la"
            " cuisine). Choisissez un autre lieu.",
        ),
        (
            "Blocked: Bob is in the way after 0.5 metres. Turn first, or drive to a place instead.",
            "Im Weg ist nach 0,5 Metern Bob. Drehen Sie den Roboter zuerst, oder schicken Sie ihn"
            " an einen Ort.",
            "Obstacle après 0,5 mètres : Bob. Tournez d'abord le robot, ou envoyez-le à un lieu.",
        ),
        (
            'NotPossible: The robot does not hold "red cup". It holds the stapler.',
            "Der Roboter hält nicht „rote Tasse“. Er hält den Hefter.",
            "Le robot ne tient pas « tasse de couleur rouge ». Il tient l'agrafeuse.",
        ),
        (
            "LostConnection: The robot has not answered for 5 seconds. See that it is switched on"
            " and in the network.",
            "Der Roboter antwortet seit 5 Sekunden nicht. Sehen Sie nach, ob der Roboter"
            " eingeschaltet und im Netz ist.",
            "Le robot ne répond plus depuis 5 secondes. Vérifiez que le robot est allumé et"
            " connecté au réseau.",
        ),
        (
            "NotSupported: I do not speak the language 'it'. I speak English, German and French.",
            "Die Sprache „it“ spreche ich nicht. Wählen Sie eine von diesen: Englisch, Deutsch und"
            " Französisch.",
            "Je ne parle pas la langue « it ». Choisissez une de celles-ci : anglais, allemand et"
            " français.",
        ),
    ],
)
def test_an_error_is_told_with_what_it_is_about(
    error: str, german: str, french: str, knowledge: Knowledge
) -> None:
    assert error_told(error, "de", knowledge.lexicon("de")) == german
    assert error_told(error, "fr", knowledge.lexicon("fr")) == french


def test_a_driver_of_somebody_else_is_told_in_its_own_words_behind_what_they_mean() -> None:
    told_so = told("Blocked", "My left track is off.", "de")
    assert told_so == "Der Weg ist versperrt. (My left track is off.)"
    assert in_language("My left track is off.", "de") is None


def test_the_simulated_robot_says_what_is_known_here(knowledge: Knowledge) -> None:
    simulation = Simulation(knowledge.world)
    attempts: list[Callable[[], object]] = [
        lambda: simulation.locate("nowhere"),
        lambda: simulation.localize(500.0, 500.0, 0.0),
        lambda: simulation.run(simulation.grab("unicorn"), threading.Event()),
        lambda: simulation.run(simulation.put("cup"), threading.Event()),
        lambda: simulation.run(simulation.follow("Bob"), threading.Event()),
        lambda: simulation.run(simulation.move(30.0), threading.Event()),
        lambda: simulation.run(simulation.drive_to(500.0, 500.0), threading.Event()),
    ]
    for attempt in attempts:
        with pytest.raises(SimError) as caught:
            attempt()
        assert in_language(str(caught.value), "fr", knowledge.lexicon("fr")), str(caught.value)


def test_a_failed_call_goes_through_the_log_without_losing_what_it_is_about(
    knowledge: Knowledge,
) -> None:
    """As over the wire and out of an old log: the sentence is all that is left of the error."""
    error = RobotError('There is no place called "ward z" on this map. Choose one of the places'
                       " that the map names.")  # fmt: skip
    kept = json.loads(json.dumps(f"UnknownPlace: {error}"))
    assert error_told(kept, "de", knowledge.lexicon("de")).startswith(
        "Einen Ort namens „ward z“ gibt es auf dieser Karte nicht."
    )


# --- a terminal that speaks French ---------------------------------------------------------------


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("run", "--wrld", "ward", "--lang", "de"), "Das ist hier nicht bekannt: --wrld"),
        (("run", "--speed", "-1", "--lang=fr", "hi"), "'-1' n'est pas un nombre au-dessus de 0"),
        (("listen", "--lang", "de"), "Eines davon muss angegeben werden: --wav --mic"),
        (("listen", "--lang", "fr", "--wav", "no.wav"), "L'enregistrement no.wav n'est pas là."),
        (("log", "--replay"), "Dites quelle exécution répéter : nl2robot log NUMÉRO --replay."),
        (("models", "get", "xx"), "Il n'y a pas de modèle « xx ». Choisissez parmi : en, de,"),
        (("translate", "--world", "nix", "--lang", "de", "hallo"), "nix: Eine solche Welt gibt es"),
    ],
)
def test_what_the_commands_say_is_in_the_language_asked_for_else_the_terminals(
    arguments: tuple[str, ...],
    told: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("LC_ALL", "fr_FR.UTF-8")
    monkeypatch.setattr("nl2robot.cli.commands.listen.need", lambda code: None)
    monkeypatch.setattr("nl2robot.cli.commands.listen.lacking_beside", lambda code: ())
    hearing = SimpleNamespace(recording=None)
    monkeypatch.setattr("nl2robot.cli.commands.listen._hearing", lambda options: hearing)
    with contextlib.suppress(SystemExit):
        assert main(arguments) == ExitStatus.BAD_INPUT
    err = capsys.readouterr().err
    assert told in err
    assert "usage:" not in err and "error:" not in err


def test_whoever_says_nothing_of_a_language_reads_english(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("LC_ALL", "C")
    assert main(("models", "get", "xx")) == ExitStatus.BAD_INPUT
    assert capsys.readouterr().err.startswith("There is no model called “xx”.")
    with pytest.raises(SystemExit):
        main(("run", "--wrld"))
    assert "error: unrecognized arguments: --wrld" in capsys.readouterr().err


@pytest.mark.parametrize("language", ["de", "fr"])
def test_a_sentence_made_to_take_long_does_not(language: str) -> None:
    """Anybody on the wire may have one told; while one is looked at nobody's stop is heard."""
    for entry in entries():
        first, *rest = entry.fixed
        hostile = first + "".join(
            (fixed or " ") * (20_000 // len(fixed or " ")) for fixed in rest[:-1]
        )
        in_language(f"{hostile}\0", language)
