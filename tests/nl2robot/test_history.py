"""Questions about what the robot has done are answered from what really happened."""

import pytest

from nl2robot.translate.outcome import Translation


class Nurse:
    """Somebody who talks with the robot of a station, and approves what it proposes."""

    def __init__(self, operator, language: str = "en") -> None:
        self.operator = operator
        self.language = language

    def says(self, words: str) -> Translation:
        return self.operator.translate(words, self.language, "auto", "a talk")

    def has_done(self, words: str) -> str:
        translation = self.says(words)
        assert translation.program is not None, translation.message
        review = self.operator.check(translation.program)
        insists = not review.came_through
        approval = self.operator.approve(review, translation, insists=insists)
        status = self.operator.wait(self.operator.run(approval))
        return status.state

    def hears(self, words: str) -> str:
        answer = self.says(words)
        assert answer.program is None, answer.program
        assert answer.message is not None
        return answer.message


def test_what_she_said_comes_from_the_run(operator) -> None:
    nurse = Nurse(operator)
    assert "not done anything" in nurse.hears("what did she say?")
    assert nurse.has_done("go to ward a and ask Alice if she wants tea") == "done"
    assert nurse.hears("what did she say?") == (
        "Alice was asked “Do you want tea?” and answered “yes”."
    )
    assert "Alice" in nurse.hears("who said yes?")
    assert nurse.hears("who said no?") == "Nobody said “no”."
    assert nurse.hears("how many said yes?") == "1 of 1 said “yes”."
    assert nurse.hears("what did Henry say") == "I got no answer."
    assert nurse.hears("did you find her?") == "I found Alice."
    assert "is done" in nurse.hears("are you done?")
    assert "not doing anything" in nurse.hears("what are you doing?")


def test_the_conversation_goes_on_after_a_run(operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("how many people are in ward b?") == "done"
    assert nurse.hears("how many was it?") == "Number of people in ward b: 1."
    again = nurse.says("and in ward a?").program
    assert again is not None and 'robot.goto("ward a")' in again and "ward b" not in again
    assert nurse.hears("what will you do?").startswith("I will")
    assert "forget" in nurse.hears("cancel that")
    assert "No command is waiting" in nurse.hears("what will you do?")


def test_a_drive_can_be_taken_back_what_was_said_cannot(operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("say hello") == "done"
    assert "cannot be taken back" in nurse.hears("undo that")
    assert nurse.has_done("go to ward b") == "done"
    assert nurse.says("undo that").program == 'robot.goto("charger")\n'
    assert nurse.has_done("go to ward a") == "done"
    assert nurse.says("come back").program == 'robot.goto("ward b")\n'


def test_a_program_that_was_not_run_is_still_to_be_added_to(operator) -> None:
    nurse = Nurse(operator)
    nurse.says("go to ward a")
    added = nurse.says("and then wave").program
    assert added == 'robot.goto("ward a")\nrobot.gesture("wave")\n'
    assert nurse.has_done("no, ward b") == "done"
    assert nurse.says("and nod").program == 'robot.gesture("nod")\n'


@pytest.mark.parametrize(
    ("language", "command", "question", "answer"),
    [
        ("de", "frag Alice in Station A ob sie Tee möchte", "was hat sie gesagt?", "Alice hat"),
        ("fr", "demande à Alice si elle veut du thé", "qu'est-ce qu'elle a dit ?", "Alice a"),
    ],
)  # fmt: skip
def test_in_other_languages(operator, language, command, question, answer) -> None:
    nurse = Nurse(operator, language)
    assert nurse.has_done(command) == "done"
    assert nurse.hears(question).startswith(answer)


def test_a_run_that_fails_says_why(operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("put down the cup") == "failed"
    assert nurse.hears("what happened?").startswith("I could not finish “put down the cup”.")
    assert nurse.hears("are you done?").startswith("I could not finish")


def test_a_thing_is_put_back_where_it_was_taken_from(operator) -> None:
    nurse = Nurse(operator)
    assert nurse.has_done("take the red cup from ward a to ward b") == "done"
    back = nurse.says("put it back").program
    assert back == 'robot.grab("red cup")\nrobot.goto("ward a")\nrobot.put("red cup")\n'
    assert nurse.has_done("put it back") == "done"


def test_who_has_no_name_goes_by_where_they_are(operator) -> None:
    """Whoever was asked on a round is found again by their ward."""
    nurse = Nurse(operator)
    program = (
        'for place in ["ward a", "ward b"]:\n'
        "    robot.goto(place)\n"
        '    robot.ask("Do you need water?", ["yes", "no"])\n'
    )
    review = operator.check(program)
    operator.wait(operator.run(operator.approve(review, insists=not review.came_through)))
    said = " ".join(nurse.hears(f"who said {answer}?") for answer in ("yes", "no"))
    assert "Ward a" in said or "Ward b" in said, said
    assert "Somebody" not in said
