"""What is worked out, kept and compared, in the words of every language."""

from __future__ import annotations

import pytest
from hypothesis import HealthCheck, given, settings

from grammar import plan as p
from grammar.explain import explain, explain_program, explain_steps
from grammar.language import languages
from grammar.program import write_program
from tests.grammar import random_plans, sensible_plans

VOTES, NAMES, ANSWER = p.Recall("votes"), p.Recall("names"), p.Recall("answer")
COUNTS, BEGIN, HERE = p.Recall("counts"), p.Recall("begin"), p.Recall("here")
SEES = p.Holds(p.Ask("sees", {"thing": p.Text("cup")}))
KNOWN: tuple[p.Step, ...] = (
    p.Remember("begin", p.Ask("clock", field="time")),
    p.Remember("votes", p.Record(((p.Text("tea"), p.Number(0)),))),
    p.Remember("names", p.Items((p.Text("Alice"),))),
    p.Remember("counts", p.Items((p.Number(1), p.Number(2)))),
    p.Call("ask", {"question": p.Text("?")}, "answer"),
    p.Call("location", {}, "here"),
)


def told(step: p.Step, language: str) -> str:
    """The line of one step, or of its clause."""
    lines = explain_steps(p.Plan((*KNOWN, step)), language)
    before = explain_steps(p.Plan(KNOWN), language)
    assert lines[: len(before)] == before
    return lines[len(before)][1]


REMEMBERED = {
    "en": "remember {} as “r”",
    "de": "mir {} als „r“ merken",
    "fr": "retenir {} comme « r »",
}

VALUES: list[tuple[p.Value, str, str, str]] = [
    (
        p.Record(((p.Text("a"), p.Number(1)), (p.Text("b"), p.Number(2)))),
        "a table (“a”: 1, “b”: 2)",
        "eine Tabelle („a“: 1, „b“: 2)",
        "un tableau (« a » : 1, « b » : 2)",
    ),
    (
        p.Range(p.Number(4), p.Number(1)),
        "the numbers from 1 to 3",
        "die Zahlen von 1 bis 3",
        "les nombres de 1 à 3",
    ),
    (
        p.Range(p.Length(NAMES)),
        "the numbers from 0 to the number of entries in “names” minus 1",
        "die Zahlen von 0 bis zur Zahl der Einträge in „names“ minus 1",
        "les nombres de 0 au nombre d'entrées dans « names » moins 1",
    ),
    (
        p.Item(NAMES, p.Number(0)),
        "the first of “names”",
        "den ersten Eintrag in „names“",
        "le premier élément de « names »",
    ),
    (
        p.Item(NAMES, p.Number(-1)),
        "the last of “names”",
        "den letzten Eintrag in „names“",
        "le dernier élément de « names »",
    ),
    (
        p.Item(NAMES, p.Number(2)),
        "number 3 of “names”",
        "Eintrag Nummer 3 in „names“",
        "l'élément numéro 3 de « names »",
    ),
    (
        p.Item(VOTES, ANSWER),
        "the entry for the answer in the tally of votes",
        "den Eintrag für die Antwort in der Strichliste",
        "l'entrée pour la réponse dans le décompte des votes",
    ),
    (
        p.Item(VOTES, ANSWER, p.Number(5)),
        "the entry for the answer in the tally of votes (5 if there is none)",
        "den Eintrag für die Antwort in der Strichliste (sonst 5)",
        "l'entrée pour la réponse dans le décompte des votes (à défaut, 5)",
    ),
    (
        p.ListOf(VOTES),
        "the entries of the tally of votes",
        "die Einträge in der Strichliste",
        "les entrées du décompte des votes",
    ),
    (
        p.Values(VOTES),
        "the values in the tally of votes",
        "die Werte in der Strichliste",
        "les valeurs dans le décompte des votes",
    ),
    (
        p.KeyOf("max", VOTES),
        "the one with the highest value in the tally of votes",
        "den Namen mit dem höchsten Wert in der Strichliste",
        "le nom qui a la plus grande valeur dans le décompte des votes",
    ),
    (
        p.KeyOf("min", VOTES),
        "the one with the lowest value in the tally of votes",
        "den Namen mit dem kleinsten Wert in der Strichliste",
        "le nom qui a la plus petite valeur dans le décompte des votes",
    ),
    (
        p.Occurrences(NAMES, p.Text("yes")),
        "the number of times “yes” is in “names”",
        "die Häufigkeit von „yes“ in „names“",
        "le nombre de fois que « yes » est dans « names »",
    ),
    (p.Sorted(NAMES), "“names” (sorted)", "„names“ (sortiert)", "« names » (dans l'ordre)"),
    (
        p.Sorted(NAMES, descending=True),
        "“names” (sorted, the largest first)",
        "„names“ (sortiert, das Größte zuerst)",
        "« names » (du plus grand au plus petit)",
    ),
    (
        p.Distinct(NAMES),
        "“names” (each only once)",
        "„names“ (jedes nur einmal)",
        "« names » (sans doublons)",
    ),
    (
        p.Join(NAMES, p.Text("; ")),
        "“names” (with “; ” in between)",
        "„names“ (mit „; “ dazwischen)",
        "« names » (avec « ;  » entre deux)",
    ),
    (
        p.Field(HERE, "x"),
        "my x position (where I was then)",
        "meine x-Position (der gemerkte Ort)",
        "ma position x (l'endroit où j'étais alors)",
    ),
    (
        p.Arithmetic(p.Arithmetic(p.Number(5), "-", ANSWER), "*", p.Number(2)),
        "(5 minus the answer) times 2",
        "(5 minus die Antwort) mal 2",
        "(5 moins la réponse) fois 2",
    ),
    (
        p.Arithmetic(ANSWER, "+", p.Number(1)),
        "the answer plus 1",
        "die Antwort plus 1",
        "la réponse plus 1",
    ),
    (
        p.Arithmetic(ANSWER, "/", p.Number(2)),
        "the answer divided by 2",
        "die Antwort geteilt durch 2",
        "la réponse sur 2",
    ),
    (
        p.Arithmetic(ANSWER, "//", p.Number(2)),
        "the answer divided by 2 (without the remainder)",
        "die Antwort geteilt durch 2 (ohne Rest)",
        "la réponse sur 2 (sans le reste)",
    ),
    (
        p.Arithmetic(ANSWER, "%", p.Number(2)),
        "the remainder of the answer divided by 2",
        "den Rest von der Antwort geteilt durch 2",
        "le reste de la division de la réponse par 2",
    ),
    (
        p.Arithmetic(p.Number(0), "-", ANSWER),
        "minus the answer",
        "minus die Antwort",
        "moins la réponse",
    ),
    (
        p.Arithmetic(NAMES, "+", p.Ask("objects")),
        "“names” together with the objects I see",
        "„names“ zusammen mit den Dingen, die ich sehe",
        "« names » avec les objets que je vois",
    ),
    (
        p.Aggregate("max", p.Items((p.Length(NAMES), p.Number(3)))),
        "the largest of the number of entries in “names” and 3",
        "den größten Wert (die Zahl der Einträge in „names“ und 3)",
        "la plus grande valeur (le nombre d'entrées dans « names » et 3)",
    ),
    (
        p.Aggregate("min", COUNTS),
        "the lowest of the numbers in “counts”",
        "die kleinste der Zahlen in „counts“",
        "le plus petit des nombres dans « counts »",
    ),
    (
        p.Aggregate("sum", p.Values(VOTES)),
        "the sum of the values in the tally of votes",
        "die Summe (die Werte in der Strichliste)",
        "la somme (les valeurs dans le décompte des votes)",
    ),
    (
        p.Round(p.Ask("battery")),
        "the charge of my battery in percent (rounded)",
        "den Ladestand meines Akkus in Prozent (gerundet)",
        "la charge de ma batterie (en pour cent) (avec arrondi)",
    ),
    (
        p.Round(p.Field(HERE, "y"), p.Number(1)),
        "my y position (where I was then) (rounded to 1 digit after the point)",
        "meine y-Position (der gemerkte Ort) (gerundet auf 1 Stelle nach dem Komma)",
        "ma position y (l'endroit où j'étais alors) (avec arrondi à 1 chiffre après la virgule)",
    ),
    (
        p.Absolute(p.NumberIn(ANSWER)),
        "the number in the answer (without its sign)",
        "die Zahl in der Antwort (ohne Vorzeichen)",
        "le nombre dans la réponse (sans son signe)",
    ),
    (
        p.Choice(p.Range(p.Number(7), p.Number(1))),
        "one of the numbers from 1 to 6 (picked at random)",
        "zufällig eines von den Zahlen von 1 bis 6",
        "un choix au hasard parmi les nombres de 1 à 6",
    ),
    (
        p.Figure("highest", NAMES),
        "the highest of the numbers in “names”",
        "die größte der Zahlen in „names“",
        "le plus grand des nombres dans « names »",
    ),
]


@pytest.mark.parametrize(("value", "en", "de", "fr"), VALUES)
def test_values(value: p.Value, en: str, de: str, fr: str) -> None:
    for language, words in (("en", en), ("de", de), ("fr", fr)):
        assert told(p.Remember("r", value), language) == REMEMBERED[language].format(words)


CONDITIONS: list[tuple[p.Condition, str, str, str]] = [
    (p.Holds(NAMES), "“names” is not empty", "„names“ nicht leer ist", "« names » n'est pas vide"),
    (
        p.Not(p.Holds(VOTES)),
        "the tally of votes is empty",
        "die Strichliste leer ist",
        "le décompte des votes est vide",
    ),
    (p.Holds(ANSWER), "the answer is known", "die Antwort feststeht", "on connaît la réponse"),
    (
        p.Holds(p.Length(NAMES)),
        "“names” is not empty",
        "„names“ nicht leer ist",
        "« names » n'est pas vide",
    ),
    (
        p.Compare(p.Text("tea"), "in", VOTES),
        "there is an entry for “tea” in the tally of votes",
        "es in der Strichliste einen Eintrag für „tea“ gibt",
        "il y a une entrée pour « tea » dans le décompte des votes",
    ),
    (
        p.Not(p.Compare(ANSWER, "in", VOTES)),
        "there is no entry for the answer in the tally of votes",
        "es in der Strichliste keinen Eintrag für die Antwort gibt",
        "il n'y a pas d'entrée pour la réponse dans le décompte des votes",
    ),
    (
        p.Compare(p.Elapsed(BEGIN), "<", p.Number(10)),
        "it is less than 10 minutes since the time at the beginning",
        "die Zeit seit der Uhrzeit am Anfang kürzer als 10 Minuten ist",
        "le temps écoulé depuis l'heure du début est inférieur à 10 minutes",
    ),
    (
        p.Compare(p.Elapsed(BEGIN), ">", p.Recall("n")),
        "it is more than [“n”] minutes since the time at the beginning",
        "die Zeit seit der Uhrzeit am Anfang länger als [„n“] Minuten ist",
        "le temps écoulé depuis l'heure du début dépasse [« n »] minutes",
    ),
    (
        p.Not(p.Both((SEES, p.Compare(p.Length(NAMES), "<", p.Number(3))))),
        "I do not see a cup or the number of entries in “names” is at least 3",
        "ich „cup“ nicht sehe oder die Zahl der Einträge in „names“ mindestens 3 ist",
        "je ne vois pas de cup ou le nombre d'entrées dans « names » est au moins 3",
    ),
]
IF = {"en": "if {}:", "de": "wenn {}:", "fr": "si {}:"}


@pytest.mark.parametrize(("condition", "en", "de", "fr"), CONDITIONS)
def test_conditions(condition: p.Condition, en: str, de: str, fr: str) -> None:
    for language, words in (("en", en), ("de", de), ("fr", fr)):
        said = told(p.If(condition, (p.Call("dock"),)), language)
        assert said == IF[language].format(words).replace("si il", "s'il")


BOTH = p.Both((SEES, p.Compare(p.Length(NAMES), "==", p.Number(0))))
SAID = (p.Call("say", {"text": p.Text("!")}),)

STEPS: list[tuple[p.Step, str, str, str]] = [
    (
        p.Remember("r", p.Record()),
        "start an empty table: “r”",
        "eine leere Tabelle beginnen: „r“",
        "commencer un tableau vide : « r »",
    ),
    (
        p.SetItem("votes", ANSWER, p.Number(0)),
        "write down 0 for the answer in the tally of votes",
        "0 für die Antwort in der Strichliste eintragen",
        "noter 0 pour la réponse dans le décompte des votes",
    ),
    (
        p.Increase("votes", None, ANSWER),
        "add one to the entry for the answer in the tally of votes",
        "den Eintrag für die Antwort in der Strichliste um eins erhöhen",
        "ajouter un à l'entrée pour la réponse dans le décompte des votes",
    ),
    (
        p.Increase("votes", p.Number(2), ANSWER),
        "add 2 to the entry for the answer in the tally of votes",
        "2 zum Eintrag für die Antwort in der Strichliste hinzufügen",
        "ajouter 2 à l'entrée pour la réponse dans le décompte des votes",
    ),
    (p.Increase("n", p.Number(-2)), "take 2 off “n”", "2 von „n“ abziehen", "enlever 2 à « n »"),
    (
        p.Increase("n", p.Arithmetic(p.Number(0), "-", ANSWER)),
        "take the answer off “n”",
        "die Antwort von „n“ abziehen",
        "enlever la réponse à « n »",
    ),
    (
        p.Increase("names", p.Ask("people")),
        "add everything in the people I see to “names”",
        "alles aus den Leuten, die ich sehe zu „names“ hinzufügen",
        "ajouter à « names » tout ce qui est dans les personnes que je vois",
    ),
    (
        p.Remember("r", BOTH),
        "remember as “r” whether I see a cup and “names” is empty",
        "mir als „r“ merken, ob ich „cup“ sehe und „names“ leer ist",
        "retenir comme « r » si je vois un cup et « names » est vide",
    ),
    (
        p.ForEach("drink", VOTES, SAID, "number"),
        "for each entry in the tally of votes:",
        "nacheinander für jeden Eintrag in der Strichliste:",
        "tour à tour pour chaque entrée dans le décompte des votes:",
    ),
    (p.ForEach("i", p.Range(p.Number(3)), SAID), "three times:", "dreimal:", "trois fois:"),
    (
        p.Repeat(p.NumberIn(ANSWER), SAID),
        "as many times as the answer says:",
        "so oft, wie die Antwort angibt:",
        "autant de fois que le dit la réponse:",
    ),
]


@pytest.mark.parametrize(("step", "en", "de", "fr"), STEPS)
def test_steps(step: p.Step, en: str, de: str, fr: str) -> None:
    assert [told(step, language) for language in ("en", "de", "fr")] == [en, de, fr]


def test_what_goes_by_a_name_in_a_loop_or_when_something_fails() -> None:
    def said(name: str) -> p.Call:
        return p.Call("say", {"text": p.Sentence((p.Text("so: "), p.Recall(name)))})

    plan = p.Plan(
        (
            p.Remember("votes", p.Record()),
            p.ForEach(
                "name", p.Recall("votes"), (said("name"), said("count"), p.Continue()), "count"
            ),
            p.ForEach("i", p.Range(p.Number(4), p.Number(1)), (said("i"),)),
            p.Try((p.Call("dock"),), (said("why"),), "why"),
        )
    )
    assert [text for _, text in explain_steps(plan, "en")][2:] == [
        "say “so: [this name]”",
        "say “so: [its value]”",
        "go on with the next round",
        "for each of the numbers from 1 to 3:",
        "say “so: [this number]”",
        "as far as it works:",
        "go back to the charging station",
        "if that does not work:",
        "say “so: [what went wrong]”",
    ]
    german = [text for _, text in explain_steps(plan, "de")]
    assert german[3:5] == [
        "„so: [der Wert dazu]“ sagen",
        "gleich mit der nächsten Runde weitermachen",
    ]
    assert "„so: [die jeweilige Zahl]“ sagen" in german
    assert german[-1] == "„so: [der Grund dafür]“ sagen"
    french = [text for _, text in explain_steps(plan, "fr")]
    assert french[3:5] == ["dire « so: [sa valeur] »", "passer au tour suivant"]
    assert french[-1] == "dire « so: [la raison] »"


@settings(max_examples=60, deadline=None, suppress_health_check=list(HealthCheck))
@given(random_plans.plans)
def test_nothing_is_left_without_words(plan: p.Plan) -> None:
    """No gap of a phrase and no mark of a case is left over, whatever a plan says."""
    for language in languages():
        for said in (explain(plan, language), *dict(explain_steps(plan, language)).values()):
            assert "{" not in said or "{" in write_program(plan)
            assert "⟨" not in said or "⟨" in write_program(plan)


@settings(max_examples=30, deadline=None, suppress_health_check=list(HealthCheck))
@given(sensible_plans.plans)
def test_a_written_program_is_told_without_any_code(plan: p.Plan) -> None:
    program = write_program(plan)
    for language in languages():
        told_lines = [each.text for each in explain_program(program, language)]
        assert not any("`" in text for text in told_lines), program
