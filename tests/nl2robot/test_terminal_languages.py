"""The terminal says the same in three languages: places, numbers, errors, questions."""

import string

import pytest

from grammar.language import languages
from nl2robot.errors import ExitStatus
from nl2robot.run.trouble import _meanings, told
from nl2robot.words import decimal, words_in
from robot_api import errors


def _texts(words, path=""):
    for key, value in words.items():
        if isinstance(value, str):
            yield f"{path}{key}", value
        elif isinstance(value, dict):
            yield from _texts(value, f"{path}{key}.")


@pytest.mark.parametrize("language", languages())
def test_every_text_is_there_and_tells_the_same(language) -> None:
    english, theirs = dict(_texts(words_in("en"))), dict(_texts(words_in(language)))
    assert theirs.keys() == english.keys()
    for name, text in theirs.items():
        gaps = [
            {field for _, field, _, _ in string.Formatter().parse(each) if field}
            for each in (text, english[name])
        ]
        assert gaps[0] == gaps[1], name
        if language != "en" and len(text) > 25:
            assert text != english[name], name


@pytest.mark.parametrize("language", languages())
def test_every_error_of_a_robot_means_something_in_every_language(language) -> None:
    for kind in (errors.UnknownPlace, errors.Blocked, errors.LostConnection, errors.NotFound):
        said = told(kind.__name__, "The English sentence.", language)
        assert said == "The English sentence." if language == "en" else "English" in said
    assert all(language in meaning for meaning in _meanings().values())


def test_numbers_have_their_comma() -> None:
    assert [decimal(12.5, language) for language in ("en", "de", "fr")] == ["12.5", "12,5", "12,5"]


@pytest.mark.parametrize(
    ("language", "said", "way", "end"),
    [
        ("de", "fahr zur Apotheke", "Weg: Ladestation → Eingangshalle → Hauptflur", "Fertig."),
        ("fr", "va à la pharmacie", "chemin: station de charge → hall → couloir", "C'est fait."),
    ],
)
def test_places_on_the_way_have_their_names(nl2robot, language, said, way, end) -> None:
    status, out, err = nl2robot("run", "--yes", "--lang", language, said)
    assert (status, err) == (ExitStatus.OK, "")
    assert way in out and end in out
    assert "main corridor" not in out


def test_an_error_says_in_german_what_it_means(nl2robot, tmp_path) -> None:
    (tmp_path / "grab.py").write_text('robot.grab("unicorn")\n')
    program = ("--program", str(tmp_path / "grab.py"))
    status, out, _ = nl2robot("run", "--world", "ward", "--lang", "de", "--yes", *program)
    assert status == ExitStatus.FAILED
    said = " ".join(out.split())
    assert said.count("Der Roboter sieht „unicorn“ hier nicht.") >= 2  # tried out, and at the end
    assert "does not see" not in said


def test_how_a_sentence_is_read_is_told_in_the_language(nl2robot) -> None:
    _, out, _ = nl2robot("explain", "--lang", "fr", "va au hall")
    assert "lu comme" in out and "compris" in out and "read as" not in out
    _, out, _ = nl2robot("explain", "--lang", "de", "färbe den Mond")
    assert "nicht verstanden" in out
    assert "Die Themen sind" in nl2robot("phrases", "--lang", "de", "quatsch")[2]
