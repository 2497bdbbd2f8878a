"""A ward hands its routines on in a file; another one takes over what it wants, and looks at it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from nl2robot.cli.main import main
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.routine_files import Choice, exported, read, state_of, take_over
from nl2robot.translate.routines import Routine, Routines
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from sim.world.loading import load_world

TEA = 'robot.goto("lobby")\nrobot.say("Tea!")\n'
FILE = """\
nl2robot-routines: 1
routines:
- name: evening round
  sentence: go to every ward and say good night
  language: en
- name: tea round
  program: |
    robot.goto("lobby")
    robot.say("Tea!")
  language: en
- name: Abendgruß
  sentence: sag gute Nacht
  language: de
"""


@pytest.fixture
def knowledge(tmp_path: Path) -> Knowledge:
    return Knowledge(load_world("city-hospital"), routines=Routines(tmp_path / "routines.yaml"))


def test_what_is_exported_is_read_again(knowledge) -> None:
    routines = knowledge.routines
    routines.put("evening round", "go to every ward and say good night", "en", "Ana")
    routines.put("tea round", "", "en", "Ben", TEA)
    text = exported(routines.known())
    assert "Ana" not in text, "who taught it is nobody's business elsewhere"
    read_again = [each.routine for each in read(text, "routines.yaml")]
    assert [(r.name, r.sentence, r.program) for r in read_again] == [
        ("evening round", "go to every ward and say good night", ""),
        ("tea round", "", TEA),
    ]
    assert "    robot.say(" in text, "a program stands line by line"


def test_json_is_taken_as_well() -> None:
    data = {"nl2robot-routines": 1, "routines": [{"name": "tea round", "program": TEA}]}
    [found] = read(json.dumps(data), "tea.json")
    assert (found.routine.name, found.routine.program) == ("tea round", TEA)


@pytest.mark.parametrize(
    ("wrong", "told"),
    [
        ("", "f.yaml: The file is empty."),
        ("routines: []", "f.yaml:1: This is no file of routines"),
        ("- a\n- b", "f.yaml:1: This is no file of routines"),
        ("nl2robot-routines: 2\nroutines: []", 'f.yaml:1: The file has version "2"'),
        ("nl2robot-routines: 1", "f.yaml:1: There are no routines in this file."),
        (FILE.replace("sentence: sag", "sentense: sag"), 'f.yaml:12: A routine has no field "sent'),
        (FILE.replace("language: de", "language: tlh"), 'f.yaml:13: The language "tlh" is not'),
        (FILE.replace('"Tea!")', '"Tea!"'), "f.yaml:7: Line 2 of the program"),
        (FILE.replace('robot.goto("lobby")', "import os"), "f.yaml:7: Line 1 of the program"),
        (FILE.replace("tea round", "Evening  Round"), "f.yaml:6: There is a routine"),
        (FILE.replace("  sentence: sag gute Nacht\n", ""), "f.yaml:11: A routine needs either"),
        (FILE.replace("name: tea round", "name: '...'"), "f.yaml:6: The name has no letters"),
        (FILE.replace("  sentence: sag", " sentence: sag"), "This is not valid YAML"),
        (FILE + "  reviewed: true\n", 'f.yaml:14: A routine has no field "reviewed"'),
    ],
)
def test_every_mistake_is_told_with_its_line(wrong: str, told: str) -> None:
    with pytest.raises(UserError) as caught:
        read(wrong, "f.yaml")
    assert told in str(caught.value)


def test_all_mistakes_are_told_at_once() -> None:
    with pytest.raises(UserError) as caught:
        read(FILE.replace("language: de", "language: tlh").replace("sentence: go", "x: go"), "f")
    assert [line.split(":")[1] for line in str(caught.value).splitlines()] == ["4", "13"]


def test_what_came_from_elsewhere_is_not_used_before_somebody_has_looked_at_it(knowledge) -> None:
    found = read(FILE, "ward.yaml")
    take_over(found, [Choice(1, "tea round")], knowledge, "ward.yaml")
    told = translate("do the tea round", knowledge)
    assert (told.status, told.program) == ("rejected", None)
    assert "nobody here has looked at it yet" in told.message
    # Nor by way of another routine.
    knowledge.routines.put("feast", "do the tea round and wave", "en")
    assert translate("feast", knowledge).program is None
    routines = knowledge.routines
    with pytest.raises(UserError, match="changed or removed since you looked"):
        routines.accept("tea round", "en", TEA + "robot.stop()\n", "Ana")
    routines.accept("tea round", "en", TEA, "Ana")
    assert translate("do the tea round", knowledge).program == TEA
    assert routines.get("tea round", "en").reviewed_by == "Ana"


def test_nothing_is_overwritten_unasked(knowledge) -> None:
    routines = knowledge.routines
    routines.put("tea round", "wave", "en", "Ben")
    found = read(FILE, "ward.yaml")
    assert [state_of(each.routine, knowledge)[0] for each in found] == ["new", "taken", "new"]
    both = [Choice(0, "evening round"), Choice(1, "tea round")]
    with pytest.raises(UserError, match="already"):
        take_over(found, both, knowledge, "ward.yaml")
    assert [each.sentence for each in routines.known()] == ["wave"], "all or none"
    take_over(found, [Choice(1, "afternoon tea")], knowledge, "ward.yaml")
    take_over(found, [Choice(1, "tea round", replace=True)], knowledge, "ward.yaml")
    kept = routines.get("tea round", "en")
    assert (kept.program, kept.imported, kept.reviewed) == (TEA, "ward.yaml", False)
    assert state_of(kept, knowledge) == ("same", "")


@pytest.mark.parametrize("name", ["pharmacy", "go to the lobby", "a b c d e f", "!"])
def test_a_name_that_cannot_be_said_is_not_taken_over(knowledge, name: str) -> None:
    found = read(FILE, "ward.yaml")
    with pytest.raises(UserError):
        take_over(found, [Choice(0, name)], knowledge, "ward.yaml")
    assert knowledge.routines.known() == ()


def test_a_kept_program_can_be_said_among_other_commands(knowledge) -> None:
    knowledge.routines.put("tea round", "", "en", "Ben", "# by Ben\n" + TEA)
    talk = Talk()
    assert translate("tea round", knowledge, talk=talk).program == "# by Ben\n" + TEA
    twice = translate("do the tea round twice", knowledge, talk=talk).program
    assert twice.startswith("for repetition in range(2):") and "Tea!" in twice
    told = translate("what does the tea round do?", knowledge, talk=talk)
    assert "a program that was kept: I will go to the lobby" in told.message
    assert "“tea round” (a program)" in translate("what routines do you know?", knowledge).message


def test_names_inside_a_kept_program_stay_apart_from_those_around(knowledge) -> None:
    program = 'for k, n in {"a": 1}.items():\n    robot.say(f"{k}: {n}")\n'
    knowledge.routines.put("tally", "", "en", program=program)
    said = translate("tally and then do the tally", knowledge)
    assert said.status == "ok", said.message


def test_who_agreed_is_noted_as_the_teacher(knowledge) -> None:
    talk = Talk()
    talk.who = "Ana"
    translate("when I say evening round, wave", knowledge, talk=talk)
    translate("yes", knowledge, talk=talk)
    assert knowledge.routines.get("evening round", "en").by == "Ana"
    talk.who = "Ben"
    translate("change the evening round to nod", knowledge, talk=talk)
    translate("yes", knowledge, talk=talk)
    kept = knowledge.routines.get("evening round", "en")
    assert (kept.by, kept.changed_by, kept.sentence) == ("Ana", "Ben", "nod")


def test_at_the_terminal_from_one_ward_to_the_next(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "one"))
    assert main(["routines", "learn", "evening round", "wave", "--yes"]) == 0
    capsys.readouterr()
    assert main(["routines", "list", "--json"]) == 0
    listed = json.loads(capsys.readouterr().out)
    assert (listed["name"], listed["language"], listed["sentence"]) == (
        *("evening round", "en", "wave"),
    )
    file = tmp_path / "ward.yaml"
    assert main(["routines", "export", "--out", str(file)]) == 0
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path / "two"))
    assert main(["routines", "import", str(file), "--yes"]) == 0
    assert 'review "evening round"' in capsys.readouterr().out
    assert main(["routines", "import", str(file), "--yes"]) == 0
    assert "just so already" in capsys.readouterr().out
    assert main(["routines", "review", "evening round", "--yes"]) == 0
    assert "can be used now" in capsys.readouterr().out
    file.write_text("nl2robot-routines: 7\n")
    assert main(["routines", "import", str(file)]) == 2
    assert "version" in capsys.readouterr().err
    assert main(["routines", "import", str(tmp_path / "none.yaml")]) == 2
    assert "cannot be read" in capsys.readouterr().err


scalars = st.none() | st.booleans() | st.integers() | st.text(max_size=30)
words = st.sampled_from(
    [*("nl2robot-routines", "routines", "name", "sentence", "program", "language", "en", "wave")]
)
data = st.recursive(
    scalars | words,
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(words, inner, max_size=4),
    max_leaves=12,
)
entries = st.fixed_dictionaries(
    {"name": words | st.text(max_size=20)},
    optional={
        "sentence": scalars,
        "program": st.sampled_from([TEA, "robot.fly(", "x = 1", "\0", "import os", ""]),
        "language": st.sampled_from(["en", "de", "xx", ""]),
    },
)
files = st.builds(
    lambda entries: json.dumps({"nl2robot-routines": 1, "routines": entries}),
    st.lists(entries, max_size=4),
)


@given(text=st.text(max_size=300) | data.map(json.dumps) | files)
@settings(max_examples=300, deadline=None, suppress_health_check=[HealthCheck.too_slow])
def test_any_file_is_read_or_refused_with_a_sentence(text: str) -> None:
    try:
        found = read(text, "some.yaml")
    except UserError as error:
        lines = str(error).splitlines()
        assert lines and all(line.startswith("some.yaml:") for line in lines)
        assert all(line.rstrip()[-1] in '.?!"' for line in lines), lines
    else:
        routines = [each.routine for each in found]
        assert routines
        again = [each.routine for each in read(exported(routines), "again.yaml")]
        assert sorted(again, key=str) == sorted(routines, key=str)


def test_a_routine_on_disk_says_one_thing(tmp_path) -> None:
    file = tmp_path / "routines.yaml"
    file.write_text("routines:\n- {name: a, sentence: wave, program: 'x = 1'}\n")
    with pytest.raises(UserError, match="either a sentence or a program"):
        Routines(file).known()
    with pytest.raises(ValueError, match="either"):
        Routine("a")
