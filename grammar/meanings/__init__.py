"""The meanings that the rules of the languages name: a small function each.

A meaning takes the discourse and the node of the parse and gives what the rule stands for: steps
for a command, a `Condition`, a `Thing`, a `Value`. A rule that is named after a robot method needs
none: its slots are the parameters. `registry` holds them by name, `all_meanings` imports them all.
"""
