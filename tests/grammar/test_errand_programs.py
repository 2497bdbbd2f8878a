"""What errands need beyond calls: tallies, figures, deadlines, as programs that run."""

from __future__ import annotations

import textwrap

from hypothesis import HealthCheck, given, settings

from grammar import plan as p
from grammar.explain import explain
from grammar.program import write_program
from grammar.program_parser import parse_program
from robot_api.stub import stub
from sandbox.check import check
from tests.grammar import sensible_plans
from tests.sandbox.ward import Ward

STUB = stub()
MODEST = settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
ANSWER, VOTES = p.Recall("answer"), p.Recall("votes")


def text(value: str) -> p.Text:
    return p.Text(value)


def call(method: str, save_as: str | None = None, /, **arguments: p.Value) -> p.Call:
    return p.Call(method, dict(arguments), save_as)


def say(*parts: p.Value | str) -> p.Call:
    said = (text(part) if isinstance(part, str) else part for part in parts)
    return call("say", text=p.Sentence(tuple(said)))


def question(words: str, *options: str) -> p.Call:
    asked = call("ask", "answer", question=text(words))
    if options:
        asked.arguments["options"] = p.Items(tuple(map(text, options)))
    return asked


def ran(plan: p.Plan, *answers: str) -> list[str]:
    """What the robot says when the program of the plan is run."""
    program = write_program(plan)
    assert [each for each in check(program, STUB) if each.severity == "error"] == []
    assert write_program(parse_program(program, plan.language)) == program
    ward = Ward(answers)
    outcome = ward.run(program)
    assert outcome.status == "done", f"{outcome}\n{program}"
    return ward.said


def program_of(plan: p.Plan) -> str:
    """The program without the helpers at its top."""
    return write_program(plan).rpartition("\n\n\n")[2]


def lines(source: str) -> str:
    return textwrap.dedent(source).lstrip("\n")


POLL = p.Plan(
    (
        p.Remember("votes", p.Record()),
        p.Repeat(
            p.Number(3),
            (question("Tea or coffee?", "tea", "coffee"), p.Increase("votes", key=ANSWER)),
        ),
        say(
            p.KeyOf("max", VOTES), " has won with ", p.Item(VOTES, p.KeyOf("max", VOTES)), " votes."
        ),
        p.ForEach("drink", VOTES, (say(p.Recall("drink"), ": ", p.Recall("count")),), "count"),
    )
)


def test_votes_are_counted_for_each_answer() -> None:
    assert program_of(POLL) == lines("""
        votes = {}
        for repetition in range(3):
            answer = robot.ask("Tea or coffee?", ["tea", "coffee"])
            votes[answer] = votes.get(answer, 0) + 1
        robot.say(f"{key_of_max(votes)} has won with {votes[key_of_max(votes)]} votes.")
        for drink, count in votes.items():
            robot.say(f"{drink}: {count}")
        """)
    assert ran(POLL, "tea", "coffee", "tea") == ["tea has won with 2 votes.", "tea: 2", "coffee: 1"]


def test_votes_are_told_as_a_tally() -> None:
    assert explain(POLL) == (
        "I will start an empty table: the tally of votes. "
        "Then, three times, I will ask “Tea or coffee?” and take one of the answers “tea” or "
        "“coffee” and then add one to the entry for the answer in the tally of votes. "
        "Then I will say “[the one with the highest value in the tally of votes] has won with [the "
        "entry for the one with the highest value in the tally of votes in the tally of votes] "
        "votes.” "
        "Then, for each entry in the tally of votes, I will say “[this drink]: [its value]”."
    )


def test_numbers_in_words_are_counted_with_in_every_language() -> None:
    for language, answer in (("en", "twenty five"), ("de", "fünfundzwanzig"), ("fr", "vingt-cinq")):
        plan = p.Plan(
            (
                question("?"),
                p.Remember("age", p.NumberIn(ANSWER)),
                p.If(
                    p.Both(
                        (
                            p.Compare(p.Recall("age"), ">=", p.Number(18)),
                            p.Compare(p.Recall("age"), "<", p.Number(65)),
                        )
                    ),
                    (say(p.Arithmetic(p.Number(65), "-", p.Recall("age"))),),
                ),
                p.Repeat(ANSWER, (p.Increase("age"),)),
                say("= ", p.Recall("age")),
            ),
            language,
        )
        assert ran(plan, answer) == ["40", "= 50"]


def test_waiting_has_an_end() -> None:
    nobody = p.Not(p.Holds(p.Ask("sees", {"thing": text("person")})))
    plan = p.Plan(
        (
            p.Remember("begin", p.Ask("clock", field="time")),
            p.While(
                p.Both((nobody, p.Compare(p.Elapsed(p.Recall("begin")), "<", p.Number(10)))), ()
            ),
            call("wait_for", "came", thing=text("visitor"), timeout=p.Number(60)),
        )
    )
    assert program_of(plan) == lines("""
        begin = robot.clock().time
        while not robot.sees("person") and minutes_since(begin) < 10:
            robot.wait(1)
        came = robot.wait_for("visitor", timeout=60)
        """)
    assert "I do not see a person and it is less than 10 minutes since the time at" in explain(plan)


def test_some_are_left_out() -> None:
    names = p.Items(tuple(map(text, ("Bob", "Alice", "Bob"))))
    plan = p.Plan(
        (
            p.Remember("names", names),
            p.ForEach(
                "name",
                p.Sorted(p.Distinct(p.Recall("names"))),
                (
                    p.If(p.Compare(p.Recall("name"), "==", text("Alice")), (p.Continue(),)),
                    say("Hello ", p.Recall("name")),
                ),
            ),
            say(
                p.Occurrences(p.Recall("names"), text("Bob")),
                ", the last: ",
                p.Item(p.Recall("names"), p.Number(-1)),
            ),
        )
    )
    assert program_of(plan) == lines("""
        names = ["Bob", "Alice", "Bob"]
        for name in sorted(list(dict.fromkeys(names))):
            if name.lower() == "alice":
                continue
            robot.say(f"Hello {name}")
        robot.say(f"{names.count('Bob')}, the last: {names[-1]}")
        """)
    assert ran(plan) == ["Hello Bob", "2, the last: Bob"]


def test_a_round_cut_short_does_not_spin() -> None:
    sees = p.Holds(p.Ask("sees", {"thing": text("person")}))
    plan = p.Plan((p.Forever((p.If(p.Not(sees), (p.Continue(),)), say("Hello"))),))
    assert program_of(plan) == lines("""
        while True:
            if not robot.sees("person"):
                robot.wait(1)
                continue
            robot.say("Hello")
        """)


def test_whether_something_is_so_can_be_kept() -> None:
    plan = p.Plan(
        (
            question("Coffee?"),
            p.Remember(
                "yes",
                p.Both(
                    (
                        p.Compare(ANSWER, "==", text("yes")),
                        p.Not(p.Holds(p.Ask("sees", {"thing": text("cup")}))),
                    )
                ),
            ),
            p.If(p.Holds(p.Recall("yes")), (say("I bring a cup."),), (say("Fine."),)),
        )
    )
    assert program_of(plan) == lines("""
        answer = robot.ask("Coffee?")
        yes = answer.lower() == "yes" and not robot.sees("cup")
        if yes:
            robot.say("I bring a cup.")
        else:
            robot.say("Fine.")
        """)
    assert ran(plan, "yes") == ["I bring a cup."]


def test_why_something_failed_can_be_told() -> None:
    plan = p.Plan(
        (
            p.Try(
                (call("goto", place=text("moon")),),
                (say("I could not go: ", p.Recall("reason")),),
                "reason",
            ),
        )
    )
    assert program_of(plan) == lines("""
        try:
            robot.goto("moon")
        except Exception as reason:
            robot.say(f"I could not go: {reason}")
        """)
    assert ran(plan) == ["I could not go: There is no place called moon. Say one of its places."]


def test_what_is_calculated_keeps_its_brackets() -> None:
    one, two, count = p.Number(1), p.Number(2), p.Recall("count")
    plan = p.Plan(
        (
            p.Remember("count", p.Number(7)),
            p.Remember("a", p.Arithmetic(p.Arithmetic(count, "-", one), "*", two)),
            p.Remember("b", p.Arithmetic(count, "-", p.Arithmetic(one, "-", two))),
            p.Remember("c", p.Arithmetic(p.Arithmetic(count, "-", one), "-", p.Number(-2))),
            p.Remember("d", p.Arithmetic(p.Number(0), "-", p.Arithmetic(count, "//", two))),
            p.Increase("count", p.Arithmetic(p.Number(0), "-", p.Recall("a"))),
            say(*(p.Sentence((p.Recall(name), text(" "))) for name in "abcd"), count),
        )
    )
    assert program_of(plan).splitlines()[1:6] == [
        "a = (count - 1) * 2",
        "b = count - (1 - 2)",
        "c = count - 1 - (-2)",
        "d = -(count // 2)",
        "count -= a",
    ]
    assert ran(plan) == ["12 8 8 -3 -5"]


@MODEST
@given(sensible_plans.plans)
def test_what_makes_sense_passes_the_check_and_runs_to_its_end(plan: p.Plan) -> None:
    ran(plan, "five")
