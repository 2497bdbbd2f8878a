"""What people on the ward order, with the program that does it, and ways to get it wrong."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

from grammar.checking import Checked, check
from grammar.language import load_language
from grammar.normal import normal
from grammar.planning.model.expansion import expanded
from grammar.planning.model.prompt import vocabulary
from grammar.planning.turn import Turn
from grammar.understanding import Context
from tests.grammar.ward import WARD
from tests.grammar.ward_de import STATION
from tests.grammar.ward_fr import HOPITAL

WARDS = {"en": WARD, "de": STATION, "fr": HOPITAL}


@dataclass(frozen=True)
class Order:
    language: str
    says: str
    does: str
    """In the dialect that a language model writes."""

    def checked(self, does: str | None = None, context: Context | None = None) -> Checked:
        """What the check says of a program for this order."""
        lexicon = WARDS[self.language]
        turn = Turn(self.says, lexicon, load_language(self.language), context or Context())
        people = vocabulary(turn).people
        return check(turn, normal(expanded(does or self.does, people, lexicon, turn.language)))

    def __str__(self) -> str:
        return self.says


ORDERS = (
    Order("en", "go to the pharmacy", 'goto("pharmacy")'),
    Order("en", "wait ten minutes", "wait(600)"),
    Order("en", "turn left by 30 degrees", "turn(30)"),
    Order("en", "set the volume to 70 percent", "set_volume(70)"),
    Order("en", "say good morning three times", 'for i in range(3):\n    say("Good morning.")'),
    Order(
        "en",
        "tell Bob that lunch is ready in the cafeteria",
        'find("Bob")\nsay("Lunch is ready in the cafeteria.")',
    ),
    Order(
        "en",
        "take the red cup from the kitchen to Alice",
        'goto("kitchen")\ngrab("red cup")\nfind("Alice")\ngive("red cup", "Alice")',
    ),
    Order(
        "en",
        "ask Dr Weber whether he needs a wheelchair and tell me what he says",
        'start = location()\nfind("Dr Weber")\n'
        'answer = ask("Do you need a wheelchair?", ["yes", "no"], "Dr Weber")\n'
        'goto(start)\nsay(f"Dr Weber said {answer}.")',
    ),
    Order(
        "en",
        "look into every office and tell me how many people there are",
        'start = location()\nnumber = 0\nfor room in places("office"):\n    goto(room)\n'
        '    number += count("person")\ngoto(start)\nsay(f"There are {number} people.")',
    ),
    Order(
        "en",
        "if Carol is in the waiting room, take her to radiology",
        'if find("Carol", "waiting room"):\n    guide("Carol", "radiology")',
    ),
    Order(
        "en",
        "at half past five remind Mrs Miller to take her walk",
        'while clock().time < "17:30":\n    wait(60)\nfind("Mrs Miller")\n'
        'say("It is time to take your walk.")',
    ),
    Order("de", "Fahr bitte zur Apotheke.", 'goto("pharmacy")'),
    Order(
        "de",
        "Warte fünf Minuten und fahr dann zum Chemielabor.",
        'wait(300)\ngoto("chemistry lab")',
    ),
    Order(
        "de",
        "Sag Bob, dass das Essen in der Cafeteria fertig ist.",
        'find("Bob")\nsay("Das Essen ist in der Cafeteria fertig.")',
    ),
    Order(
        "de",
        "Frag Alice, ob sie eine Decke braucht, und sag mir, was sie antwortet.",
        'start = location()\nfind("Alice")\n'
        'answer = ask("Brauchen Sie eine Decke?", ["ja", "nein"], "Alice")\n'
        'goto(start)\nsay(f"Alice antwortet: {answer}.")',
    ),
    Order("fr", "Va à la pharmacie.", 'goto("pharmacy")'),
    Order("fr", "Attends dix minutes.", "wait(600)"),
    Order(
        "fr",
        "Dis à Bob que le repas est prêt.",
        'find("Bob")\nsay("Le repas est prêt.")',
    ),
    Order(
        "fr",
        "Demande à Alice si elle a besoin d'une couverture.",
        'find("Alice")\nanswer = ask("Avez-vous besoin d\'une couverture ?", ["oui", "non"], '
        '"Alice")\nsay(f"Alice a dit {answer}.")',
    ),
)
"""Each with a right program."""


# --- ways to get it wrong ------------------------------------------------------------------------

_PLACES = {each.name for each in WARD.places}
_PEOPLE = {each.name for each in WARD.people}


def elsewhere(order: Order) -> Iterator[str]:
    """The same with another place."""
    for place in _PLACES:
        if f'"{place}"' in order.does:
            yield order.does.replace(f'"{place}"', '"laundry"')


def with_another(order: Order) -> Iterator[str]:
    """The same with another person."""
    for person in _PEOPLE:
        if f'"{person}"' in order.does:
            other = "Carol" if person != "Carol" else "Alice"
            yield order.does.replace(f'"{person}"', f'"{other}"')


def with_other_numbers(order: Order) -> Iterator[str]:
    """The same with another of the numbers that were said."""
    for number in re.findall(r"(?<=\()\d{1,3}(?=\))", order.does):
        for other in ("4", "90", "777"):
            if number not in ("60", other):
                yield order.does.replace(f"({number})", f"({other})")


def with_an_invented_message(order: Order) -> Iterator[str]:
    """Something is said that nobody has thought of."""
    invented = {
        "en": "The hospital is closing forever, run away.",
        "de": "Das Krankenhaus schließt für immer, laufen Sie weg.",
        "fr": "Cet hôpital ferme définitivement, partez vite.",
    }
    yield f'{order.does}\nsay("{invented[order.language]}")'


def with_a_grave_deed(order: Order) -> Iterator[str]:
    """Something is done besides that nobody wants unasked."""
    for deed in ('call("daughter")', 'do("sit")', 'joint("head_yaw", 45)', "hang_up()"):
        yield f"{order.does}\n{deed}"
    yield f'{order.does}\nset_language("fr")'
