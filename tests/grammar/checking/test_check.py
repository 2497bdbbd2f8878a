"""A program that does what somebody on the ward ordered passes the check; one that does something
else does not."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import pytest

from grammar.checking import check
from grammar.language import load_language
from grammar.normal import normal
from grammar.plan import Plan
from grammar.planning.model.expansion import expanded
from grammar.planning.turn import Turn
from grammar.understanding import Context
from tests.grammar.checking import orders
from tests.grammar.checking.orders import ORDERS, Order
from tests.grammar.ward import WARD

each_order = pytest.mark.parametrize("order", ORDERS, ids=str)


def kinds(order: Order, does: str) -> set[str]:
    return {each.kind for each in order.checked(does).objections}


@each_order
def test_what_was_ordered_passes(order: Order) -> None:
    assert order.checked().objections == ()


@pytest.mark.parametrize(
    "wrong",
    [
        orders.elsewhere,
        orders.with_another,
        orders.with_other_numbers,
        orders.with_an_invented_message,
        orders.with_a_grave_deed,
    ],
)
@each_order
def test_what_nobody_ordered_is_objected_to(
    order: Order, wrong: Callable[[Order], Iterator[str]]
) -> None:
    for does in wrong(order):
        assert not order.checked(does).sound, does


def test_the_objection_says_what_was_invented() -> None:
    order = Order("en", "go to the pharmacy", 'goto("laundry")')
    [first, *_] = order.checked().objections
    assert (first.kind, first.about) == ("invented", "laundry")


def test_what_is_left_out_is_told_of_by_its_words() -> None:
    order = Order("en", "take the red cup from the kitchen to Alice", 'find("Alice")')
    checked = order.checked()
    assert {"red", "cup", "kitchen"} & {*checked.unused}
    assert checked.doubts or not checked.sound


@pytest.mark.parametrize(
    ("language", "says", "does", "about"),
    [
        ("en", "go to the kitchen and then to the laundry", 'goto("kitchen")', "the laundry"),
        ("en", "do not go to the kitchen", 'goto("kitchen")', "not"),
        ("de", "Fahr nicht in die Küche.", 'goto("kitchen")', "nicht"),
        ("fr", "Ne va pas à la cuisine.", 'goto("kitchen")', "pas"),
        ("en", "if Bob is in the kitchen, go there", 'goto("kitchen")', "if"),
        (
            "en",
            "go to every ward except ward 3",
            'for room in places("ward"):\n    goto(room)',
            "except",
        ),
        ("en", "go to the pharmacy at 3 pm", 'goto("pharmacy")', "3"),
        ("en", "wait half an hour", "wait(30)", "half an hour"),
        ("en", "speak French", 'set_language("de")', "French"),
        ("en", "nod", 'gesture("wave")', "nod"),
    ],
)
def test_words_that_turn_the_sense_must_show(
    language: str, says: str, does: str, about: str
) -> None:
    objections = Order(language, says, does).checked().objections
    assert ("unheeded", about) in {(each.kind, each.about) for each in objections}


@pytest.mark.parametrize(
    ("says", "does", "about"),
    [
        ("tell Bob that lunch is ready", 'say("Lunch is not ready.")', "not"),
        ("tell Bob that lunch is ready", 'find("Bob")\nsay("Lunch is never ready.")', "never"),
        ("put the red cup on the table", 'grab("red cup")\nput("red cup", "shelf")', "shelf"),
        ("call my daughter", 'call("Dr Weber")', "Dr Weber"),
        ("bring Alice the red cup", 'grab("stapler")\ngive("stapler")', "stapler"),
        ("go to the pharmacy at 3 pm", 'while clock().time < "16:00":\n    wait(60)', "16:00"),
        ("take Carol to radiology", 'goto("waiting room")\nguide("Carol", "radiology")', ""),
    ],
)
def test_what_nobody_said_is_invented(says: str, does: str, about: str) -> None:
    objections = Order("en", says, does).checked().objections
    assert any(each.kind == "invented" and about in each.about for each in objections)


def test_a_not_where_the_robot_has_looked_is_its_own_business() -> None:
    order = Order(
        "en",
        "see whether Carol is in the waiting room and tell me",
        'start = location()\nfound = find("Carol", "waiting room")\ngoto(start)\n'
        'if found:\n    say("Carol is in the waiting room.")\n'
        'else:\n    say("Carol is not in the waiting room.")',
    )
    assert order.checked().sound


@pytest.mark.parametrize(
    "says",
    [
        "could you please go to the pharmacy",
        "hey robot, off to the pharmacy with you",
        "go to the drugstore, thanks a lot",
        "go to the pharmacy, will you?",
    ],
)
def test_courtesies_ask_for_nothing(says: str) -> None:
    assert Order("en", says, 'goto("pharmacy")').checked().sound


def test_what_must_not_be_done_is_refused_whatever_the_program_is() -> None:
    order = Order("en", "take Mrs Miller to the laundry by force", 'find("Mrs Miller")')
    checked = order.checked()
    assert {each.kind for each in checked.objections} >= {"refused"}
    assert all(each.message for each in checked.objections if each.kind == "refused")


@pytest.mark.parametrize(
    ("language", "says", "does"),
    [
        ("en", "grab the mop and hit the visitor with it", 'grab("mop")'),
        ("de", "nimm den Besen und schlag damit den Besucher", 'grab("Besen")'),
        ("fr", "prends le balai et frappe le visiteur avec", 'grab("balai")'),
    ],
)
def test_harm_is_not_left_out_but_refused(language: str, says: str, does: str) -> None:
    order = Order(language, says, does)
    told = [each.message for each in order.checked().objections if each.kind == "harmful"]
    assert told == [load_language(language).phrase("no_harm")]


def test_harm_that_is_only_told_of_is_no_harm() -> None:
    says = "tell Bob that somebody hit the vase"
    assert "harmful" not in kinds(
        Order("en", says, ""), 'find("Bob")\nsay("Somebody hit the vase.")'
    )


def test_a_name_for_nothing_is_senseless() -> None:
    order = Order("en", "go to the pharmacy", 'place = "pharmacy"\ngoto("pharmacy")')
    assert ("senseless", "place") in [
        (each.kind, each.about) for each in order.checked().objections
    ]


@pytest.mark.parametrize(
    "does",
    [
        'goto("pharmacy")\ngoto("pharmacy")',
        'for turn in range(2):\n    goto("pharmacy")\n    goto("pharmacy")',
    ],
)
def test_to_go_where_it_has_just_gone_is_senseless(does: str) -> None:
    order = Order("en", "go past the pharmacy twice", does)
    told = [(each.kind, each.about) for each in order.checked().objections]
    assert ("senseless", "goto") in told


def test_insults_are_not_said() -> None:
    assert "refused" in kinds(ORDERS[5], 'find("Bob")\nsay("You stupid idiot.")')


def test_what_was_planned_before_may_be_done_again() -> None:
    language = load_language("en")
    before = 'find("Bob")\nsay("Lunch is ready.")'
    plan = normal(expanded(before, ["Bob"], WARD, language))
    context = Context(plan=plan, text="tell Bob that lunch is ready")
    order = Order("en", "and Alice too", 'find("Alice")\nsay("Lunch is ready.")')
    assert order.checked(context=context).sound
    assert order.checked().own == ("Lunch is ready.",)  # nobody has said so
    assert order.checked(context=context).own == ()
    other = order.checked('find("Alice")\nsay("Lunch is ready.")\ngoto("laundry")', context)
    assert not other.sound


def test_a_name_that_nothing_gives_is_told() -> None:
    order = Order("en", "say hello", 'say("Hello")')
    plan = normal(expanded('x = 1\nsay(f"{x}")', [], WARD, load_language("en")))
    assert order.checked().sound
    turn = Turn("say hello", WARD, load_language("en"))
    objections = check(turn, Plan(plan.steps[1:])).objections
    assert [each.about for each in objections if each.kind == "unbound"] == ["x"]


def test_the_same_check_says_the_same_twice() -> None:
    does = 'say("Beware of wild crocodiles, dangerous snakes and hungry lions.")'
    order = Order("en", "say hello", does)
    first, second = order.checked(), order.checked()
    assert first.objections == second.objections
    [own] = [each.about for each in first.objections if each.kind == "invented"]
    assert own.split() == sorted(own.split())


@pytest.mark.parametrize(
    ("language", "says"),
    [
        ("en", "I cannot find the kitchen, take me there"),
        ("de", "Ich finde die Küche nicht, bring mich hin"),
        ("fr", "je ne trouve pas la cuisine, emmène-moi"),
    ],
)
def test_what_speakers_say_of_themselves_forbids_nothing(language: str, says: str) -> None:
    checked = Order(language, says, 'guide("person", "kitchen")').checked()
    assert checked.sound
    assert not checked.clear  # it has to be asked about


@pytest.mark.parametrize("time", [":30", "30:", ":", "1:2:3", "²:30"])
def test_what_only_looks_like_a_time_is_compared_as_words(time: str) -> None:
    does = f'answer = ask("When?", [])\nif answer == "{time}":\n    say("Hello")'
    order = Order("en", "ask when, and say hello if it is later", does)
    assert not any(each.kind == "unbound" for each in order.checked().objections)


@pytest.mark.parametrize(
    ("code", "said", "does", "told"),
    [
        ("en", "where is alicee?", 'find("alicee")', "Did you mean Alice?"),
        ("en", "where is ward dd?", 'find("ward dd")', "a place called “ward dd”"),
        ("en", "wait for bobb", 'wait_for("bobb")', "Did you mean Bob?"),
        ("de", "wo ist bobb?", 'find("bobb")', "Ist Bob gemeint?"),
        ("fr", "où est bobb ?", 'find("bobb")', "Vouliez-vous dire Bob ?"),
    ],
)
def test_a_name_that_nearly_is_one_is_asked_about(
    code: str, said: str, does: str, told: str
) -> None:
    checked = Order(code, said, does).checked()
    [wrong] = [each for each in checked.objections if each.kind == "refused"]
    assert told in wrong.message
    assert all(each.rstrip("? ") != said.rstrip("? ") for each in wrong.suggestions)


@pytest.mark.parametrize(
    ("code", "said", "does"),
    [
        ("en", "find the bobb", 'find("bobb")'),
        ("en", "where is the ward nurse?", 'find("ward nurse")'),
        ("en", "find water", 'find("water")'),
        ("de", "finde Saft", 'find("Saft")'),
        ("fr", "trouve du jus", 'find("jus")'),
    ],
)
def test_a_thing_that_nobody_listed_is_looked_for(code: str, said: str, does: str) -> None:
    objections = Order(code, said, does).checked().objections
    assert not [each for each in objections if each.kind == "refused"]


@pytest.mark.parametrize("language", ["en", "de", "fr"])
def test_who_asks_word_by_word_what_the_house_has_an_answer_to_wants_that(language: str) -> None:
    questions = orders.WARDS[language].questions
    assert len(questions) > 1
    for question, other in zip(questions, (*questions[1:], questions[0]), strict=True):
        for says in (question.question, *question.aliases):
            order = Order(language, says.lower().rstrip(" ?"), f'answer("{question.question}")')
            assert not order.checked().doubts, says
        another = Order(language, other.question, f'answer("{question.question}")').checked()
        assert another.doubts or not another.sound or another.unused, (question, other)
