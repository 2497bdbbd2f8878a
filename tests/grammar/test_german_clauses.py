"""Clauses of German that say something else when one word of them is lost: what need not be, what
is not to be said, whom it is said to, where and when it is so, and whose verb is moved; and what
French and English have of these."""

from __future__ import annotations

import pytest

from tests.grammar.test_kinds import program, said


def refused(language: str, words: str) -> bool:
    return said(language, words).program is None


@pytest.mark.parametrize(
    ("words", "heard"),
    [
        ("Sag Bob, er muss nicht warten", "Sie müssen nicht warten."),
        ("Sag Clara, dass sie heute nicht kommen muss", "Sie müssen heute nicht kommen."),
        ("Sag Bob, dass er jetzt gehen kann", "Sie können jetzt gehen."),
        ("Sag Clara, sie kann nicht parken", "Sie können nicht parken."),
        ("Sag Bob, er darf sich setzen", "Sie dürfen sich setzen."),
        ("Sag Bob, dass er nicht rauchen darf", "Bitte rauchen Sie nicht."),
        ("Sag Clara, sie muss sich setzen", "Bitte setzen Sie sich."),
        ("Sag Bob, er möge warten", "Bitte warten Sie."),
    ],
)
def test_who_may_or_need_not_is_told_so_and_not_asked_to(words: str, heard: str) -> None:
    assert f'robot.say("{heard}")' in program("de", words)


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("de", "Geh weder in die Apotheke noch in die Bibliothek"),
        ("de", "Bring Alice weder Stuhl noch Kissen"),
        ("de", "Dreh dich weder links noch rechts herum"),
        ("de", "Sag lieber nichts zu Bob"),
        ("de", "Sag ja nicht, wo Clara ist"),
        ("de", "Sag nie mehr guten Tag"),
        ("de", "Sag nicht danke, sondern bitte"),
        ("de", "Sag guten Abend statt guten Morgen"),
        ("en", "Say neither thanks nor sorry"),
        ("en", "Say not goodbye but good night"),
        ("fr", "Dis plutôt rien"),
        ("fr", "Dis merci plutôt que pardon"),
        ("fr", "Dis pas bonsoir"),
    ],
)
def test_what_is_not_to_be_done_or_said_is_not(language: str, words: str) -> None:
    assert refused(language, words)


@pytest.mark.parametrize(
    ("language", "words", "heard"),
    [
        ("de", "sonst sag nichts gefunden", "Nichts gefunden."),
        ("en", "say not yet", "Not yet."),
        ("fr", "dis pas de tasse", "Pas de tasse."),
    ],
)
def test_a_negation_that_is_a_message_is_said(language: str, words: str, heard: str) -> None:
    assert refused(language, words) or f'robot.say("{heard}")' in program(language, words)


@pytest.mark.parametrize(
    ("language", "words"),
    [
        ("de", "Sag Rosa: Komme sofort, muss noch parken"),
        ("de", "Sag Bob sie soll kommen"),
        ("de", "Sag Clara danke für die Blumen"),
        ("de", "Sag Bob gute Fahrt von uns allen"),
        ("de", "Sag Bob, was du gern isst"),
        ("de", "Sag Verzeihung zu Clara"),
        ("de", "Clara sagt, Bob soll trinken"),
        ("en", "say Bob we are waiting"),
        ("en", "say Clara good evening"),
        ("fr", "dis Clara bonsoir"),
    ],
)
def test_the_name_of_whom_it_is_told_to_is_no_part_of_it(language: str, words: str) -> None:
    assert refused(language, words)


@pytest.mark.parametrize(
    ("language", "words", "heard"),
    [
        ("de", 'Sag Bob "Gute Fahrt"', "Gute Fahrt"),
        ("de", 'Sag Clara "Bin gleich da"', "Bin gleich da"),
        ("en", 'Tell Bob "safe travels"', "safe travels"),
        ("fr", 'Dis à Bob "bonne route"', "bonne route"),
    ],
)
def test_a_quotation_behind_a_name_is_told_to_them(language: str, words: str, heard: str) -> None:
    found = program(language, words)
    assert 'robot.find("' in found
    assert f'robot.say("{heard}")' in found


@pytest.mark.parametrize(
    ("language", "words", "heard"),
    [
        ("de", "Sag Clara ist da", "Clara ist da."),
        ("en", "say Bob is waiting", "Bob is waiting."),
        ("en", "say Bob, lunch is ready", "Bob, lunch is ready."),
        ("fr", "dis Clara est là", "Clara est là."),
    ],
)
def test_who_is_spoken_of_is_spoken_of(language: str, words: str, heard: str) -> None:
    assert f'robot.say("{heard}")' in program(language, words)


@pytest.mark.parametrize(
    ("words", "heard"),
    [
        ("Sag Bob, um neun ist Besprechung", "Um neun ist Besprechung."),
        ("Sag Clara, in fünf Minuten gibt es Kuchen", "In fünf Minuten gibt es Kuchen."),
        ("Sag Bob, auf Station A fehlt ein Stuhl", "Auf Station A fehlt ein Stuhl."),
    ],
)
def test_when_and_where_something_is_so_belongs_to_what_is_told(words: str, heard: str) -> None:
    found = program("de", words)
    assert f'robot.say("{heard}")' in found
    assert "robot.wait" not in found
    assert "robot.grab" not in found


@pytest.mark.parametrize(
    "words", ["Sag Bob, in der Apotheke ist noch Tee", "Sag Clara, am Empfang liegt ein Brief"]
)
def test_where_something_is_is_no_question_about_it(words: str) -> None:
    assert "sees(" not in (said("de", words).program or "")


@pytest.mark.parametrize(
    ("language", "words", "heard"),
    [
        ("de", "Sag höflich hallo", "Hallo."),
        ("de", "Sag laut und deutlich: Bitte Platz machen", "Bitte Platz machen."),
        ("de", "Sag dreimal laut Vorsicht", "Vorsicht."),
        ("de", "Sag noch einmal guten Abend", "Guten Abend."),
        ("en", "say once more hello", "Hello!"),
        ("fr", "dis gentiment bonsoir", "Bonsoir."),
        ("fr", "dis encore une fois bonsoir", "Bonsoir."),
    ],
)
def test_how_it_is_said_is_not_said(language: str, words: str, heard: str) -> None:
    assert refused(language, words) or f'robot.say("{heard}")' in program(language, words)


@pytest.mark.parametrize("words", ["Clara, komm mal in die Bibliothek!", "Such nach müde, Bob"])
def test_what_is_written_small_is_no_thing(words: str) -> None:
    found = said("de", words).program or ""
    assert 'robot.find("komm"' not in found
    assert '"müde"' not in found


@pytest.mark.parametrize(
    ("words", "asked"),
    [
        ("Frag Bob, ob er glaubt, dass Clara kommt", "Glauben Sie, dass Clara kommt?"),
        ("Frag Clara, ob sie weiß, wo Bob ist", "Wissen Sie, wo Bob ist?"),
        ("Frag Bob, ob er den Film mag, den Clara sah", "Mögen Sie den Film, den Clara sah?"),
        ("Frag Bob, ob er es schafft, alles zu lesen", "Schaffen Sie es, alles zu lesen?"),
        ("Frag Bob, warum er den Kopf schüttelt", "Warum schütteln Sie den Kopf?"),
        ("Frag Clara, wie viele Stühle frei sind", "Wie viele Stühle sind frei?"),
        ("Frag Clara, wie viele Kissen sie braucht", "Wie viele Kissen brauchen Sie?"),
        ("Frag Bob, welche Räume heute offen sind", "Welche Räume sind heute offen?"),
        ("Frag Bob, was er gekocht hat und ob es ihm geschmeckt hat", "Hat es Ihnen geschmeckt?"),
    ],
)
def test_only_the_verb_of_the_question_itself_is_moved(words: str, asked: str) -> None:
    assert f'robot.ask("{asked}"' in program("de", words).replace("ask(\n    ", "ask(")


@pytest.mark.parametrize(
    "words",
    [
        "Frag Bob, ob er, wenn Clara geht, bleiben will",
        "Frag Bob, ob er Fragen hat, bevor er anfängt",
        "Frag Bob, ob er weiß, wann seine Tochter kommt",
        "Frag Clara, ob sie ruhig schläft oder ob sie Schmerzen hat",
        "Frag Bob, was er braucht und wann",
        "Sag Bob, dass er, sobald er kann, zu Clara gehen soll",
        "Sag Clara, dass sie das Buch, das sie liest, behalten darf",
    ],
)
def test_where_it_is_not_known_whose_verb_it_is_nothing_is_said(words: str) -> None:
    assert refused("de", words)


@pytest.mark.parametrize(
    ("words", "heard"),
    [
        (
            "Sag Bob, dass er nichts trinken darf, bevor er untersucht wird",
            "Sie dürfen nichts trinken, bevor Sie untersucht werden.",
        ),
        (
            "Sag Bob, dass er müde ist und heute nicht kommt",
            "Sie sind müde und kommen heute nicht.",
        ),
        ("Sag Bob, dass ich warte und er kommen soll", "Ich warte und Sie sollen kommen."),
        ("Sag Clara, dass ich sie vermisse und bald komme", "Ich vermisse Sie und komme bald."),
        (
            "Sag Clara, dass Bob sie sucht und sie ihn anrufen soll",
            "Bob sucht Sie und Sie sollen ihn anrufen.",
        ),
        (
            "Sag Bob, er muss warten, weil er untersucht wird",
            "Sie müssen warten, weil Sie untersucht werden.",
        ),
        (
            "Sag Clara, dass die Visite ausfällt, weil sie zu lange dauert",
            "Die Visite fällt aus, weil sie zu lange dauert.",
        ),
    ],
)
def test_later_clauses_speak_to_whom_they_are_told(words: str, heard: str) -> None:
    assert f'robot.say("{heard}")' in program("de", words)


@pytest.mark.parametrize(
    "words",
    [
        "Sag Clara, dass sie die Suppe essen soll, bevor sie kalt wird",
        "Sag Bob, ich brauche meinen Mantel, den er gestern geholt hat",
    ],
)
def test_who_is_meant_in_a_later_clause_is_not_guessed(words: str) -> None:
    assert refused("de", words)


@pytest.mark.parametrize(
    "words",
    [
        "Fahr an der Apotheke vorbei",
        "Geh vor der Bibliothek noch in die Apotheke",
        "Warst du in der Bibliothek?",
        "Darfst du in die Apotheke?",
        "Du darfst in die Bibliothek",
    ],
)
def test_nobody_goes_where_they_are_not_sent(words: str) -> None:
    assert refused("de", words)


@pytest.mark.parametrize("much", ["ein bisschen", "ein wenig", "etwas", "leicht"])
def test_a_little_is_how_far_and_not_how_long(much: str) -> None:
    assert program("de", f"Dreh dich {much} nach links") == "robot.turn(20)\n"
