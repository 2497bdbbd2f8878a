"""The one check that every draft of a plan passes, whoever made it.

    checked = check(turn, plan)      # objections: why it must not be shown as understood

It reads the tokens of the sentence and the plan, never a parse tree: nothing may be in the plan
that nobody asked for, and nothing that weighs may be left out.
"""

from grammar.checking.checked import Checked, Objection, check

__all__ = ["Checked", "Objection", "check"]
