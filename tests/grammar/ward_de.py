"""The hospital of the language tests as German speakers call it: the same names, other aliases."""

from __future__ import annotations

from dataclasses import replace

from grammar.lexicon import Lexicon, Name, Question
from tests.grammar.ward import WARD

_ALIASES = {
    "lobby": ("Eingangshalle", "Foyer"),
    "reception": ("Empfang", "Rezeption"),
    "entrance": ("Eingang", "Haupteingang"),
    "pharmacy": ("Apotheke",),
    "radiology": ("Radiologie", "Röntgen"),
    "intensive care": ("Intensivstation", "IPS"),
    "children's ward": ("Kinderstation",),
    "surgical ward": ("chirurgische Station", "Chirurgie"),
    "ward 3": ("Station 3",),
    "Alice's office": ("Büro von Alice",),
    "Bob's office": ("Büro von Bob",),
    "supply room": ("Materialraum", "Lager"),
    "kitchen": ("Küche",),
    "cafeteria": ("Cafeteria", "Kantine"),
    "waiting room": ("Wartezimmer",),
    "lift": ("Aufzug", "Lift"),
    "laundry": ("Wäscherei",),
    "room 12": ("Zimmer 12",),
    "chemistry lab": ("Chemielabor",),
    "robotics lab": ("Robotiklabor",),
    "charger": ("Ladestation",),
    "Dr Weber": ("Dr. Weber", "Doktor Weber", "Frau Doktor Weber"),
    "Mrs Miller": ("Frau Müller",),
    "stapler": ("Tacker", "Hefter"),
    "red cup": ("rote Tasse",),
    "cup": ("Tasse", "Becher"),
    "water bottle": ("Wasserflasche",),
    "bottle": ("Flasche",),
    "wheelchair": ("Rollstuhl",),
    "blanket": ("Decke", "Wolldecke"),
    "blood pressure monitor": ("Blutdruckmessgerät",),
    "medicine box": ("Medikamentenbox",),
    "table": ("Tisch",),
    "shelf": ("Regal",),
    "bed": ("Bett",),
    "desk": ("Schreibtisch",),
}


def _german(names: tuple[Name, ...]) -> tuple[Name, ...]:
    return tuple(replace(name, aliases=_ALIASES.get(name.name, ())) for name in names)


STATION: Lexicon = replace(
    WARD,
    places=_german(WARD.places),
    people=_german(WARD.people),
    objects=_german(WARD.objects),
    furniture=_german(WARD.furniture),
    contacts=("Dr. Weber", "Stationszimmer", "Tochter"),
    questions=(
        Question("Wann ist Besuchszeit?", "Von zwei bis acht Uhr nachmittags."),
        Question("Wo darf ich rauchen?", "Nur draussen, vor dem Eingang."),
    ),
)
