"""A ward teaches its robot routines: by name, kept on disk, shown before they are used."""

import json
import threading

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from grammar.language import languages, speech
from nl2robot.cli.main import main
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.routines import Routines, open_routines
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

ROUND = "go to every ward and say good night"
PROGRAM = (
    'for place in robot.places("ward"):\n    robot.goto(place)\n    robot.say("Good night.")\n'
)


class Nurse:
    """Somebody in conversation with a robot of the city hospital."""

    def __init__(
        self, routines: Routines, world: str = "city-hospital", language: str = "en"
    ) -> None:
        self.language = language
        self.knowledge = Knowledge(load_world(world), routines=routines)
        self.talk = Talk()

    def says(self, words: str):
        return translate(words, self.knowledge, self.language, talk=self.talk)

    def teaches(self, name: str, sentence: str):
        asked = self.says(f"when I say {name}, {sentence}")
        assert asked.status == "clarify", asked.message
        return self.says("yes, please")


@pytest.fixture
def routines(tmp_path) -> Routines:
    return Routines(tmp_path / "routines.yaml")


@pytest.fixture
def nurse(routines) -> Nurse:
    return Nurse(routines)


# --- learning and using


def test_a_routine_is_shown_before_it_is_kept(nurse, routines) -> None:
    asked = nurse.says(f"when I say evening round, {ROUND}")
    assert (asked.status, asked.program) == ("clarify", None)
    assert "“Good night.”" in asked.message  # all it would do
    assert asked.request.kind == "learn"
    assert routines.known() == ()
    told = nurse.says("yes")
    assert told.status == "ok"
    [kept] = routines.known("en")
    assert (kept.name, kept.sentence) == ("evening round", ROUND)


@pytest.mark.parametrize("answer", ["no", "never mind", "cancel that"])
def test_without_a_yes_nothing_is_kept(nurse, routines, answer) -> None:
    nurse.says(f"when I say evening round, {ROUND}")
    assert nurse.says(answer).status == "ok"
    assert routines.known() == ()
    nurse.says("yes")  # comes too late
    assert routines.known() == ()


def test_who_goes_on_with_something_else_has_not_agreed(nurse, routines) -> None:
    nurse.says(f"when I say evening round, {ROUND}")
    assert nurse.says("go to the pharmacy").program == 'robot.goto("pharmacy")\n'
    nurse.says("yes")
    assert routines.known() == ()


@pytest.mark.parametrize(
    "words",
    [
        f"whenever I say evening round, {ROUND}",
        f"when i say evening round {ROUND}",  # spoken: no comma
        f'hey robot, when I say "evening round", {ROUND}',
        f"please learn a new routine called evening round: {ROUND}",
        f"the routine evening round means: {ROUND}",
        f"Can you save the routine evening round, {ROUND}",
    ],
)
def test_people_teach_in_many_ways(nurse, words) -> None:
    request = nurse.says(words).request
    assert (request.kind, request.name, request.sentence) == ("learn", "evening round", ROUND)


def test_the_command_before_can_be_kept(nurse) -> None:
    nurse.says("go to the pharmacy and wave")
    nurse.says("save that as morning visit")
    nurse.says("yes")
    visit = nurse.says("do the morning visit").program
    assert visit == 'robot.goto("pharmacy")\nrobot.gesture("wave")\n'


def test_every_step_of_a_routine_stands_in_the_program(nurse) -> None:
    nurse.teaches("evening round", ROUND)
    assert nurse.says("evening round").program == PROGRAM
    assert nurse.says("Do the Evening Round, please!").program == PROGRAM
    longer = nurse.says("do the evening round and then go to the charger").program
    assert longer == PROGRAM + 'robot.goto("charger")\n'  # not to the charger from each ward
    under = nurse.says("if you see Alice, do the evening round").program
    assert under.startswith('if robot.sees("Alice"):\n    for place')
    assert "robot.dock" not in under


def test_a_routine_is_a_command_among_others(nurse) -> None:
    nurse.teaches("silly dance", "wave and turn around")
    program = nurse.says("go to the lobby, do the silly dance twice and say hello").program
    assert program == (
        'robot.goto("lobby")\n'
        "for repetition in range(2):\n"
        '    robot.gesture("wave")\n'
        "    robot.turn(180)\n"
        'robot.say("Hello!")\n'
    )
    assert nurse.says("say silly dance").program == 'robot.say("Silly dance.")\n'


def test_come_back_in_a_routine_is_back_to_where_it_began(nurse) -> None:
    nurse.teaches("tea time", "go to the kitchen and come back")
    program = nurse.says("go to the lobby, do the tea time, then come back").program
    assert program == (
        "start = robot.location()\n"
        'robot.goto("lobby")\n'
        "start2 = robot.location()\n"
        'robot.goto("kitchen")\n'
        "robot.goto(start2)\n"
        "robot.goto(start)\n"
    )
    assert nurse.says("tea time").program.startswith("start = robot.location()\n")


def test_routines_are_made_of_routines_but_not_of_themselves(nurse) -> None:
    nurse.teaches("evening round", ROUND)
    nurse.teaches("night shift", "do the evening round and go to the charger")
    assert nurse.says("night shift").program == PROGRAM + 'robot.goto("charger")\n'
    for sentence in ("do the evening round and wave", "do the night shift"):
        assert nurse.says(f"change evening round to {sentence}").status == "rejected"
    itself = nurse.says("when I say endless walk, go to the lobby and do the endless walk")
    assert itself.status == "rejected"
    assert "without end" in itself.message


def test_what_is_not_understood_is_not_learned(nurse) -> None:
    for words in (
        "when I say moon trip, fly me to the moon",
        "when I say moon trip, bla bla bla",
        'learn the routine "moon trip" swim through the lake',
    ):
        refused = nurse.says(words)
        assert refused.status == "rejected", words
        assert "moon trip" in refused.message
        assert nurse.talk.pending is None


# --- names


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("pharmacy", "a place"),
        ("Alice", "a person"),
        ("stapler", "a thing"),
        ("wards", "otherwise"),
        ("go to the lobby", "a command already"),
        ("stop", "a command already"),
        ("and then", "words of commands"),
        ("say", "words of commands"),
        ("one two three four five six", "too long"),
    ],
)
def test_a_name_that_means_something_else_is_refused(nurse, name, why) -> None:
    refused = nurse.says(f'learn the routine "{name}": wave')
    assert refused.status == "rejected", refused
    assert why in refused.message


def test_nothing_is_overwritten_in_silence(nurse, routines) -> None:
    nurse.teaches("evening round", ROUND)
    asked = nurse.says("when I say Evening Round, go to the lobby")
    assert asked.status == "clarify"
    assert "already" in asked.message
    assert "Good night." in asked.message  # what it does now
    assert "lobby" in asked.message  # what it would do
    nurse.says("no")
    assert routines.get("evening round", "en").sentence == ROUND
    nurse.says("change the evening round to go to the lobby")
    nurse.says("ok")
    assert nurse.says("evening round").program == 'robot.goto("lobby")\n'
    assert "just so" in nurse.says("when I say evening round, go to the lobby").message


# --- listing, explaining, forgetting


def test_routines_are_listed_and_explained(nurse) -> None:
    assert "no routines" in nurse.says("what routines do you know?").message
    nurse.teaches("evening round", ROUND)
    listed = nurse.says("what routines do you know?")
    assert (listed.status, listed.program) == ("ok", None)
    assert "evening round" in listed.message
    for words in ("explain evening round", "what does the evening round do?"):
        assert ROUND in nurse.says(words).message, words
    unknown = nurse.says("explain the routine morning round")
    assert unknown.status == "rejected"
    assert "morning round" in unknown.message


def test_forgetting_asks_and_tells_what_else_would_break(nurse, routines) -> None:
    nurse.teaches("evening round", ROUND)
    nurse.teaches("night shift", "do the evening round and go to the charger")
    asked = nurse.says("forget the evening round")
    assert asked.status == "clarify"
    assert "night shift" in asked.message
    nurse.says("yes")
    assert [each.name for each in routines.known()] == ["night shift"]
    broken = nurse.says("night shift")
    assert broken.status == "rejected"
    assert "“night shift” cannot be used" in broken.message
    assert nurse.says("forget the routine tea dance").status == "rejected"


def test_a_routine_at_set_times_is_no_program_for_now(nurse) -> None:
    nurse.teaches("evening round", ROUND)
    for words, when in (
        ("every morning at eight do the evening round", "every day at 08:00"),
        ("do the evening round every day at half past ten", "every day at 10:30"),
    ):
        planned = nurse.says(words)
        assert (planned.status, planned.program) == ("ok", None)
        assert planned.schedule.when == when
        assert 'robot.say("Good night.")' in planned.schedule.program
        assert "Nothing is planned before somebody has approved it" in planned.message


def test_set_times_that_cannot_be_told_are_refused_with_the_part(nurse) -> None:
    refused = nurse.says("every other week go to ward a")
    assert (refused.status, refused.program, refused.schedule) == ("rejected", None, None)


def test_a_routine_follows_the_world_and_says_where_it_cannot(nurse, routines) -> None:
    nurse.teaches("pill trip", "go to the cafeteria and say hello")
    elsewhere = Nurse(routines, "lab-tour").says("pill trip")
    assert elsewhere.status == "rejected"
    assert "cafeteria" in elsewhere.message


def test_where_nothing_can_be_kept_it_says_so() -> None:
    knowledge = Knowledge(load_world("ward"))
    refused = translate("when I say tea dance, wave", knowledge)
    assert (refused.status, refused.program) == ("rejected", None)
    assert "cannot keep" in refused.message


# --- in every language

STORIES = {
    "en": {
        "teach": "when I say tea dance, wave and turn around",
        "yes": "yes, please",
        "use": "do the tea dance, then go to the charger",
        "list": "what routines do you know?",
        "explain": "what does the tea dance do?",
        "times": "do the tea dance every evening at nine",
        "change": "change the tea dance to wave",
        "no": "no",
        "forget": "forget the tea dance",
        "help": "what can I say?",
        "place": "when I say pharmacy, wave",
    },
    "de": {
        "teach": "wenn ich Tanztee sage, wink und dreh dich um",
        "yes": "ja, bitte",
        "use": "mach den Tanztee und fahr dann zum Ladegerät",
        "list": "welche Routinen kennst du?",
        "explain": "was macht der Tanztee?",
        "times": "mach jeden Abend um neun den Tanztee",
        "change": "ändere den Tanztee: wink",
        "no": "nein",
        "forget": "vergiss den Tanztee",
        "help": "was kann ich sagen?",
        "place": "wenn ich Apotheke sage, wink",
    },
    "fr": {
        "teach": "quand je dis bal du soir, salue de la main et fais demi-tour",
        "yes": "oui, s'il te plaît",
        "use": "fais le bal du soir, puis va à la pharmacie",
        "list": "quelles routines connais-tu ?",
        "explain": "que fait le bal du soir ?",
        "times": "fais le bal du soir tous les jours à neuf heures",
        "change": "change le bal du soir : salue de la main",
        "no": "non",
        "forget": "oublie le bal du soir",
        "help": "que puis-je dire ?",
        "place": "quand je dis pharmacie, salue de la main",
    },
}


@pytest.mark.parametrize("language", languages())
def test_routines_are_taught_in_every_language(routines, language) -> None:
    story = STORIES[language]
    nurse = Nurse(routines, language=language)
    assert nurse.says(story["help"]).request.kind == "help"
    assert nurse.says(story["place"]).status == "rejected"
    assert nurse.says(story["teach"]).status == "clarify"
    assert nurse.says(story["yes"]).status == "ok"
    [kept] = routines.known(language)
    used = nurse.says(story["use"])
    assert used.program.startswith('robot.gesture("wave")\nrobot.turn('), used.message
    assert used.program.count("\n") == 3
    assert (
        speech(language).values["quoted"].format(text=kept.name)
        in nurse.says(story["list"]).message
    )
    assert kept.sentence in nurse.says(story["explain"]).message
    assert nurse.says(story["times"]).request.kind == "schedule"
    assert nurse.says(story["change"]).status == "clarify"
    assert nurse.says(story["no"]).status == "ok"
    assert routines.known(language) == (kept,)
    assert nurse.says(story["forget"]).status == "clarify"
    nurse.says(story["yes"])
    assert routines.known() == ()


@pytest.mark.parametrize(
    ("words", "name"),
    [
        ("enregistre cela sous le nom de tournée d'accueil", "tournée d'accueil"),
        ("retiens cela sous le nom d'accueil du matin", "accueil du matin"),
        ("garde ça sous ronde du soir", "ronde du soir"),
    ],
)
def test_a_french_name_does_not_begin_with_its_preposition(routines, words, name) -> None:
    nurse = Nurse(routines, language="fr")
    assert nurse.says(words).request.name == name


# --- on disk


def test_routines_survive_and_are_seen_by_others(nurse, routines) -> None:
    nurse.teaches("evening round", ROUND)
    assert Nurse(Routines(routines.file)).says("evening round").program == PROGRAM
    data = yaml.safe_load(routines.file.read_text(encoding="utf-8"))
    assert data["routines"][0]["language"] == "en"
    by_hand = "routines:\n  - {name: tea dance, sentence: wave}\n"
    routines.file.write_text(by_hand, encoding="utf-8")
    assert nurse.says("tea dance").program == 'robot.gesture("wave")\n'
    assert nurse.says("evening round").status == "rejected"
    routines.file.unlink()
    assert routines.known() == ()


@pytest.mark.parametrize(
    "text", ["routines: [", "- tea", "routines:\n  - {name: tea}", "routines: 7", "\0"]
)
def test_a_broken_file_is_told_and_left_alone(routines, text) -> None:
    routines.file.write_text(text, encoding="utf-8")
    with pytest.raises(UserError, match="Mend it"):
        routines.known()
    with pytest.raises(UserError, match="Mend it"):
        routines.put("tea dance", "wave", "en")
    assert routines.file.read_text(encoding="utf-8") == text


def test_a_full_or_forbidden_disk_leaves_what_there_was(routines, monkeypatch) -> None:
    routines.put("tea dance", "wave", "en")

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("nl2robot.translate.routines.os.fsync", full)
    with pytest.raises(UserError, match="No space left"):
        routines.put("evening round", ROUND, "en")
    monkeypatch.undo()
    assert [each.name for each in routines.known()] == ["tea dance"]
    assert [each.name for each in routines.file.parent.iterdir()] == ["routines.yaml"]


def test_two_clients_learn_at_once(routines) -> None:
    def learn(number: int) -> None:
        routines.put(f"dance {number}", "wave", "en")

    threads = [threading.Thread(target=learn, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(routines.known()) == 8


@settings(max_examples=30, deadline=None)
@given(st.text(max_size=40), st.text(max_size=40))
def test_any_name_and_sentence_get_an_answer(tmp_path_factory, name, sentence) -> None:
    routines = Routines(tmp_path_factory.mktemp("any") / "routines.yaml")
    nurse = Nurse(routines)
    for words in (f'when I say "{name}", {sentence}', f"learn the routine {name}: wave"):
        asked = nurse.says(words)
        assert asked.message or asked.program
        if nurse.says("yes").status == "ok" and routines.known():
            [kept] = routines.known()
            assert nurse.says(kept.name).program, kept
            routines.remove(kept.name, "en")
            assert routines.known() == ()


# --- from the outside


def test_the_command_line_learns_lists_and_forgets(capsys) -> None:
    assert main(["routines", "learn", "evening round", ROUND, "--yes"]) == 0
    assert main(["routines", "learn", "pharmacy", "wave", "--yes"]) == 2
    capsys.readouterr()
    assert main(["routines", "--json"]) == 0
    [listed] = map(json.loads, capsys.readouterr().out.splitlines())
    assert (listed["name"], listed["sentence"], listed["works"]) == ("evening round", ROUND, True)
    assert main(["routines"]) == 0
    assert main(["routines", "explain", "evening round"]) == 0
    assert ROUND in " ".join(capsys.readouterr().out.split())
    assert main(["translate", "do the evening round"]) == 0
    assert capsys.readouterr().out.startswith(PROGRAM)
    assert main(["routines", "forget", "evening round", "-y"]) == 0
    assert open_routines().known() == ()
    assert main(["routines", "forget", "evening round", "-y"]) == 2
    assert main(["routines", "learn", "evening round"]) == 2


def test_options_may_stand_anywhere_among_the_words(capsys) -> None:
    assert main(["routines", "learn", "--lang", "en", "evening round", "-y", ROUND]) == 0
    assert main(["routines", "forget", "-y", "evening round"]) == 0
    capsys.readouterr()
    assert main(["routines", "--json"]) == 0
    assert capsys.readouterr().out == ""
    assert main(["translate", "--", "go to the lobby"]) == 0


def test_somebody_has_to_agree_on_the_command_line(capsys, monkeypatch) -> None:
    monkeypatch.setattr("builtins.input", lambda _: "n")
    assert main(["routines", "learn", "evening round", ROUND]) == 4
    assert open_routines().known() == ()


def test_run_learns_and_then_does(capsys) -> None:
    assert main(["run", "--world", "ward", "--yes", "when I say tea dance, wave and say tea"]) == 0
    assert [each.name for each in open_routines().known()] == ["tea dance"]
    assert main(["run", "--world", "ward", "--yes", "do the tea dance"]) == 0
    assert "gesture(name='wave')" in capsys.readouterr().out


def test_routines_are_taught_over_the_wire(operator) -> None:
    asked = operator.translate("when I say tea dance, wave", talk="kim")
    assert (asked.status, asked.request.name) == ("clarify", "tea dance")
    operator.translate("yes", talk="somebody else")
    assert open_routines().known() == ()
    assert operator.translate("yes", talk="kim").status == "ok"
    assert operator.translate("tea dance").program == 'robot.gesture("wave")\n'


# --- renamed, added to, lost


def test_a_routine_is_renamed_and_added_to(nurse) -> None:
    for words in ("when I say tea dance, go to ward a and say tea", "yes"):
        nurse.says(words)
    assert nurse.says("change tea dance: also wave").status == "clarify"
    assert nurse.says("yes").status == "ok"
    assert nurse.says("change tea dance: without the announcement").status == "clarify"
    nurse.says("yes")
    assert nurse.says("tea dance").program == 'robot.goto("ward a")\nrobot.gesture("wave")\n'
    assert "a place" in nurse.says("rename tea dance to ward b").message
    assert "would be called" in nurse.says("rename the tea dance to tea time").message
    assert nurse.says("yes").status == "ok"
    assert nurse.says("tea dance").status == "rejected"
    twice = nurse.says("do the tea time twice and then come back").program
    assert "for repetition in range(2):" in twice and "robot.goto(start)" in twice


@pytest.mark.parametrize(
    ("language", "teach", "rename", "new"),
    [
        ("de", "Wenn ich Teerunde sage, wink", "nenn Teerunde in Kaffeerunde um", "Kaffeerunde"),
        (
            "fr",
            "quand je dis tournée du thé, fais coucou",
            "renomme tournée du thé en ronde du thé",
            "ronde du thé",
        ),
    ],
)
def test_routines_are_renamed_in_every_language(routines, language, teach, rename, new) -> None:
    nurse = Nurse(routines, language=language)
    for words in (teach, "ja" if language == "de" else "oui", rename):
        assert nurse.says(words).status in ("clarify", "ok"), words
    assert nurse.says("ja" if language == "de" else "oui").status == "ok"
    assert nurse.says(new).program == 'robot.gesture("wave")\n'


def test_without_its_routines_everything_else_is_understood(capsys, home) -> None:
    home.mkdir()
    (home / "routines.yaml").write_text("routines:\n  - {nam: x\n")
    assert main(["translate", "wave"]) == 0
    assert "wave" in capsys.readouterr().out
    main(["translate", "do the evening round"])
    told = " ".join(capsys.readouterr().out.split())
    assert "did not understand" in told and "it is no YAML" in told
    main(["translate", "what routines do you know"])
    assert "it is no YAML" in " ".join(capsys.readouterr().err.split())
