"""What the robot repeats before it acts: short, true, and nothing risky left out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from grammar import plan as p
from grammar.explain import explain
from grammar.language import load_language
from grammar.naming import naming
from grammar.program_parser import parse_program
from grammar.summary import QUIET, summary
from grammar.traversal import nodes
from grammar.understand import understand
from tests.grammar.hospitals import hospital
from tests.grammar.random_plans import plans
from tests.grammar.test_explain import MODEST, spoken

LANGUAGES = ("en", "de", "fr")
FOLDED = {
    "en": {
        "find": "look for|get .+ from|and take it|take .+ to|find",
        "grab": "get .+ from|and take it|take .+ from",
        "give": "take .+ to",
        "goto": "in every|go to every|come back",
        "say": "tell you|say so",
        "wait_for": "comes?",
    },
    "de": {
        "find": "suchen|holen|bringen|finde",
        "grab": "holen|mitnehmen",
        "give": "bringen",
        "goto": "jede[mr] |zurückkommen|fahren",
        "say": "Ihnen|melden",
        "read_text": "Text von",
        "touch": "Knopf",
    },
    "fr": {
        "find": "chercher|prendre|apporter|trouve",
        "grab": "prendre|emporter|l'apporter",
        "give": "apporter",
        "goto": "chaque|revenir|aller",
        "say": "vous dire|signaler",
        "put": "poser",
        "touch": "bouton",
    },
}
"""What else may stand for a call, where several are said in one."""


def told(sentence: str, language: str = "en") -> str:
    lexicon = hospital(language)
    understood = understand(sentence, lexicon, language)
    assert understood.plan is not None, understood
    return summary(understood.plan, language, naming(lexicon, load_language(language)).called)


def of(program: str, language: str = "en") -> str:
    return summary(parse_program(program, language), language)


POLL = """\
start = robot.location()
votes = 0
robot.goto("lobby")
for person in robot.people():
    answer = robot.ask("Tea?", ["yes", "no"], person=person)
    if answer.lower() == "yes":
        votes += 1
robot.goto(start)
robot.say(f"{votes} want tea.")
"""
SEARCH = """\
start = robot.location()
if robot.find("Bob"):
    place = robot.location()
    robot.goto(start)
    robot.say(f"I found Bob here: {place}.")
else:
    robot.goto(start)
    robot.say("I could not find Bob.")
"""
ROUND = """\
for place in robot.places("office"):
    robot.goto(place)
    robot.say("Good morning.")
    if robot.sees("person"):
        robot.ask("Do you want coffee?", ["yes", "no"])
"""
LOOK = """\
start = robot.location()
robot.goto("lobby")
seen = robot.sees("person")
robot.goto(start)
if seen:
    robot.say("Yes, I see somebody.")
else:
    robot.say("No, I do not see anybody.")
"""
FETCH = """\
robot.find("stapler", place="supply room")
robot.grab("stapler")
robot.find("Alice")
robot.give("stapler", person="Alice")
"""


@pytest.mark.parametrize(
    ("program", "words"),
    [
        ('robot.say(f"It is {robot.clock().time}.")\n', "I will tell you the time."),
        (
            POLL,
            "I will go to the lobby, ask everybody I see “Tea?”, come back and tell you the"
            " result.",
        ),
        (SEARCH, "I will look for Bob, come back and tell you the result."),
        (
            ROUND,
            "In every office I will say “Good morning” and, if I see a person, ask “Do you want"
            " coffee?”",
        ),
        (LOOK, "I will go to the lobby, come back and tell you whether I saw a person."),
        (FETCH, "I will take the stapler from the supply room to Alice."),
        (
            'if robot.find("Bob"):\n    robot.say("Lunch is ready.")\n'
            'else:\n    robot.say("I could not find Bob.")\n',
            "I will look for Bob and say “Lunch is ready”. If I do not find Bob, I will say so.",
        ),
        (
            'if robot.sees("person"):\n    robot.say("Hello!")\nelse:\n    robot.dock()\n',
            "If I see a person, I will say “Hello!” Otherwise I will go back to the charging"
            " station.",
        ),
    ],
)  # fmt: skip
def test_a_colleague_would_say_it_so(program, words) -> None:
    assert of(program) == words


@pytest.mark.parametrize(
    ("language", "sentence", "words"),
    [
        (
            "de",
            "geh in jedes Büro und sag guten Morgen",
            "In jedem Büro werde ich „Guten Morgen“ sagen.",
        ),
        (
            "de",
            "geh in jede Station und sag guten Morgen",
            "Auf jeder Station werde ich „Guten Morgen“ sagen.",
        ),
        (
            "fr",
            "va dans chaque bureau et dis bonjour",
            "Dans chaque bureau, je vais dire « Bonjour ».",
        ),
    ],
)
def test_gender_and_case(language, sentence, words) -> None:
    assert told(sentence, language) == words


def test_what_no_plan_can_say_is_read_in_full() -> None:
    plan = p.Plan((p.Call("goto", {"place": p.Text("lobby")}),))
    assert summary(plan) == explain(plan) == "I will go to the lobby."


def test_who_asks_while_noting_is_said_to_ask() -> None:
    said = of(
        "answers = []\n"
        'for place in robot.places("ward"):\n'
        "    robot.goto(place)\n"
        '    answers.append(robot.ask("Any wishes?"))\n'
        "robot.dock()\n"
    )
    assert said == (
        "In every ward I will ask “Any wishes?” Then I will go back to the charging station."
    )


def left_out(plan: p.Plan, language: str, said: str) -> list[str]:
    """The calls that do more than look, and are not to be found in a text."""
    folded = FOLDED[language]
    return [
        call.method
        for call in p.calls(plan)
        if call.method not in QUIET
        and not spoken(language, call.method, said)
        and not re.search(folded.get(call.method, "$^"), said, re.IGNORECASE)
    ]


@MODEST
@given(plans)
def test_nothing_is_left_out_of_any_plan_and_nothing_is_longer(plan: p.Plan) -> None:
    said = summary(plan)
    assert len(said) <= len(explain(plan))
    assert not left_out(plan, "en", said)


GOES = [
    p.Call("location", {}, "start"),
    p.Call("goto", {"place": p.Recall("start")}),
    p.Call("goto", {"place": p.Text("lobby")}),
    p.Call("say", {"text": p.Sentence((p.Text("So: "), p.Recall("seen"), p.Text(".")))}),
    p.Call("sees", {"thing": p.Text("person")}, "seen"),
    p.Call("find", {"thing": p.Text("cup")}),
    p.Call("grab", {"thing": p.Text("cup")}),
    p.Call("find", {"thing": p.Text("Alice")}),
    p.Call("give", {"thing": p.Text("cup"), "person": p.Text("Alice")}),
    p.Call("call", {"contact": p.Text("Bob")}),
    p.Remember("answer", p.Ask("ask", {"question": p.Text("Why?")})),
    p.Collect("answers", p.Ask("touch", {"options": p.Items((p.Text("yes"), p.Text("no")))})),
]
simple = st.sampled_from(GOES)
saying = st.sampled_from(["One.", "Two.", "Three."]).map(
    lambda words: p.Call("say", {"text": p.Text(words)})
)
deeds = st.one_of(simple, saying)
blocks = st.lists(deeds, max_size=3).map(tuple)
branches = st.builds(
    p.If,
    st.sampled_from([p.Holds(p.Recall("seen")), p.Holds(p.Ask("find", {"thing": p.Text("Bob")}))]),
    blocks,
    blocks,
)
rounds = st.builds(
    p.ForEach,
    st.just("place"),
    st.just(p.Ask("places", {"kind": p.Text("ward")})),
    blocks.map(lambda some: (p.Call("goto", {"place": p.Recall("place")}), *some)),
)
people = st.builds(
    p.ForEach,
    st.just("person"),
    st.just(p.Ask("people")),
    blocks.map(
        lambda some: (
            p.Call("ask", {"question": p.Text("Tea?"), "person": p.Recall("person")}),
            *some,
        )
    ),
)
errands = st.lists(st.one_of(deeds, deeds, branches, rounds, people), min_size=1, max_size=6).map(
    lambda steps: p.Plan(tuple(steps))
)


@pytest.mark.parametrize("language", LANGUAGES)
@MODEST
@given(plan=errands)
def test_nothing_is_left_out_of_an_errand(language: str, plan: p.Plan) -> None:
    plan = p.Plan(plan.steps, language)
    said = summary(plan, language)
    assert len(said) <= len(explain(plan, language))
    assert not left_out(plan, language, said)
    for node in nodes(plan.steps):
        if isinstance(node, p.Text) and node.value.endswith("?"):
            assert node.value in said, "a question is told in its words"


def test_a_search_is_told_though_there_is_nothing_but_a_report_either_way() -> None:
    found = p.Holds(p.Ask("find", {"thing": p.Text("Bob")}))
    so = p.Sentence((p.Text("So: "), p.Ask("count", {"thing": p.Text("chair")}), p.Text(".")))
    said = p.Call("say", {"text": so}), p.Call("say", {"text": p.Text("One.")})
    plan = p.Plan((p.If(found, said[:1], said[1:]),), "en")
    assert "find Bob" in summary(plan, "en")


SENTENCES = Path(__file__).parent


@pytest.mark.parametrize("language", LANGUAGES)
def test_what_people_say_is_repeated_shortly_and_whole(language: str) -> None:
    data = yaml.safe_load((SENTENCES / f"sentences_{language}.yaml").read_text(encoding="utf-8"))
    lexicon = hospital(language)
    called = naming(lexicon, load_language(language)).called
    seen, wrong = 0, []
    for sentence in _texts(data):
        plan = understand(sentence, lexicon, language).plan
        if plan is None:
            continue
        seen += 1
        said = summary(plan, language, called)
        assert len(said) <= len(explain(plan, language, called)), sentence
        assert not re.search(r"[⟨⟩{}]|\s{2}|\.\.$", said), (sentence, said)
        if left_out(plan, language, said):
            wrong.append((said, left_out(plan, language, said)))
    assert not wrong
    assert seen > 20


def _texts(data: object) -> list[str]:
    match data:
        case {"say": str(text)}:
            return [text]
        case dict():
            return [text for part in data.values() for text in _texts(part)]
        case list():
            return [text for part in data for text in _texts(part)]
        case _:
            return []


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("en", "look for a cup at ward a, at ward b and at ward c"),
        ("de", "eine Tasse auf der Station a, auf der Station b und auf der Station c suchen"),
        ("fr", "chercher une tasse au service a, au service b et au service c"),
    ],
)
def test_a_search_of_several_places_is_one_deed(language: str, words: str) -> None:
    """And not a condition for each of them."""
    searches = " or ".join(f'robot.find("cup", place="ward {each}")' for each in "abc")
    for program in (
        f'if not ({searches}):\n    robot.say("There is none.")\n',
        f'if {searches}:\n    robot.grab("cup")\nelse:\n    robot.say("There is none.")\n',
    ):
        lexicon, pack = hospital(language), load_language(language)
        called = naming(lexicon, pack).called
        said = summary(parse_program(program, language), language, called)
        assert words in said, said


@pytest.mark.parametrize(
    ("language", "words", "told_as"),
    [
        ("en", "tell me a joke", "I will say one of 3 texts, picked at random."),
        ("de", "erzähl mir einen Witz", "Ich werde einen von 3 Texten sagen, zufällig gewählt."),
        ("fr", "raconte-moi une blague", "Je vais dire l'un de 3 textes, choisi au hasard."),
        ("en", "count to ten", "For each of the numbers from 1 to 10 I will say this number."),
        ("en", "count from three to nine", "the numbers from 3 to 9"),
    ],
)
def test_what_is_long_in_a_program_is_short_in_words(
    language: str, words: str, told_as: str
) -> None:
    assert told_as in told(words, language)
