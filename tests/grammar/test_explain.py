"""What the robot will do, in words a nurse would agree with."""

from __future__ import annotations

import re
from types import SimpleNamespace

import pytest
from hypothesis import HealthCheck, given, settings

from grammar import plan as p
from grammar.explain import explain, explain_program, explain_steps
from grammar.language import UnknownLanguage, languages, speech
from grammar.network import RuleError
from grammar.program import write_program
from grammar.program_parser import parse_program, read_program
from grammar.speech import gaps
from grammar.traversal import walk
from grammar.understand import understand
from robot_api.methods import METHODS
from tests.grammar.hospitals import hospital
from tests.grammar.random_plans import plans

MODEST = settings(max_examples=80, deadline=None, suppress_health_check=list(HealthCheck))


def text(value: str) -> p.Text:
    return p.Text(value)


def call(method: str, save_as: str | None = None, /, **arguments: p.Value) -> p.Call:
    return p.Call(method, dict(arguments), save_as)


def explained(*steps: p.Step) -> str:
    return explain(p.Plan(steps))


def question(words: str, save_as: str) -> p.Call:
    return call("ask", save_as, question=text(words))


def say(words: str) -> p.Call:
    return call("say", text=text(words))


def test_the_visitors_of_the_design() -> None:
    options = p.Items((text("radiology"), text("pharmacy")))
    assert explained(
        call("location", "desk"),
        p.Repeat(
            p.Number(3),
            (
                call("wait_for", thing=text("person")),
                call("ask", "place", question=text("Where to?"), options=options),
                call("guide", person=text("person"), place=p.Recall("place")),
                call("goto", place=p.Recall("desk")),
            ),
        ),
        say("Three visitors have been shown the way."),
    ) == (
        "I will remember where I am. "
        "Then, three times, I will wait for a person, ask “Where to?” and take one of the answers "
        "“radiology” or “pharmacy”, take the person to the place named in the answer, and then go "
        "to where I started. "
        "Then I will say “Three visitors have been shown the way.”"
    )


def test_nouns_have_their_articles() -> None:
    assert explained(call("find", thing=text("apple"), place=text("kitchen"))) == (
        "I will look for an apple at the kitchen."
    )
    assert explained(call("goto", place=text("Alice's office"))) == "I will go to Alice's office."
    for name, said in {
        "room 12": "room 12",
        "radiology": "radiology",
        "alice's office": "alice's office",
        "children's ward": "the children's ward",
        "pharmacy": "the pharmacy",
    }.items():
        assert explained(call("goto", place=text(name))) == f"I will go to {said}."
    assert explained(call("grab", thing=text("leftmost bottle"))) == (
        "I will take the leftmost bottle."
    )
    people = p.Sentence((text("I see "), p.Ask("count", {"thing": text("person")})))
    assert explained(call("say", text=people)) == (
        "I will say “I see [the number of people I see]”."
    )


@pytest.mark.parametrize("things", ["scissors", "gloves", "reading glasses"])
def test_of_what_there_is_never_one_it_is_told_so(things: str) -> None:
    assert f"some {things}" in explained(call("find", thing=text(things)))
    told = understand(f"count the {things}", hospital("en"), "en").plan
    assert told is not None and f"Number of {things}:" in write_program(told)


def test_what_was_heard_is_called_the_answer_to_its_question_when_there_are_two() -> None:
    told = explained(
        question("Coffee?", "coffee"),
        question("Milk?", "milk"),
        call("show", text=p.Recall("coffee")),
        call("show", text=p.Recall("milk")),
    )
    assert (
        "show the answer to “Coffee?” on my screen, and then show the answer on my screen" in told
    )


def test_the_answer_is_not_called_so_where_it_could_be_another() -> None:
    """In the second round the latest answer is that about milk."""
    told = explained(
        question("Coffee?", "coffee"),
        p.Repeat(
            p.Number(2),
            (say("x"), call("show", text=p.Recall("coffee")), question("Milk?", "milk")),
        ),
    )
    assert "show the answer to “Coffee?” on my screen" in told
    after_a_branch = explained(
        question("Coffee?", "coffee"),
        p.If(p.Holds(p.Ask("sees", {"thing": text("cup")})), (question("Milk?", "milk"),)),
        call("show", text=p.Recall("coffee")),
    )
    assert "show the answer to “Coffee?” on my screen" in after_a_branch


def test_two_ways_to_make_the_same_name() -> None:
    told = explained(
        p.If(
            p.Holds(p.Ask("sees", {"thing": text("person")})),
            (question("Coffee?", "answer"),),
            (call("scan", "answer"),),
        ),
        call("show", text=p.Recall("answer")),
    )
    assert "show “answer” on my screen" in told


def test_branches_read_one_after_the_other() -> None:
    def hears(word: str) -> p.Compare:
        return p.Compare(text(word), "in", p.Recall("answer"))

    steps = (
        question("Where to?", "answer"),
        p.If(
            hears("lab"),
            (call("goto", place=text("lab")),),
            (p.If(hears("ward"), (call("goto", place=text("ward")),), (call("dock"),)),),
        ),
    )
    assert explained(*steps) == (
        "I will ask “Where to?”. "
        "Then, if the answer has “lab” in it, I will go to the lab. "
        "Otherwise, if the answer has “ward” in it, I will go to the ward. "
        "Otherwise, I will go back to the charging station."
    )
    assert explain_steps(p.Plan(steps)) == [
        (0, "ask “Where to?”"),
        (0, "if the answer has “lab” in it:"),
        (1, "go to the lab"),
        (0, "otherwise, if the answer has “ward” in it:"),
        (1, "go to the ward"),
        (0, "otherwise:"),
        (1, "go back to the charging station"),
    ]


def test_a_clause_in_a_clause() -> None:
    nobody = p.Not(p.Holds(p.Ask("sees", {"thing": text("person")})))
    told = explained(
        p.ForEach(
            "office",
            p.Ask("places", {"kind": text("office")}),
            (call("goto", place=p.Recall("office")), p.If(nobody, (say("Nobody here."),))),
        )
    )
    assert told == (
        "For each of the offices I know, I will do this: go to this office; "
        "if I do not see a person, say “Nobody here.”"
    )


def test_waiting_for_somebody_is_not_called_doing_nothing() -> None:
    nobody = p.Not(p.Holds(p.Ask("sees", {"thing": text("person")})))
    assert explained(p.While(nobody, ())) == (
        "As long as I do not see a person, I will wait a moment."
    )


def test_numbers_and_directions() -> None:
    assert explained(
        call("turn", degrees=p.Number(-90)),
        call("move", metres=p.Number(1)),
        call("wait", seconds=p.Number(1)),
    ) == (
        "I will turn 90 degrees to the right, drive 1 metre straight ahead, and then wait 1 second."
    )
    told = explained(question("How long?", "time"), call("wait", seconds=p.Recall("time")))
    assert "wait [the answer] seconds" in told


def test_yes_or_no_that_was_remembered() -> None:
    told = explained(
        call("find", "found", thing=text("stapler")),
        p.If(p.Holds(p.Recall("found")), (call("grab", thing=text("stapler")),), (say("No."),)),
        p.If(p.Not(p.Holds(p.Recall("found"))), (call("dock"),)),
    )
    assert "Then, if I found a stapler, I will take a stapler. Otherwise, I will say “No.”" in told
    assert "if I did not find a stapler, I will go back" in told


def test_a_value_that_was_remembered_is_called_as_a_result_is() -> None:
    """Both ways to keep the result of a robot method read alike."""
    told = explained(
        p.Remember("start", p.Ask("location")),
        p.Remember("seen", p.Ask("sees", {"thing": text("person")})),
        call("goto", place=p.Recall("start")),
        p.If(p.Holds(p.Recall("seen")), (say("Somebody."),)),
    )
    assert told == (
        "I will remember where I am, look whether I see a person, and then go to where I started. "
        "Then, if I saw a person, I will say “Somebody.”"
    )


def test_a_loop_that_is_left_from_within() -> None:
    seen = p.If(p.Holds(p.Ask("sees", {"thing": text("cup")})), (p.End(),))
    told = explained(p.Forever((call("turn", degrees=p.Number(90)), seen)))
    assert told.startswith("Again and again, I will do this: turn 90 degrees to the left; if I see")


def test_the_time_of_day() -> None:
    noon = p.Compare(p.Ask("clock", field="time"), ">=", text("12:00"))
    assert explained(p.If(noon, (call("dock"),))).startswith("If it is 12:00 or later, I will")
    assert explained(p.If(p.Not(noon), (call("dock"),))).startswith("If it is before 12:00, I")


def test_counting_is_told_as_counting() -> None:
    """The names that programs have for a number or a list say what it is of."""
    told = explained(
        p.Remember("asked", p.Number(0)),
        p.Remember("said_yes", p.Items(())),
        p.Remember("x", p.Number(0)),
        p.Increase("asked"),
        p.Increase("x"),
        p.If(
            p.Compare(p.Length(p.Recall("said_yes")), "==", p.Number(0)),
            (call("say", text=p.Sentence((p.Recall("asked"), text(" asked")))),),
        ),
    )
    assert told == (
        "I will keep count of the people I ask, start an empty list for the answer yes, "
        "start “x” at 0, add one to the number of people I asked, and then add one to “x”. "
        "Then, if the list for the answer yes is empty, I will say “[the number of people I "
        "asked] asked”."
    )


def test_two_counts_of_the_same_are_told_apart() -> None:
    told = explained(
        *(p.Remember(name, p.Number(0)) for name in ("asked", "asked2")), p.Increase("asked2")
    )
    assert told.endswith("add one to the number of people I asked (“asked2”).")


def test_several_of_what_is_somewhere() -> None:
    for language, name, several in (
        ("en", "box on the middle shelf", "boxes on the middle shelf"),
        ("en", "woman in the corner", "women in the corner"),
        ("de", "Stuhl auf dem Flur", "Stühle auf dem Flur"),
        ("fr", "tasse sur la table", "tasses sur la table"),
    ):
        assert speech(language).nouns.many(name) == several


def test_nothing_to_do() -> None:
    assert explained() == "I will do nothing."


def test_an_unknown_language_is_said_so() -> None:
    with pytest.raises(UnknownLanguage, match="tlh"):
        explain(p.Plan(()), "tlh")


@pytest.mark.parametrize("language", languages())
def test_every_method_has_words_in_every_language(language: str) -> None:
    words = speech(language)
    assert set(words.methods) == set(METHODS)
    for name, said in words.methods.items():
        method = METHODS[name]
        known = {parameter.name for form in method.forms for parameter in form}
        required = [
            {parameter.name for parameter in form if parameter.required} for form in method.forms
        ]
        patterns = [*said.do, *said.negative, *said.result, *said.value]
        patterns += [*said.holds, *said.fails, *said.held, *said.missed]
        assert all(gaps(pattern) <= known for pattern in patterns), name
        for form in required:
            assert any(gaps(pattern) <= form for pattern in said.do), f"{name}: nothing for {form}"
        if method.returns.annotation != "None":
            assert said.value and said.result, f"{name} has a result"
        if method.returns.annotation == "bool":
            assert said.holds and said.fails and said.held and said.missed, f"{name} is yes or no"


def test_no_method_has_words_in_two_files(monkeypatch: pytest.MonkeyPatch) -> None:
    again = SimpleNamespace(methods={"say": {"do": ["say {text}"]}})
    monkeypatch.setattr("grammar.language.load_language", lambda code: again)
    with pytest.raises(RuleError, match="both speak of 'say'"):
        speech.__wrapped__("en")


MARKS_AND_GAPS = re.compile(r"(?:(?:\S+ )?⟨[^⟩]*⟩ )?\{[^}]*\}")
"""What changes when a pattern is filled: a case mark changes the little word before it, too."""


def spoken(language: str, method: str, told: str) -> bool:
    """Whether one of the method's phrases is in the text, gaps being anything; the little word
    before a gap may have run together with what is in it ("à le" is "au")."""
    words = speech(language).methods[method]
    patterns = [*words.do, *words.negative, *words.value, *words.holds, *words.fails]
    patterns += [*words.fields.values()]
    one = speech(language).nouns.one
    for _ in range(2):  # one metre per second for one second
        patterns += [one(pattern, gap) for pattern in patterns for gap in gaps(pattern)]
    little = re.compile(r"\b\w{1,3} $" if speech(language).joined else "$")
    return any(
        re.search(
            ".+?".join(re.escape(little.sub("", part)) for part in MARKS_AND_GAPS.split(pattern)),
            told,
            re.DOTALL,
        )
        for pattern in patterns
        if pattern
    )


@MODEST
@given(plans)
def test_everything_that_is_done_is_said(plan: p.Plan) -> None:
    for language in languages():
        in_sentences = explain(plan, language)
        in_a_list = "\n".join(line for _, line in explain_steps(plan, language))
        for step in walk(plan.steps):
            if isinstance(step, p.Call):
                assert spoken(language, step.method, in_a_list)
                assert spoken(language, step.method, in_sentences)
                for value in step.arguments.values():
                    plural = step.method in ("count", "places")
                    if isinstance(value, p.Text) and not plural:
                        # A sentence may begin with it, which makes its first letter large.
                        assert value.value[1:] in in_a_list
                        assert value.value[1:] in in_sentences


# --- edited programs -----------------------------------------------------------------------------


def test_an_edited_program_is_explained_line_by_line() -> None:
    source = (
        "desk = robot.location()\n"
        'robot.say("Coffee?")\n'
        "for i in range(3):\n"
        "    robot.goto(\n"
        '        "pharmacy"\n'
        "    )\n"
        "    if not robot.sees('person'):\n"
        "        break\n"
        "x = [robot.battery()] * 2\n"
        "def greet(name):\n"
        '    robot.say(f"Hello {name}!")\n'
        "greet(desk)\n"
    )
    assert [(told.line, told.depth, told.text) for told in explain_program(source)] == [
        (1, 0, "remember where I am"),
        (2, 0, "say “Coffee?”"),
        (3, 0, "three times:"),
        (4, 1, "go to the pharmacy"),
        (7, 1, "if I do not see a person:"),
        (8, 2, "go no further"),
        (9, 0, "remember `[robot.battery()] * 2` as “x”"),
        (10, 0, "whenever `greet` is called:"),
        (11, 1, "say “Hello [“name”]!”"),
        (12, 0, "run `greet(desk)`"),
    ]


def test_otherwise_is_where_the_program_says_it() -> None:
    source = (
        "if robot.sees('person'):\n"
        "    robot.say('Hello.')\n"
        "elif robot.sees('cup'):\n"
        "    robot.say('A cup.\u2028')\n"
        "\n"
        "# nothing there\n"
        "else :\n"
        "    if robot.battery() < 20:\n"
        "        robot.dock()\n"
        "    else: robot.dock()\n"
        "    robot.stop()\n"
        "try:\n"
        "    robot.goto('pharmacy')\n"
        "except Exception:\n"
        "    # too bad\n"
        "    robot.dock()\n"
    )
    clauses = [
        (told.line, told.depth) for told in explain_program(source) if told.text.endswith(":")
    ]
    assert clauses == [(1, 0), (3, 0), (7, 0), (8, 1), (10, 1), (12, 0), (14, 0)]


def test_who_gives_a_word_of_pythons_another_meaning_is_quoted() -> None:
    [told] = [
        each
        for each in explain_program("def str(x):\n    robot.dock()\nrobot.say(str(1))\n")
        if each.line == 3
    ]
    assert told.text == "say `str(1)`"
    helper = "def percent(part, whole):\n    robot.dock()\nrobot.say(f'{percent(1, 2)}')\n"
    assert "go back to the charging station" in [each.text for each in explain_program(helper)]


def test_a_program_that_is_none() -> None:
    with pytest.raises(SyntaxError):
        explain_program("robot.say(")


@MODEST
@given(plans)
def test_what_was_written_is_read_back(plan: p.Plan) -> None:
    """Every call of the plan is found again, and told of in the explanation by lines."""
    source = write_program(plan)
    calls = [step for step in walk(read_program(source).plan.steps) if isinstance(step, p.Call)]
    told = "\n".join(each.text for each in explain_program(source))
    for step in walk(plan.steps):
        if isinstance(step, p.Call):
            assert any(call.method == step.method for call in calls)
            assert spoken("en", step.method, told)


@MODEST
@given(plans)
def test_no_line_is_told_of_twice_or_out_of_order(plan: p.Plan) -> None:
    source = write_program(plan)
    lines = [each.line for each in explain_program(source)]
    assert lines == sorted(lines)
    assert all(1 <= line <= len(source.splitlines()) + 1 for line in lines)


def test_what_is_found_out_on_the_way_is_told_without_bookkeeping() -> None:
    yes = p.Compare(p.Recall("answer"), "==", text("yes"))
    asking = p.ForEach(
        "person",
        p.Ask("people"),
        (
            call("ask", "answer", question=text("Can you help?"), person=p.Recall("person")),
            p.If(yes, (p.Remember("found_person", p.Recall("person")), p.End())),
        ),
    )
    nobody = p.Compare(p.Recall("found_person"), "==", text(""))
    told = explained(p.Remember("found_person", text("")), asking, p.If(nobody, (say("No."),)))
    assert told.startswith("For each of the people I see")
    assert "remember this person as the person who said yes and then go no further" in told
    assert told.endswith("Then, if nobody said yes, I will say “No.”")


def test_one_who_is_left_out_is_called_by_name() -> None:
    but = p.Not(p.Compare(p.Recall("person"), "in", p.Items((text("Clara"),))))
    told = explained(p.ForEach("person", p.Ask("people"), (p.If(but, (say("Hello."),)),)))
    assert "if this person is not “Clara”, I will say “Hello.”" in told


def test_what_a_robot_notes_for_itself_need_not_be_told() -> None:
    plan = p.Plan(
        (
            call("location", "start"),
            p.Remember("number", p.Number(0)),
            call("goto", place=text("lobby")),
            call("goto", place=p.Recall("start")),
        )
    )
    assert (
        explain(plan, deeds_only=True) == "I will go to the lobby and then go to where I started."
    )
    assert explain(p.Plan(plan.steps[:1]), deeds_only=True) == "I will remember where I am."


@pytest.mark.parametrize("variable", ["room", "station", "r", "zimmer", "lieu"])
@pytest.mark.parametrize(
    ("language", "goes"),
    [("de", "zum jeweiligen Ort fahren"), ("fr", "aller à ce lieu"), ("en", "go to this ")],
)
def test_what_a_loop_goes_round_is_told_by_what_it_is_not_by_its_name(
    variable: str, language: str, goes: str
) -> None:
    """The names in a program are for those who read it; a language model calls them as it likes."""
    program = f'for {variable} in robot.places("ward"):\n    robot.goto({variable})\n'
    told = explain_steps(parse_program(program, language), language)[1][1]
    assert told == (
        f"{goes}{variable if len(variable) > 2 else 'place'}" if language == "en" else goes
    )


def test_people_and_things_are_told_so_as_well() -> None:
    met = "for x in robot.people():\n    robot.find(x)\n"
    held = 'for x in ["cup", "book"]:\n    robot.grab(x)\n'
    told = [
        explain_steps(parse_program(program, code), code)[1][1]
        for code in ("en", "de", "fr")
        for program in (met, held)
    ]
    assert told == [
        "look for this person from place to place",
        "take this thing",
        "die jeweilige Person von Ort zu Ort suchen",
        "den jeweiligen Gegenstand nehmen",
        "chercher cette personne de lieu en lieu",
        "prendre cet objet",
    ]


@pytest.mark.parametrize("condition", ["seen", "len(seen) > 0", "robot.people()"])
@pytest.mark.parametrize(
    ("language", "some", "none"),
    [
        ("en", "somebody", "nobody"),
        ("de", "jemanden", "niemanden"),
        ("fr", "quelqu'un", "ne vois personne|n'ai vu personne"),
    ],
)
def test_what_a_look_came_to_is_told_as_people_would(
    language: str, some: str, none: str, condition: str
) -> None:
    """And not that "the people I saw is empty"."""
    for test, words in ((condition, some), (f"not ({condition})", none)):
        program = f'seen = robot.people()\nif {test}:\n    robot.say("x")\n'
        told = explain_steps(parse_program(program, language), language)[1][1]
        assert re.search(words, told), told


TIMES = [
    ("en", "three times", ("it is the first time", "it is not the first time")),
    ("de", "dreimal", ("es das erste Mal ist", "es nicht das erste Mal ist")),
    ("fr", "trois fois", ("c'est la première fois", "ce n'est pas la première fois")),
]


@pytest.mark.parametrize(("language", "times", "first"), TIMES)
def test_who_counts_only_to_know_the_first_time_is_not_told_of_numbers(
    language: str, times: str, first: tuple[str, str]
) -> None:
    is_first, is_later = first
    for condition, told in [
        ("k == 0", is_first),
        ("k < 1", is_first),
        ("not k > 0", is_first),
        ("k > 0", is_later),
        ("k >= 1", is_later),
        ("k != 0", is_later),
        ("not k == 0", is_later),
    ]:
        wait = f"    if {condition}:\n        robot.wait(60)\n"
        program = f'for k in range(3):\n{wait}    robot.say("Ah")\n'
        lines = [line.text for line in explain_program(program, language)]
        assert lines[0].startswith(times) and told in lines[1], (condition, lines)


def test_the_last_time_is_told_as_that_and_other_numbers_as_numbers() -> None:
    def lines(condition: str, more: str = "") -> list[str]:
        program = (
            f"for k in range(4):\n    if {condition}:\n        robot.wait(60)\n"
            f'    robot.say("Ah")\n{more}'
        )
        return [line.text for line in explain_program(program, "en")]

    assert "it is not the last time" in lines("k < 3")[1]
    assert "it is the last time" in lines("k == 3")[1]
    assert "number" in lines("k > 1")[1]  # the third
    assert "number" in lines("k > 0", "    robot.say(str(k))\n")[1]
    inner = "    for other in range(2):\n        if k == 0:\n            robot.wait(1)\n"
    assert "first time" not in " ".join(lines("k > 0", inner))  # whose?
