"""The hospital of the language tests as French speakers call it: the same names, other aliases."""

from __future__ import annotations

from dataclasses import replace

from grammar.lexicon import Lexicon, Name, Question
from tests.grammar.ward import WARD

_ALIASES = {
    "lobby": ("hall", "hall d'entrée"),
    "reception": ("accueil", "réception"),
    "entrance": ("entrée", "entrée principale"),
    "pharmacy": ("pharmacie",),
    "radiology": ("radiologie", "radio"),
    "intensive care": ("soins intensifs", "réanimation"),
    "children's ward": ("pédiatrie",),
    "surgical ward": ("chirurgie",),
    "ward 3": ("service 3",),
    "Alice's office": ("bureau d'Alice",),
    "Bob's office": ("bureau de Bob",),
    "supply room": ("réserve",),
    "kitchen": ("cuisine",),
    "cafeteria": ("cafétéria", "cantine"),
    "waiting room": ("salle d'attente",),
    "lift": ("ascenseur",),
    "laundry": ("buanderie",),
    "room 12": ("chambre 12",),
    "chemistry lab": ("laboratoire de chimie", "labo de chimie"),
    "robotics lab": ("laboratoire de robotique", "labo de robotique"),
    "charger": ("station de charge", "borne de recharge"),
    "Mrs Miller": ("Madame Miller",),
    "stapler": ("agrafeuse",),
    "red cup": ("tasse rouge",),
    "cup": ("tasse",),
    "water bottle": ("bouteille d'eau",),
    "bottle": ("bouteille",),
    "wheelchair": ("fauteuil roulant",),
    "blanket": ("couverture",),
    "blood pressure monitor": ("tensiomètre",),
    "medicine box": ("boîte de médicaments",),
    "table": ("table",),
    "shelf": ("étagère",),
    "bed": ("lit",),
    "desk": ("pupitre",),
}


def _french(names: tuple[Name, ...]) -> tuple[Name, ...]:
    return tuple(replace(name, aliases=_ALIASES.get(name.name, ())) for name in names)


HOPITAL: Lexicon = replace(
    WARD,
    places=_french(WARD.places),
    people=_french(WARD.people),
    objects=_french(WARD.objects),
    furniture=_french(WARD.furniture),
    contacts=("Dr Weber", "poste infirmier", "fille"),
    questions=(
        Question("Quelles sont les heures de visite ?", "De quatorze à vingt heures."),
        Question("Où puis-je fumer ?", "Seulement dehors, devant l'entrée."),
    ),
)
