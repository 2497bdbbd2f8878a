"""After a stop, an approved program goes on from where it was, and does nothing twice."""

import pytest

from nl2robot.going_on import DoneCall, Recall, asks_to_go_on
from robot_api.errors import Blocked, NotPossible, Stopped
from tests.nl2robot.test_pausing import Watching
from tests.nl2robot.test_runner import start as run_program
from tests.nl2robot.test_runner import what

ROUND = """\
asked = []
for place in ["ward a", "ward b"]:
    robot.goto(place)
    robot.say("Good evening.")
    asked.append(robot.battery() > 0)
robot.goto("ward a")
robot.say("I was at " + str(len(asked)) + " places.")
"""


def stopped_at(operator, program: str, number: int) -> int:
    """Run it, and stop the robot in its so-manieth call."""
    watch = Watching(operator)
    run = run_program(operator, program)
    watch.until(what("call", number=number))
    operator.stop()
    assert operator.wait(run).state == "stopped"
    return run


def going_on(operator, language: str = "en") -> tuple[int, list[str]]:
    """Review and approve what is left; the run's number and what was told of it."""
    left = operator.unfinished(language)
    review = operator.check(left.program, language, left.run)
    return operator.run(operator.approve(review, continues=left.run)), left.told


def made(log, run) -> list[tuple[str, object]]:
    return [(call.method, call.result) for call in log.calls(run)]


def test_what_was_done_is_not_done_again(slow_operator, slow_station, log) -> None:
    run = stopped_at(slow_operator, ROUND, 4)
    where = slow_station.simulation.robot.place
    left = slow_operator.unfinished()
    assert where == "ward a" or slow_station.simulation.robot.speed == 0
    assert left.told[0].startswith("Done already, and not done again: ")
    assert "ood evening" in left.told[0]
    assert "line 3" in left.told[1]
    dry_run = slow_operator.check(left.program, "en", left.run).dry_run
    assert dry_run.status == "done"
    assert dry_run.says == ("Good evening.", "I was at 2 places.")
    again, _ = going_on(slow_operator)
    assert slow_operator.wait(again).state == "done"
    assert [method for method, _ in made(log, again)] == [
        *("goto", "say", "battery"),
        *("goto", "say"),
    ]
    assert log.run(again).continues == run
    assert log.calls(again)[-1].arguments.count("2 places") == 1


def test_one_can_go_on_again_and_again(slow_operator, log) -> None:
    stopped_at(slow_operator, ROUND, 4)
    watch = Watching(slow_operator)
    second, told = going_on(slow_operator, "de")
    assert told[0].startswith("Schon getan und nicht noch einmal: ")
    watch.until(what("call", run=second, method="goto"))
    watch.until(what("call", run=second, method="say"))
    slow_operator.stop()
    assert slow_operator.wait(second).state == "stopped"
    third, told = going_on(slow_operator, "fr")
    assert told[0].startswith("Déjà fait")
    assert slow_operator.wait(third).state == "done"
    assert [method for method, _ in made(log, third)] == ["say", "battery", "goto", "say"]


def test_the_log_keeps_what_was_said_for_what_goes_on(slow_operator, log) -> None:
    translation = slow_operator.translate("go to ward a, go to ward b and say hello")
    watch = Watching(slow_operator)
    approval = slow_operator.approve(slow_operator.check(translation.program), translation)
    run = slow_operator.run(approval)
    watch.until(what("call", number=2))
    slow_operator.stop()
    slow_operator.wait(run)
    again, _ = going_on(slow_operator)
    assert slow_operator.wait(again).state == "done"
    assert log.run(again).utterance == translation.utterance


def test_going_on_needs_an_approval_of_its_own(slow_operator) -> None:
    run = stopped_at(slow_operator, ROUND, 1)
    other = slow_operator.check('robot.say("Something else.")\n')
    with pytest.raises(NotPossible, match="could go on with"):
        slow_operator.approve(other, continues=run)
    with pytest.raises(NotPossible, match="could go on with"):
        slow_operator.check(other.program, "en", run)


def test_nothing_is_left_of_what_came_to_its_end_or_failed_by_itself(operator) -> None:
    operator.wait(run_program(operator, 'robot.say("Done.")\n'))
    assert operator.unfinished() is None
    operator.wait(run_program(operator, 'robot.say("So.")\nprint(1 / 0)\n'))
    assert operator.unfinished() is None


def test_what_failed_at_the_robot_can_be_tried_again(operator) -> None:
    run = run_program(operator, 'robot.say("Now.")\nrobot.grab("unicorn")\n')
    assert operator.wait(run).state == "failed"
    left = operator.unfinished()
    assert left.run == run
    assert "line 2" in left.told[1]


def test_a_program_that_calls_otherwise_is_ended_before_it_does_anything() -> None:
    done = [
        DoneCall("goto", {"place": "ward a"}, 1, None),
        DoneCall("goto", {"place": "ward b"}, 2, None, "Blocked: A bed is in the way."),
        DoneCall("say", {"text": "Hello."}, 3, None),
    ]
    recall = Recall(done)
    assert recall.answer("goto", {"place": "ward a"}) is None
    with pytest.raises(Blocked, match="A bed is in the way"):
        recall.answer("goto", {"place": "ward b"})
    with pytest.raises(Stopped):
        recall.answer("say", {"text": "Goodbye."})
    assert "Goodbye." in recall.deviation


@pytest.mark.parametrize(
    ("words", "language"), [("Go on!", "en"), ("weiter", "de"), ("Continue.", "fr")]
)
def test_it_is_said_in_three_languages(words, language) -> None:
    assert asks_to_go_on(words, language)
    assert not asks_to_go_on("go to ward a", language)


def test_in_a_conversation_one_says_go_on(start) -> None:
    chat = start("chat", "--world", "ward", "--speed", "1", at_terminal=True)
    chat.until("you: ")
    chat.type("go to ward a and then go to ward b\n")
    chat.until("eject? ")
    chat.type("a\n")
    chat.until("goto(place='ward a')")
    chat.type("stop\n")
    chat.until("Stopped.")
    chat.until("you: ")
    chat.type("go on\n")
    assert "It goes on at line 1" in chat.until("eject? ")
    chat.type("a\n")
    chat.until("goto(place='ward b')")
    chat.type("bye\n")
