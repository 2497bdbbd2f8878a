"""What is said besides an order, and changes what is to be done, whoever has understood it."""

from __future__ import annotations

from grammar.plan import Plan
from grammar.planning.asides import with_reasons
from grammar.planning.turn import Turn
from grammar.planning.whereabouts import brought_to_speaker, brought_where_it_happened


def heeded(turn: Turn, plan: Plan) -> Plan:
    """A plan that heeds it."""
    plan = brought_to_speaker(turn, plan)
    plan = brought_where_it_happened(turn, plan)
    return with_reasons(turn, plan)
