"""After a stop, an approved program goes on from where it was, and does nothing twice."""

import math

import msgspec
import pytest

from nl2robot.review.rehearsal import watched
from nl2robot.run.going_on import DoneCall, Recall, asks_to_go_on, unfinished
from nl2robot.run.rounds_left import rounds
from nl2robot.station.station import simulated_station
from robot_api.errors import Blocked, NotPossible, Stopped
from sim.simulation import Simulation
from sim.world.loading import load_world
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
    assert left.told[:2] == [
        "Done already, and not done again: ward a.",
        "Still to do: ward b. It goes on with ward b, at line 3.",
    ]
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


def test_of_a_round_people_and_places_are_told(slow_operator) -> None:
    program = (
        'robot.say("Here I come.")\n'
        'wards = robot.places("ward")\n'
        "for place in wards:\n"
        "    robot.goto(place)\n"
        "    for person in robot.people():\n"
        '        robot.ask("Tea?", ["yes", "no"], person=person)\n'
        "robot.dock()\n"
    )
    stopped_at(slow_operator, program, 6)
    done = [
        "Done already, and not done again: say “Here I come.”; ward a.",
        "Still to do: ward b. It goes on with ward b, at line 4.",
    ]
    assert slow_operator.unfinished().told[:2] == done
    assert slow_operator.unfinished("de").told[1] == (
        "Noch zu tun: Station B. Es geht weiter mit Station B, in Zeile 4."
    )


def test_a_round_that_was_over_is_told_as_what_it_went_through() -> None:
    program = (
        'for who in ["Alice", "Henry"]:\n'
        '    robot.ask("Tea?", person=who)\n'
        "for number in range(3):\n"
        "    robot.wait(number)\n"
        'robot.goto("lobby")\n'
    )
    done = [
        DoneCall("ask", {"question": "Tea?", "person": "Alice"}, 2, "yes"),
        DoneCall("ask", {"question": "Tea?", "person": "Henry"}, 2, "no"),
        DoneCall("wait", {"seconds": 0}, 4),
    ]
    [over] = rounds(program, done, 5, DoneCall("goto", {"place": "lobby"}, 5))
    assert (over.done, over.left) == (("Alice", "Henry"), ())


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


# --- of a movement only the rest


def stopped_after(operator, station, program: str, metres: float) -> int:
    """Run it, and stop the robot when it has come so far."""
    began, watch = station.simulation.robot, Watching(operator)
    run = run_program(operator, program)
    watch.until(
        lambda kind, data: (
            kind == "pose" and math.hypot(data["x"] - began.x, data["y"] - began.y) > metres
        )
    )
    operator.stop()
    assert operator.wait(run).state == "stopped"
    return run


def driven(station, before) -> float:
    robot = station.simulation.robot
    return math.hypot(robot.x - before.x, robot.y - before.y)


@pytest.mark.parametrize("slow_station", [2], indirect=True)  # twice, on a busy machine
@pytest.mark.parametrize(
    ("program", "call", "whole"),
    [
        ("robot.move(3)\n", "metres", 3.0),
        ("robot.drive(0.3, 0, 8)\n", "seconds", 8.0),
    ],
)
def test_a_bed_comes_along_and_only_the_rest_of_the_way_is_made(
    slow_operator, slow_station, log, program, call, whole
) -> None:
    before = slow_station.simulation.robot
    stopped_after(slow_operator, slow_station, program, 0.6)
    made_so_far = driven(slow_station, before)
    left = slow_operator.unfinished()
    assert len(left.told) == 2, "nothing was done but a part of this"
    assert "only the rest of it is left" in left.told[1]
    dry_run = slow_operator.check(program, "en", left.run).dry_run
    assert dry_run.metres == pytest.approx(
        abs(whole if call == "metres" else 2.4) - made_so_far, abs=0.2
    )
    again, _ = going_on(slow_operator)
    assert slow_operator.wait(again).state == "done"
    assert driven(slow_station, before) == pytest.approx(
        abs(whole) if call == "metres" else 2.4, abs=0.15
    )
    [rest] = log.calls(again)
    assert abs(msgspec.json.decode(rest.arguments)[call]) < abs(whole) - 0.5
    assert slow_operator.unfinished() is None


def test_a_turn_that_was_stopped_ends_where_it_should_have(log, sit_down) -> None:
    with simulated_station(load_world("ward"), log, seed=1, speed=2) as station:
        operator = sit_down(station)
        before, watch = station.simulation.robot.theta, Watching(operator)
        run = run_program(operator, "robot.turn(270)\n")
        watch.until(lambda kind, data: kind == "pose" and abs(data["theta"] - before) % 360 > 60)
        operator.stop()
        operator.wait(run)
        again, told = going_on(operator, "de")
        assert told[-1].startswith("Ein Teil dieses Schritts ist schon getan") and "°" in told[-1]
        assert operator.wait(again).state == "done"
        off = (station.simulation.robot.theta - before - 270 + 180) % 360 - 180
        assert off == pytest.approx(0, abs=6)


@pytest.mark.parametrize("slow_station", [3], indirect=True)  # three times, on a busy machine
def test_paused_stopped_and_stopped_again_it_makes_it_once(slow_operator, slow_station, log):
    """Each of them leaves less of it; what follows is done once, too."""
    program = 'robot.move(4)\nrobot.say("Here I am.")\n'
    before, watch = slow_station.simulation.robot, Watching(slow_operator)
    run = run_program(slow_operator, program)
    watch.until(lambda kind, data: kind == "pose" and driven(slow_station, before) > 0.4)
    slow_operator.pause()
    watch.until_state("paused")
    slow_operator.resume()
    watch.until(lambda kind, data: kind == "pose" and driven(slow_station, before) > 1.0)
    slow_operator.stop()
    assert slow_operator.wait(run).state == "stopped"
    second, _ = going_on(slow_operator)
    watch.until(lambda kind, data: kind == "pose" and driven(slow_station, before) > 1.6)
    slow_operator.stop()
    assert slow_operator.wait(second).state == "stopped"
    third, told = going_on(slow_operator, "fr")
    assert told[-1].startswith("Une partie de cette étape est déjà faite")
    assert slow_operator.wait(third).state == "done"
    assert driven(slow_station, before) == pytest.approx(4, abs=0.2)
    assert [method for method, _ in made(log, third)] == ["move", "say"]


def test_who_goes_on_is_told_that_the_robot_was_moved_meanwhile(
    slow_operator, slow_station
) -> None:
    stopped_after(slow_operator, slow_station, "robot.move(3)\n", 0.6)
    assert not any("no longer" in each for each in slow_operator.unfinished().told)
    slow_operator.robot.turn(90)
    assert "no longer faces the way" in slow_operator.unfinished().told[-1]
    slow_operator.robot.goto("ward b")
    [*_, moved] = slow_operator.unfinished().told
    assert "The robot is no longer where it stopped, but " in moved
    assert "goes on from where it is now" in moved


def test_of_what_a_log_from_before_has_no_measure_it_is_all_done_again(log) -> None:
    about = {"approved_by": "Nurse Kim", "approved_at": 0.0, "sha256": "0" * 64}
    run = log.begin(program="robot.move(3)\n", **about)
    log.call_begins(run, 1, 1, "move", '{"metres":3}')
    log.call_ends(run, 1, 2.0, error="Stopped: The nurse said so.")
    log.end(run, "stopped", None)
    again = unfinished(log).again
    assert (again.arguments, again.left) == ({"metres": 3}, {"metres": 3})
    log.made(run, 1, '{"metres":2.99,"degrees":0.0}')
    assert (unfinished(log).again, len(unfinished(log).done)) == (None, 1)


def test_a_movement_that_a_pause_broke_off_at_its_very_end_is_done(log) -> None:
    """The next call is another one, not the rest of it."""
    about = {"approved_by": "Nurse Kim", "approved_at": 0.0, "sha256": "0" * 64}
    run = log.begin(program='robot.move(1)\nrobot.say("Here.")\n', **about)
    log.call_begins(run, 1, 1, "move", '{"metres":1}')
    log.call_ends(run, 1, 2.0, error="Paused: Halted.", made='{"metres":0.99,"degrees":0.0}')
    log.call_begins(run, 2, 2, "say", '{"text":"Here."}')
    log.call_ends(run, 2, 0.1, error="Stopped: The nurse said so.")
    log.end(run, "stopped", None)
    rest = unfinished(log)
    assert [call.method for call in rest.done] == ["move"]
    assert rest.again.method == "say"


def test_a_dry_run_that_comes_to_other_calls_has_not_come_through() -> None:
    simulation = Simulation(load_world("ward"))
    recall = Recall([DoneCall("say", {"text": "Hello."}, 1)])
    dry_run, _ = watched('robot.say("Goodbye.")\n', simulation, recall=recall)
    assert (dry_run.status, dry_run.error) == ("failed", "Deviates")
    again = DoneCall("move", {"metres": 3}, 1, left={"metres": 1})
    other = Simulation(load_world("ward"))
    dry_run, _ = watched("robot.move(2)\n", other, recall=Recall([], again))
    assert (dry_run.status, dry_run.metres) == ("failed", 0)


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
