"""Clauses that were taken for something else, most of them found in French: two things put in two
places, how often something is done in a message, how long is waited where, nobody, whoever is left
out, things named by their adjective, and who is meant in what is passed on."""

from __future__ import annotations

import pytest

from tests.grammar.test_kinds import program, said


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("fr", "Pose {} dans la cuisine et {} à la pharmacie."),
        ("de", "Stell {} in die Küche und {} in die Apotheke."),
        ("en", "put {} in the kitchen and {} in the pharmacy."),
    ],
)
def test_two_things_are_put_in_two_places(language: str, words: str) -> None:
    things = {
        "fr": ("la pomme", "le carton"),
        "de": ("den Apfel", "die Kiste"),
        "en": ("the apple", "the box"),
    }[language]
    first, second = program(language, words.format(*things)).split("put(", 1)
    assert 'goto("kitchen")' in first
    assert 'place="kitchen"' not in first
    assert 'goto("pharmacy")' in second


@pytest.mark.parametrize(
    ("language", "words", "often"),
    [
        ("fr", "Dis à Grace de boire un verre toutes les deux heures.", "toutes les deux heures"),
        ("fr", "Dis à Rosa que le café est servi toutes les heures.", "toutes les heures"),
        ("en", "Tell Grace to drink a glass every two hours.", "every two hours"),
    ],
)
def test_how_often_something_is_to_be_done_is_told(language: str, words: str, often: str) -> None:
    said_once = program(language, words)
    assert "while" not in said_once
    assert f'{often}.")' in said_once
    assert "while True" in program("fr", "Dis bonsoir toutes les dix minutes.")


@pytest.mark.parametrize(
    ("words", "seconds", "place"),
    [
        ("Attends sept minutes à la pharmacie.", 420, "pharmacy"),
        ("Patiente encore une minute dans le hall.", 60, "lobby"),
        ("Attends environ vingt secondes.", 20, None),
        ("Attends une petite demi-heure à la cuisine.", 1800, "kitchen"),
        ("Attends deux bonnes minutes.", 120, None),
    ],
)
def test_a_time_to_wait_is_waited_there(words: str, seconds: int, place: str | None) -> None:
    written = program("fr", words)
    assert f"robot.wait({seconds})" in written
    assert "wait_for" not in written
    assert place is None or f'goto("{place}")' in written


@pytest.mark.parametrize(
    "words",
    [
        "Donne à personne le dossier vert.",
        "Demande à personne s'il a soif.",
        "Dis à personne de venir.",
        "Dis rien à Rosa.",
        "Prends toutes les tasses sauf la rouge.",
        "Apporte les livres excepté le bleu à Rosa.",
        "Apporte un livre à Henry de la part de Lina.",
        "Prends soin de Grace.",
        "Donne une leçon à Paul.",
        "Va à la cuisine si Rosa y est.",
        "Dis à Paul, elle est dans le hall, que la clé est perdue.",
        "Dis à Rosa que je t'ai attendu.",
        "Dis à Paul que ton bras est cassé.",
        "Dis à Rosa que Paul arrive et qu'il la remercie.",
        "Dis à Paul que c'est lui qui est en retard.",
        "Demande à Rosa où elle travaille et pourquoi elle part.",
        "Demande à Paul lequel des trois cartons il veut.",
    ],
)
def test_what_is_not_understood_is_not_done(words: str) -> None:
    assert said("fr", words).program is None


def test_who_is_left_out_is_not_spoken_to() -> None:
    written = program("fr", "Dis à tous, hormis Rosa, que la porte est fermée.")
    assert '"La porte est fermée."' in written
    assert 'not in ["rosa"]' in written


@pytest.mark.parametrize(
    ("words", "things"),
    [
        ("Apporte l'agrafeuse verte et la rouge à Paul.", ("green stapler", "red stapler")),
        ("Donne la tasse bleue à Paul et la verte à Rosa.", ("blue cup", "green cup")),
        ("Cherche la tasse blanche, puis apporte-moi la rouge.", ("white cup", "red cup")),
    ],
)
def test_a_second_thing_may_be_named_by_its_colour(words: str, things: tuple[str, ...]) -> None:
    written = program("fr", words)
    assert all(f'"{each}"' in written for each in things), written


@pytest.mark.parametrize(
    ("language", "words", "spoken"),
    [
        ("fr", "Rappelle-moi d'arroser mes plantes.", "Veuillez arroser vos plantes."),
        ("fr", "Rappelle-moi dans une heure de me coiffer.", "Veuillez vous coiffer."),
        ("en", "Remind me to water my plants.", "Please water your plants."),
        ("de", "Erinnere mich daran, meine Pflanzen zu gießen.", "Bitte gießen Sie Ihre Pflanzen."),
    ],
)
def test_a_reminder_speaks_to_whoever_is_reminded(language: str, words: str, spoken: str) -> None:
    assert f'"{spoken}"' in program(language, words)


@pytest.mark.parametrize(
    ("language", "words", "spoken"),
    [
        ("fr", "Dis à Rosa que nous partons quand Paul arrive.", "Nous partons quand Paul arrive."),
        ("en", "Tell Rosa that we leave when Paul arrives.", "We leave when Paul arrives."),
    ],
)
def test_when_something_is_so_is_told(language: str, words: str, spoken: str) -> None:
    assert f'"{spoken}"' in program(language, words)


@pytest.mark.parametrize(
    ("words", "spoken"),
    [
        ("Dis à Rosa qu'ils ont perdu.", "Ils ont perdu."),
        ("Dis à Tom que tu ne sais pas chanter.", "Je ne sais pas chanter."),
        ("Dis à Grace qu'elle doit se reposer.", "Vous devez vous reposer."),
        ("Dis à Henry que je n'ai pas pu le prévenir.", "Je n'ai pas pu vous prévenir."),
        ("Dis à Paul que Rosa veut le dossier.", "Rosa veut le dossier."),
        ("Dis à Rosa que je mange chez elle ce midi.", "Je mange chez vous ce midi."),
        ("Dis à Bob qu'il faut qu'il prenne un taxi.", "Il faut que vous preniez un taxi."),
        ("Demande à Rosa pourquoi elle n'a pas mangé.", "Pourquoi n'avez-vous pas mangé ?"),
        ("Demande à Tom s'il ne veut plus attendre.", "Ne voulez-vous plus attendre ?"),
        ("Demande à Rosa où on se gare.", "Où est-ce qu'on se gare ?"),
    ],
)
def test_who_is_meant_in_what_is_passed_on(words: str, spoken: str) -> None:
    assert f'"{spoken}"' in program("fr", words)
