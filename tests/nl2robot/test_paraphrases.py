"""Commands of a home with their logical forms: what counts as understood."""

import json

import pytest

from grammar.understand import understand
from nl2robot.checks.frames import frames_of_form, frames_of_plan, parsed
from nl2robot.checks.paraphrases import Row, load, score
from nl2robot.cli.main import main
from nl2robot.knowledge import Knowledge
from sim.world.loading import load_world

TEA = '( is_a $1 " <object> " )'
ALEX = '( lambda $1 e ( person $1 ) ( name $1 " <name> " ) ( at $1 " <location> " ) )'
BRING_ALEX = f"( bring ( lambda $1 e {TEA} ) {ALEX} )"
GUIDE = '( guide ( lambda $1 e ( person $1 ) ( name $1 " <name> " ) ) UNKNOWN )'
SOMEBODY = '( lambda $1 e ( person $1 ) ( at $1 " <room> " ) )'


HOME = Knowledge(load_world("household", names_only=True))


@pytest.fixture(scope="module")
def lexicon():
    return HOME.lexicon("en")


def frames(words: str, lexicon) -> list[str]:
    plan = understand(words, lexicon).plan
    assert plan is not None
    return [str(each) for each in frames_of_plan(plan, lexicon)]


@pytest.mark.parametrize(
    ("form", "frame"),
    [
        ('( go " <room> " )', "go(to.at)"),
        (f"( bring ( lambda $1 e {TEA} ) )", "bring(to.me)"),
        (f"( bring ( lambda $1 e {TEA} ) {ALEX} )", "bring(to.at, to.name)"),
        (
            f'( bring ( lambda $1 e {TEA} ( heaviest $1 3 ) ) " <location> " )',
            "bring(thing.at, thing.count=3, thing.superlative=heaviest, to.me)",
        ),
        (
            f"( bring ( lambda $1 e ( lambda $2 e {TEA} ( behind $1 $2 ) ) ) )",
            "bring(thing.relation=behind, to.me)",
        ),
        (f"( guide {ALEX} UNKNOWN )", "guide(to.at, who.at, who.name)"),
        (f'( say ( answer " <question> " ) {SOMEBODY} )', "say(to.at, what=answer)"),
        (
            "( say ( lambda $1 e ( lambda $2 e ( person $2 ) ( pose $2 $1 ) "
            '( at $2 " <room> " ) ) ) )',
            "say(asked=description, thing.at, to.me)",
        ),
        (
            "( say ( count ( lambda $1 e ( person $1 ) ( lying $1 ) ) ) )",
            "count(thing.pose=lying, to.me)",
        ),
        (
            f'( lambda $1 e ( sequence ( follow {ALEX} ) ( guide $1 " current " ) ) )',
            "follow(who.at, who.name); guide(to.back, who.name)",
        ),
    ],
)
def test_a_logical_form_becomes_frames(form: str, frame: str) -> None:
    assert "; ".join(map(str, frames_of_form(parsed(form)))) == frame


@pytest.mark.parametrize(
    ("words", "frame"),
    [
        ("drive to the kitchen", ["go(to.at)"]),
        ("bring me the tea from the sideboard", ["bring(thing.at, to.me)"]),
        ("bring the tea to Alex in the kitchen", ["bring(to.at, to.name)"]),
        ("carry the tea to the sideboard", ["put(to.at)"]),
        ("take Alex from the sofa to the study", ["guide(to.at, who.at, who.name)"]),
        ("follow Alex to the study", ["follow(who.name)", "go(to.at)"]),
        ("bring me the biggest box", ["bring(thing.superlative=biggest, to.me)"]),
        ("what is the lightest box", ["say(thing.superlative=lightest, to.me, what=which)"]),
        ("tell a woman in the study a joke", ["say(to.at, to.gender=female, what=text)"]),
        ("how many apples are on the desk", ["count(thing.at, to.me)"]),
        ("is there any milk in the kitchen", ["find(thing.at)"]),
        ("which things are on the desk", ["find(thing.at)"]),
        ("find two cups in the kitchen", ["find(thing.at, thing.count=2)"]),
        ("find the man in the study and tell me his name", ["say(asked=name, thing.at, to.me)"]),
    ],
)  # fmt: skip
def test_a_plan_becomes_frames(words: str, frame: list[str], lexicon) -> None:
    assert frames(words, lexicon) == frame


@pytest.mark.parametrize(
    ("words", "form", "outcome", "head"),
    [
        ("bring the tea to Alex by the sofa", BRING_ALEX, "right", True),
        ("bring the tea from the sofa to Alex", BRING_ALEX, "wrong", True),
        ("drive to the <room>", '( go " <room> " )', "right", True),
        ("wibble the tea", f"( bring ( lambda $1 e {TEA} ) )", "refused", False),
        ("guide Alex", GUIDE, "right", True),
        ("carry the tea to the sofa", "UNKNOWN", "wrong", False),
    ],
)  # fmt: skip
def test_the_score_of_a_command(words: str, form: str, outcome: str, head: bool) -> None:
    result = score(Row(words, form), HOME)
    assert (result.outcome, result.head) == (outcome, head), result


@pytest.fixture
def file(tmp_path):
    file = tmp_path / "commands.tsv"
    rows = [
        "utterance\tlogical_form",
        'go to the study\t( go " <room> " )',
        'sing\t( go " <room> " )',
    ]
    file.write_text("\n".join(rows), encoding="utf-8")
    return file


def test_the_command_prints_the_shares(file, capsys) -> None:
    assert main(["paraphrases", str(file), "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures == {"rows": 2, "head": 0.5, "right": 0.5, "refused": 0.5, "wrong": 0.0}
    assert main(["paraphrases", str(file)]) == 0
    assert "go room" in capsys.readouterr().out
    assert main(["paraphrases", str(file), "--misses"]) == 0
    assert "refused: sing" in capsys.readouterr().out


@pytest.mark.parametrize("text", ["no tab here", "go\t( go ", "go\t) ("])
def test_a_broken_file_is_told_with_its_line(text: str, tmp_path, capsys) -> None:
    file = tmp_path / "broken.tsv"
    file.write_text(text, encoding="utf-8")
    assert main(["paraphrases", str(file)]) == 2
    assert "broken.tsv:1" in capsys.readouterr().err


def test_some_commands_of_a_file_may_be_enough(file, capsys) -> None:
    assert main(["paraphrases", str(file), "--most", "1", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["rows"] == 1


def test_the_first_line_may_name_the_columns(file) -> None:
    assert [row.words for row in load(file)] == ["go to the study", "sing"]
