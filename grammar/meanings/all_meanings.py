"""Enters all meanings, for whoever reads sentences: imported for nothing else.

Only the meaning of a routine's name is a sentence in itself, and so it is entered where sentences
are understood (`grammar.understand`).
"""

from __future__ import annotations

import grammar.meanings.agreement
import grammar.meanings.amounts
import grammar.meanings.answered
import grammar.meanings.answered_numbers
import grammar.meanings.answering
import grammar.meanings.answers
import grammar.meanings.asked_to_do
import grammar.meanings.asking_until
import grammar.meanings.best_places
import grammar.meanings.body
import grammar.meanings.branches
import grammar.meanings.carrying
import grammar.meanings.checked
import grammar.meanings.chosen
import grammar.meanings.conditions
import grammar.meanings.control
import grammar.meanings.conversation
import grammar.meanings.counts
import grammar.meanings.descriptions
import grammar.meanings.driving
import grammar.meanings.exceptions
import grammar.meanings.exchanges
import grammar.meanings.extra_answers
import grammar.meanings.facts
import grammar.meanings.findings
import grammar.meanings.found_places
import grammar.meanings.further
import grammar.meanings.gaps
import grammar.meanings.holders
import grammar.meanings.hosting
import grammar.meanings.inquiries
import grammar.meanings.lookouts
import grammar.meanings.loops
import grammar.meanings.messages
import grammar.meanings.news
import grammar.meanings.nouns
import grammar.meanings.offers
import grammar.meanings.orders_to_tell
import grammar.meanings.people
import grammar.meanings.persons
import grammar.meanings.place_conditions
import grammar.meanings.place_sets
import grammar.meanings.places
import grammar.meanings.places_meant
import grammar.meanings.polls
import grammar.meanings.presence
import grammar.meanings.quantifiers
import grammar.meanings.questions
import grammar.meanings.references
import grammar.meanings.remarks
import grammar.meanings.repeating
import grammar.meanings.requests
import grammar.meanings.rounds
import grammar.meanings.sharing
import grammar.meanings.sights
import grammar.meanings.signatures
import grammar.meanings.some_places
import grammar.meanings.sources
import grammar.meanings.speaking
import grammar.meanings.stops
import grammar.meanings.strangers
import grammar.meanings.telling_if
import grammar.meanings.there
import grammar.meanings.thing_lists
import grammar.meanings.things
import grammar.meanings.topics
import grammar.meanings.traits
import grammar.meanings.visiting
import grammar.meanings.volunteers
import grammar.meanings.waiting
import grammar.meanings.when_found
import grammar.meanings.whereabouts
import grammar.reminders.reminding
import grammar.standing_orders.meanings  # noqa: F401 (each enters its meanings)
