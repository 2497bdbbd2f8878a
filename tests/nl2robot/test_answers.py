"""Whoever asked is told what came of it: in sentences, from what happened, in their language."""

from queue import Queue

import pytest

from nl2robot.cli.session import Session
from nl2robot.cli.terminal import Terminal
from tests.nl2robot.test_history import Nurse


class Asker(Nurse):
    """A nurse who wants to hear what came of her errand."""

    def is_told(self, words: str) -> list[str]:
        translation = self.says(words)
        assert translation.program is not None, translation.message
        return self.reads(translation.program)

    def reads(self, program: str) -> list[str]:
        approval = self.operator.approve(self.operator.check(program))
        run = self.operator.run(approval)
        self.operator.wait(run)
        return [each.text for each in self.operator.answer(run, self.language)]


@pytest.fixture
def nurse(operator) -> Asker:
    return Asker(operator)


def test_the_time_is_the_answer(nurse) -> None:
    assert nurse.is_told("what time is it?") == ["It is 08:00."]


def test_a_report_is_told_as_the_robot_gave_it(nurse) -> None:
    told = nurse.is_told("how many people are in ward b?")
    assert told == ["Number of people in ward b: 1."]


def test_what_the_robot_has_told_aloud_is_known(operator) -> None:
    program = 'robot.say("Here I am.")\nprint("noted")\n'
    run = operator.run(operator.approve(operator.check(program)))
    operator.wait(run)
    told = {each.text: each.spoken for each in operator.answer(run)}
    assert told == {"Here I am.": True, "noted": False}


def test_a_poll_is_told_by_person(nurse) -> None:
    told = nurse.reads(
        "start = robot.location()\n"
        'robot.goto("ward a")\n'
        "votes = 0\n"
        'for person in ["Alice", "Henry"]:\n'
        "    try:\n"
        '        if robot.ask("Tea?", ["yes", "no"], person=person) == "yes":\n'
        "            votes += 1\n"
        "    except Exception:\n"
        "        votes += 0\n"
        "robot.goto(start)\n"
        'robot.say(f"{votes} want tea.")\n'
    )
    absent = "Henry: I do not see Henry here. Let me look for Henry first."
    assert told == [absent, "Alice: yes", "1 want tea."]


ROUND = (
    'for place in ["ward a", "charger", "corridor"]:\n'
    "    robot.goto(place)\n"
    '    if robot.sees("person"):\n'
    '        robot.ask("Do you need water?", ["yes", "no"])\n'
)


@pytest.mark.parametrize(
    ("language", "told"),
    [
        ("en", "Nobody was in the charger and in the corridor."),
        ("de", "Niemand war an der Ladestation und im Flur."),
        ("fr", "Ici, il n'y avait personne : la station de charge et le couloir."),
    ],
)
def test_where_there_was_nobody_to_ask_is_told(operator, language: str, told: str) -> None:
    assert told in Asker(operator, language).reads(ROUND)


def test_nobody_is_missed_by_a_look_that_asks_nothing(nurse) -> None:
    program = (
        'for place in ["ward a", "charger"]:\n    robot.goto(place)\n    robot.sees("person")\n'
    )
    assert not [each for each in nurse.reads(program) if each.startswith("Nobody was")]


def test_the_one_answer_that_is_reported_is_not_told_twice(nurse) -> None:
    told = nurse.reads(
        "start = robot.location()\n"
        'robot.goto("ward a")\n'
        'answer = robot.ask("Tea?", ["yes", "no"], person="Alice")\n'
        "robot.goto(start)\n"
        'robot.say(f"Alice said {answer}.")\n'
    )
    assert told == ["Alice said yes."]


def test_what_others_were_told_is_told_with_where(nurse) -> None:
    told = nurse.is_told(
        "go to ward a and say good morning, then go to ward b and say good morning"
    )
    assert told == ["I said “Good morning.” here: ward a, ward b."]


def test_what_nobody_reported_is_told(nurse) -> None:
    told = nurse.reads('robot.goto("ward b")\nrobot.count("person")\nrobot.sees("elephant")\n')
    assert told == ["Number of people in ward b: 1.", "I could not find the elephant."]
    assert nurse.reads('robot.goto("corridor")\nrobot.people()\n') == ["Nobody."]
    assert nurse.reads('robot.goto("corridor")\nrobot.objects()\n') == ["Nothing."]


def test_an_empty_list_is_a_sentence(operator) -> None:
    poll = "robot.say(f\"{start}: {', '.join([])}.\")\n"
    for language, start, told in (
        ("en", "These are the answers", "These are the answers: none."),
        ("de", "Das sind die Antworten", "Das sind die Antworten: keine."),
        ("fr", "Voici les réponses ", "Voici les réponses : aucun."),
    ):
        assert Asker(operator, language).reads(poll.replace("{start}", start)) == [told]


@pytest.mark.parametrize(
    ("language", "words", "told"),
    [
        ("en", "who is in the corridor?", "Nobody."),
        ("en", "what do you see in the corridor?", "Nothing."),
        ("de", "wer ist im Flur?", "Niemand."),
        ("fr", "qui est dans le couloir ?", "Personne."),
    ],
)
def test_nobody_and_nothing_are_answers(operator, language, words, told) -> None:
    assert Asker(operator, language).is_told(words) == [told]


def test_a_look_at_oneself_is_an_answer_where_there_is_no_other(nurse) -> None:
    [battery] = nurse.reads("robot.battery()\n")
    assert battery.startswith("My battery is at ")
    assert nurse.reads("robot.goto('ward a')\nrobot.location()\n") == []


def test_what_did_not_work_is_told_though_the_program_went_on(nurse) -> None:
    program = 'try:\n    robot.grab("elephant")\nexcept Exception:\n    robot.wait(1)\n'
    [told] = nurse.reads(program)
    assert told.startswith("This did not work: take an elephant.")
    nurse.language = "de"
    [told] = nurse.reads(program)
    assert told.startswith(
        "Das ging nicht: „elephant“ nehmen. Der Roboter sieht „elephant“ hier nicht."
    )


@pytest.mark.parametrize(
    ("language", "there"),
    [
        ("de", "„Hm.“ habe ich hier gesagt: Station A."),
        ("fr", "J'ai dit « Hm. » ici : service A."),
    ],
)
def test_in_other_languages(operator, language, there) -> None:
    nurse = Asker(operator, language)
    assert nurse.reads('robot.goto("ward a")\nrobot.say("Hm.")\n') == [there]


@pytest.mark.parametrize(
    ("language", "thing", "told"),
    [
        ("en", "wheelchair", "I could not find the wheelchair."),
        ("de", "Rollstuhl", "Ich habe den Rollstuhl leider nicht gefunden."),
        ("de", "cup", "Gefunden: die Tasse."),
        ("fr", "fauteuil roulant", "Je n'ai pas trouvé le fauteuil roulant."),
        ("fr", "ordinateur", "Je n'ai pas trouvé l'ordinateur."),
    ],
)
def test_what_is_sought_has_its_article(nurse, language: str, thing: str, told: str) -> None:
    nurse.language = language
    assert nurse.reads(f'robot.find("{thing}", "ward b")\n')[0] == told


def test_much_is_told_in_part(nurse) -> None:
    told = nurse.reads('for number in range(40):\n    robot.say(f"{number}")\n')
    assert told[:2] == ["0", "1"] and len(told) == 31
    assert told[-1] == "And 10 more, which stand in the log."


def test_the_terminal_ends_with_the_answer(nl2robot) -> None:
    status, out, _ = nl2robot("run", "--world", "ward", "-y", "what time is it?")
    assert status == 0
    assert out.rstrip().endswith("It is 08:00.")
    _, out, _ = nl2robot("run", "--world", "ward", "-y", "--lang", "de", "wie spät ist es?")
    assert out.rstrip().endswith("Es ist 08:00 Uhr.")


def test_the_terminal_says_done_where_nothing_is_to_be_told(nl2robot) -> None:
    _, out, _ = nl2robot("run", "--world", "ward", "-y", "go to ward a")
    assert out.rstrip().endswith("Done.")


def test_who_failed_tells_what_was_done_before(nl2robot, tmp_path) -> None:
    program = tmp_path / "program.py"
    program.write_text('robot.say("I begin.")\nrobot.put("cup")\n')
    status, out, _ = nl2robot("run", "--world", "ward", "-y", "--program", str(program))
    assert status == 1
    [begin, *end] = out.rstrip().rpartition("I begin.\n")[1:]
    assert begin.strip() == "I begin." and end[0].startswith("The robot could not finish.")


def test_the_voice_says_what_the_robot_has_not_said(operator) -> None:
    heard: Queue[str] = Queue()
    operator.watch(lambda kind, data: heard.put(data["text"]), "speech")
    terminal = Terminal()
    terminal.aloud = True
    session = Session(operator, terminal, approve_all=True)
    session.perform("what time is it?")
    assert heard.get(timeout=30) == "It is 08:00."  # and not a second time
    session.perform_program('robot.goto("ward b")\nrobot.count("person")\n')
    assert heard.get(timeout=30) == "Number of people in ward b: 1."
    session.perform("thank you")
    assert heard.get(timeout=30) == "You are welcome."
    terminal.aloud = False
    session.perform("hello")
    terminal.aloud = True
    session.perform("good morning")
    assert heard.get(timeout=30).startswith("Good morning")


def test_what_was_found_nowhere_is_not_only_missing_where_the_robot_stands(nurse) -> None:
    def ends(program: str) -> list[str | None]:
        review = nurse.operator.check(program)
        approval = nurse.operator.approve(review, insists=True)
        tried = review.dry_run.message if review.dry_run else None
        return [tried, nurse.operator.wait(nurse.operator.run(approval)).message]

    nowhere = 'The robot could not find "blanket", so it did not go on.'
    assert ends('robot.find("blanket")\nrobot.grab("blanket")\n') == [nowhere, nowhere]
    for message in ends('robot.find("blanket")\nrobot.grab("umbrella")\n'):  # another thing
        assert message is not None and message.startswith('The robot does not see "umbrella" here')
