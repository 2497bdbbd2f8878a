"""What may still become a program: all of the dialect, and nothing that names what nobody said."""

from __future__ import annotations

import random
import re
from functools import cache

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from grammar.language import load_language
from grammar.normal import normal
from grammar.planning.model.expansion import expanded
from grammar.planning.model.prompt import vocabulary
from grammar.planning.model.recogniser import DEEPEST, MOST_LINES, Partial
from grammar.planning.model.vocabulary import Vocabulary
from grammar.planning.turn import Turn
from grammar.program import write_program
from grammar.program_parser import parse_program
from tests.grammar.ward import WARD

MODEST = settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
EN = load_language("en")
SAID = (
    "Ask Alice, Bob and Carol in the kitchen, the lobby or Bob's office whether they want the red"
    " cup or the blanket, in every ward. Wait ten minutes, turn 45 degrees, move 2 metres, be happy"
    " and nod, and then call the nurse station at five past three. Put it on the table, in French."
    " And what about the sauna?"
)


@cache
def words() -> Vocabulary:
    return vocabulary(Turn(SAID, WARD, EN))


def written(text: str, known: Vocabulary | None = None) -> Partial | None:
    """A draft that was written letter by letter."""
    draft: Partial | None = Partial.begin(known or words())
    for letter in text:
        if draft is None:
            return None
        draft = draft.extended(letter)
    return draft


def check_whole(text: str) -> None:
    """That a program is a plan, which is written as the same program again."""
    plan = normal(expanded(text, words().people, WARD, EN))
    assert parse_program(write_program(plan), "en") == plan


PROGRAMS = (
    'goto("kitchen")',
    "wait(600)",
    "turn(45)\nturn(-45)\nmove(2)",
    'emotion("happy")\ngesture("nod")\ncall("nurse station")\nhang_up()',
    'find("Bob")\nsay("Lunch is ready.")',
    'say("Bonjour.", language="fr")\nset_language("fr")\nset_volume(70)',
    'start = location()\nfind("Alice")\n'
    'answer = ask("Do you want the red cup?", ["yes", "no"], "Alice")\n'
    'goto(start)\nsay(f"Alice said {answer}.")',
    'for person in ["Alice", "Bob"]:\n    find(person)\n    say("Lunch is ready.")',
    'names = []\nfor room in places("ward"):\n    goto(room)\n    if sees("blanket"):\n'
    '        names.append(room)\nif names:\n    say(f"There are blankets in {names}.")\n'
    'else:\n    say("There are none.")',
    'number = 0\nfor room in ["kitchen", "lobby"]:\n    goto(room)\n'
    '    number += count("person")\nsay(f"I saw {number} people.")',
    'votes = {}\nfor person in people():\n    answer = ask("Tea or coffee?", ["tea", "coffee"], '
    "person)\n    votes[answer] += 1\nfor answer, number in votes.items():\n"
    '    say(f"{answer}: {number}")\nsay(f"{max(votes, key=votes.get)} wins.")',
    'while clock().time < "15:05":\n    wait(60)\ngoto("lobby")',
    "begin = clock().time\nwhile minutes_since(begin) < 10:\n"
    '    if wait_for("person", timeout=60):\n        answer()',
    'while True:\n    wait_for("Carol")\n    answer = ask("Blanket?", ["yes", "no"])\n'
    '    if answer == "no":\n        break\nsay(f"{answer}")',
    'try:\n    grab("red cup")\nexcept Exception:\n    say("I cannot take it.")\n    dock()',
    'fruit = ask("Which fruit?")\nfind(fruit)\ngrab(fruit)\nput(fruit, "table")',
    'text = ask("How many?")\nnumber = number_in(text)\nif number > 2 and not sees("Bob"):\n'
    '    show(f"{number}")\nelif number == 2:\n    dock()\nelse:\n    say("Few.")',
    'if weekday() == "Friday" or weekday() in ["Saturday", "Sunday"]:\n    say("Weekend!")',
    "for i in range(3):\n    if battery() < 10:\n        break\n    turn(45)",
    'end = clock().date\nsay(f"{end}")\nexit = 1\nsay(f"{exit}")',
    'thing = random_choice(["red cup", "blanket"])\nfind(thing)',
    'refuse("dangerous")',
    'refuse("unknown", "sauna")',
    'clarify("which", "ward")',
)


@pytest.mark.parametrize("program", PROGRAMS)
def test_the_dialect_is_written_letter_by_letter(program: str) -> None:
    draft = written(program)
    assert draft is not None and draft.is_whole
    assert draft.text == program
    whole = Partial.begin(words()).extended(program)
    assert whole is not None and whole.is_whole
    if not draft.ended and not program.startswith(("refuse", "clarify")):
        check_whole(program)


@pytest.mark.parametrize("program", [each for each in PROGRAMS if "\n" in each])
def test_a_program_is_not_whole_before_its_blocks_are(program: str) -> None:
    for line in re.finditer(":\n", program):
        begun = Partial.begin(words()).extended(program[: line.end()])
        assert begun is not None and not begun.is_whole


@pytest.mark.parametrize(
    "program",
    [
        # Names that nobody said, one way or the other.
        'goto("radiology")',
        'find("Dr Weber")',
        'goto(("radiology"))',
        'goto("ra" + "diology")',
        'place = "radiology"\ngoto(place)',
        'place = "sauna"\ngoto(place)',
        'place = f"radiology"\ngoto(place)',
        'place = "radio"\ngoto(place + "logy")',
        'place = location()\nplace = "radiology"\ngoto(place)',
        'rooms = ["radiology"]\n',
        'rooms = []\nrooms.append("radiology")\nfor room in rooms:\n    goto(room)',
        'rooms = {}\nrooms["radiology"] = 1\ngoto(max(rooms, key=rooms.get))',
        'goto(ask("Where?", ["radiology", "kitchen"]))',
        'goto(random_choice(["sauna", "kitchen"]))',
        'grab(f"bomb")',
        'grab("bomb")',
        'call(("police"))',
        'who = "police"\ncall(who)',
        "wait(601)",
        "turn(33)",
        "set_volume(101)",
        'emotion("grumpy")',
        'refuse("unknown", "swimming pool")',
        'refuse("bored")',
        'clarify("why")',
        # What is no program.
        'say("a\rb")',
        'say("a\x00b")',
        'say("a\u202eb")',
        'say("\\n")',
        "say('Hello')",
        'say("{x}")',
        'say(f"{{}}")',
        'say(f"{x}")',
        "say(f\"{ask('say \"hi\"')}\")",
        'import os',
        'robot.say("Hi.")',
        'print("Hi.")',
        "x = (((((((((1",
        "break\n",
        'if sees("Bob"):\n\n',
        'if sees("Bob"):\nsay("Hi.")',
        '  say("Hi.")',
        'else:',
        'range = 1',
        'random = 1',
        'for _x in range(2):',
        'for größe in range(2):',
        'names = people()\nsay(f"{max(names)}")',
        'count("cup")',
        'while True:\n    if sees("Bob"):\n        break\n    x = 1\nsay(f"{x}")',
        'if weekday() == "Freitag":',
        'if not not sees("Bob"):',
    ],
)  # fmt: skip
def test_nothing_else_is(program: str) -> None:
    assert written(program) is None
    whole = Partial.begin(words()).extended(program)
    assert whole is None


def test_what_was_found_out_has_to_be_used() -> None:
    draft = written("number = battery()")
    assert draft is not None and not draft.is_whole
    draft = draft.extended('\nsay(f"{number} percent.")')
    assert draft is not None and draft.is_whole


def test_a_way_out_stands_alone() -> None:
    draft = written('refuse("medical")')
    assert draft is not None and draft.is_whole
    assert draft.extended("\nd") is None
    assert written('dock()\nrefuse("medical")') is None


def test_what_can_only_go_on_one_way_is_told() -> None:
    draft = written('goto("kit')
    assert draft is not None and draft.completions == ('chen"',)
    begun = written("for i in range(2):\n")
    assert begun is not None
    line = begun.extended("  ")
    assert line is not None and line.completions == ("  ",)


def test_no_program_is_without_end_or_too_deep() -> None:
    assert Partial.begin(words()).extended("dock()\n" * (MOST_LINES + 1)) is None
    deep = "".join(f"{' ' * 4 * depth}while True:\n" for depth in range(DEEPEST + 2))
    assert written(deep) is None
    assert Partial.begin(words()).extended("x = " + "1 + " * 200) is None


def test_names_that_cannot_be_written_are_not_and_do_no_harm() -> None:
    known = Vocabulary(places=('the "blue" room', "back\\slash", "two\nlines", "kitchen"))
    assert written('goto("kitchen")', known) is not None
    assert written('goto("the ', known) is None
    assert written('goto("b', known) is None
    assert written('say("In the {kitchen}")', known) is None


def test_a_draft_does_not_change() -> None:
    draft = written('goto("')
    assert draft is not None
    one, two = draft.extended("kitchen"), draft.extended("lobby")
    assert one is not None and two is not None
    assert (draft.text, one.text, two.text) == ('goto("', 'goto("kitchen', 'goto("lobby')


# --- whatever is whole is a program --------------------------------------------------------------

_PARTS = re.compile(r'f?"[^"\n]*"|\w+|\n *|[^\w\s]| ')
_ALL = [_PARTS.findall(program) for program in PROGRAMS]
_ANY = [part for program in _ALL for part in program]


def garbled(program: list[str], chance: random.Random) -> str:
    """A program with some of its parts lost, exchanged or put in."""
    parts = list(program)
    for _ in range(chance.choice((1, 1, 2, 3))):
        at = chance.randrange(len(parts) + 1)
        match chance.randrange(4):
            case 0:
                parts[at : at + 1] = [chance.choice(_ANY)]
            case 1:
                del parts[at : at + chance.choice((1, 2, 4))]
            case 2:
                other = chance.choice(_ALL)
                begin = chance.randrange(len(other))
                parts[at:at] = other[begin : begin + chance.randint(1, 12)]
            case _:
                parts.insert(at, chance.choice(_ANY))
    return "".join(parts)


@MODEST
@given(st.randoms(use_true_random=False))
def test_what_is_whole_is_a_program(chance: random.Random) -> None:
    for _ in range(12):
        text = garbled(chance.choice(_ALL), chance)
        draft = Partial.begin(words()).extended(text)
        if draft is not None and draft.is_whole and not text.startswith(("refuse(", "clarify(")):
            check_whole(text)


_PIECES = (
    *'abdefilnorst0126 _\n"()[]{}.,:=',
    *(" = ", "if ", "for ", "while ", "try:\n", "except Exception:\n", "else:\n", " in ", "not "),
    *(" == ", " + ", " and ", ":\n", ")\n", 'f"', "    ", "names", "answer", "votes", "people()"),
    *('"Bob"', '"kitchen"', 'say("Hi.")\n', "goto(", "find(", "ask(", "wait(", "range(", "count("),
    *("names = []\n", "votes = {}\n", 'answer = ask("Tea?", ["yes", "no"])\n', ".append("),
)  # fmt: skip


def wandered(chance: random.Random) -> Partial:
    """A draft that somebody wrote who presses any key that may be pressed, and begins a line anew
    who cannot go on."""
    draft = Partial.begin(words())
    for _ in range(8):
        line: Partial | None = draft
        for _ in range(20):
            assert line is not None
            likely = chance.sample(line.completions, min(1, len(line.completions)))
            keys = [*likely, *chance.sample(_PIECES, 40), ")\n", '"']
            grown = (line.extended(key) for key in keys)
            line = next((each for each in grown if each is not None), None)
            if line is None or not line.begun:
                break
        if line is not None and not line.begun:
            draft = line
    return draft


@settings(MODEST, max_examples=5)
@given(st.randoms(use_true_random=False))
def test_whoever_writes_what_is_allowed_writes_programs(chance: random.Random) -> None:
    draft = wandered(chance)
    if draft.is_whole and not draft.ended:
        check_whole(draft.text)


@MODEST
@given(st.text(max_size=30), st.sampled_from(PROGRAMS))
def test_no_text_makes_it_stumble(text: str, program: str) -> None:
    begun = Partial.begin(words()).extended(program[: len(program) // 2])
    assert begun is not None
    for draft in (begun, Partial.begin(words())):
        grown = draft.extended(text)
        assert grown is None or grown.text == draft.text + text


def test_nothing_begins_that_can_only_go_astray() -> None:
    """Where no contact was named, a model that wants to call somebody must not count for ever."""
    words = Vocabulary(people=("Bob",), numbers=("100",))
    for begun in ("call(", "gesture(1", "goto((", "find(1", "find([", "give(-1"):
        assert Partial.begin(words).extended(begun) is None, begun
