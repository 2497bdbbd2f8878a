"""Whom, of what, at what times: reminders as a ward says them, with the times wherever they may
stand."""

from __future__ import annotations

import re
from dataclasses import replace

import pytest

from grammar.program import write_program
from grammar.requests import When
from grammar.summary import summary
from grammar.understand import understand
from tests.grammar.hospitals import hospital

TWICE = When(times=("10:00", "16:00"))
DAILY = When(times=("10:00", "16:00"), repeats=True)
WEEKLY = When(times=("09:30",), weekdays=(0, 3), repeats=True)
TIMES = {
    "en": {
        "at ten and at four": TWICE,
        "every day at ten and at four": DAILY,
        "on mondays and thursdays at 9:30": WEEKLY,
    },
    "de": {
        "um zehn und um vier": TWICE,
        "jeden Tag um zehn und um vier": DAILY,
        "montags und donnerstags um halb zehn": WEEKLY,
    },
    "fr": {
        "à dix heures et à seize heures": TWICE,
        "tous les jours à dix heures et à seize heures": DAILY,
        "le lundi et le jeudi à neuf heures et demie": WEEKLY,
    },
}
SENTENCES = {
    "en": (
        "remind Alice to drink {}",
        "remind Alice {} to drink",
        "{} remind Alice to take her pills",
        "could you please remind Alice to take her pills {}?",
        "remind Alice of her pills {}",
        "remind Alice {} that she has to drink",
        "Alice should be reminded to drink {}",
        "give Alice a reminder to drink {}",
        "remind everybody in ward 3 to drink {}",
        "remind Alice and Bob to drink {}",
    ),
    "de": (
        "erinnere Alice {} daran zu trinken",
        "erinnere Alice {} daran, ihre Tabletten zu nehmen",
        "erinnere Alice daran, {} zu trinken",
        "erinnere Alice daran, {} die Tabletten zu nehmen",
        "{} erinnere Alice daran zu trinken",
        "erinnern Sie Alice {} an die Tabletten",
        "erinnere Alice daran, dass sie {} trinken soll",
        "kannst du Alice bitte {} daran erinnern, zu trinken?",
        "Alice soll {} daran erinnert werden zu trinken",
    ),
    "fr": (
        "rappelle à Alice de boire {}",
        "rappelle à Alice {} de boire",
        "{}, rappelle à Alice de prendre ses médicaments",
        "rappelez à Alice qu'elle doit boire {}",
        "peux-tu rappeler à Alice de boire {} ?",
        "rappelle à Alice ses médicaments {}",
    ),
}
ALL = [
    (language, sentence, time)
    for language, sentences in SENTENCES.items()
    for sentence in sentences
    for time in TIMES[language]
]


def program(sentence: str, language: str = "en") -> str:
    understood = understand(sentence, hospital(language), language)
    assert understood.plan is not None, (sentence, understood.message)
    return write_program(understood.plan)


@pytest.mark.parametrize(("language", "sentence", "time"), ALL)
def test_the_times_are_when_and_no_part_of_what_is_said(
    language: str, sentence: str, time: str
) -> None:
    said = sentence.format(time)
    asked = understand(said[:1].upper() + said[1:], hospital(language), language).request
    assert asked is not None and asked.kind == "schedule", said
    assert asked.when is not None and replace(asked.when, bare=()) == TIMES[language][time], said
    done = program(asked.sentence, language)
    assert "reminder_done = robot.ask(" in done
    words = re.findall(r'say\("(.*?)"\)', done)
    assert not any(re.search(r"\b(zehn|halb|dix|neuf|ten|9:30)\b", each) for each in words), words


@pytest.mark.parametrize(
    ("language", "sentence", "says", "asks"),
    [
        ("en", "remind Alice to drink", "Please drink.", "Have you done it?"),
        ("en", "remind Alice of her pills", "This is a reminder: your pills.", "thought of it?"),
        ("en", "remind Alice that lunch is ready", "Lunch is ready.", "Have you understood me?"),
        ("en", "remind Alice not to smoke", "Please do not smoke.", "Have you understood me?"),
        (
            *("en", "remind Alice that the physio comes at four"),
            *("The physio comes at four.", "Have you understood me?"),
        ),
        ("de", "erinnere Alice daran zu trinken", "Bitte trinken Sie.", "Haben Sie das gemacht?"),
        (
            *("de", "erinnere Bob daran, seine Tasche mitzunehmen"),
            *("Bitte nehmen Sie Ihre Tasche mit.", "Haben Sie das gemacht?"),
        ),
        (
            *("de", "erinnere Alice daran, dass die Physiotherapie um vier kommt"),
            *("Die Physiotherapie kommt um vier.", "Haben Sie mich verstanden?"),
        ),
        ("fr", "rappelle à Alice de boire", "Veuillez boire.", "Est-ce que c'est fait ?"),
        (
            *("fr", "rappelle à Alice que le médecin vient à seize heures"),
            *("Le médecin vient à seize heures.", "M'avez-vous compris ?"),
        ),
    ],
)
def test_what_is_said_and_what_is_asked(language: str, sentence: str, says: str, asks: str) -> None:
    done = program(sentence, language)
    assert f'robot.say("{says}")' in done and asks in done
    assert "wait_until" not in done


def test_it_is_asked_in_the_words_of_the_language() -> None:
    assert '["ja", "nein"], person="Alice")' in program("erinnere Alice daran zu trinken", "de")
    assert '["oui", "non"], person="Alice")' in program("rappelle à Alice de boire", "fr")


@pytest.mark.parametrize("time", ["at four", "in ten minutes", "tomorrow at four"])
def test_one_moment_is_waited_for(time: str) -> None:
    for sentence in (f"remind Alice to drink {time}", f"remind Alice {time} to drink"):
        done = program(sentence)
        assert done.startswith("robot.wait") and 'robot.say("Please drink.")' in done
        assert "reminder_done" in done


@pytest.mark.parametrize(
    "sentence",
    [
        "remind me to call Bob",
        "remind me in ten minutes to call Bob",
        "tell Bob that lunch is ready and remind Alice to drink",
        "tell Alice to remind Bob of the meeting",
        "ask Alice whether she has drunk. If not, remind her to drink.",
        "tell Alice to drink",
    ],
)
def test_what_is_no_reminder_of_the_ward_is_only_said(sentence: str) -> None:
    assert "reminder_done" not in program(sentence)


@pytest.mark.parametrize(
    ("language", "sentence", "told"),
    [
        (
            *("en", "remind Alice to drink"),
            "I will look for Alice. Twice I will say “Please drink”, ask Alice “Have you done it?”"
            " and, if somebody answers, go no further. If the answer to the reminder is “yes”, I"
            " will say “Thank you”. Otherwise, if the answer to the reminder is “no”, I will say"
            " “All right. Thank you for telling me”. If I do not find Alice, I will say so.",
        ),
        (
            *("de", "erinnere Alice daran zu trinken"),
            "Ich werde Alice suchen. Zweimal werde ich „Bitte trinken Sie“ sagen, Alice „Haben Sie"
            " das gemacht?“ fragen und, wenn jemand antwortet, damit aufhören. Wenn die Antwort auf"
            " die Erinnerung „ja“ ist, werde ich „Vielen Dank“ sagen. Sonst, wenn die Antwort auf"
            " die Erinnerung „nein“ ist, werde ich „In Ordnung. Danke, dass Sie es mir sagen“"
            " sagen. Wenn ich Alice nicht finde, werde ich das melden.",
        ),
    ],
)
def test_what_it_does_is_told_in_plain_words(language: str, sentence: str, told: str) -> None:
    understood = understand(sentence, hospital(language), language)
    assert understood.plan is not None and summary(understood.plan, language) == told
