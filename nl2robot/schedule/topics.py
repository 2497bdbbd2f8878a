"""Topics of MQTT, by which messages of a house are told apart (MQTT 3.1.1, section 4.7)."""

from __future__ import annotations

import re
from typing import Final

LONGEST_TOPIC: Final = 200
"""Characters."""


def is_topic(text: str, wildcards: bool = False) -> bool:
    """Whether one can publish there or, with `wildcards`, listen: `+` is any one level, `#` at the
    end all that is below."""
    if not 0 < len(text) <= LONGEST_TOPIC or "\0" in text or text.startswith("$"):
        return False
    levels = text.split("/")
    special = [level for level in levels if re.search(r"[+#]", level)]
    if not wildcards:
        return not special
    return all(level in ("+", "#") for level in special) and "#" not in levels[:-1]


def matches(topic: str, said_at: str) -> bool:
    """Whether a topic of MQTT with wildcards means this one (MQTT 3.1.1, section 4.7)."""
    wanted, levels = topic.split("/"), said_at.split("/")
    if said_at.startswith("$") and wanted[0] in ("+", "#"):
        return False
    for index, level in enumerate(wanted):
        if level == "#":
            return True
        if index >= len(levels) or level not in ("+", levels[index]):
            return False
    return len(wanted) == len(levels)


def is_below(topic: str, prefix: str) -> bool:
    """Whether it is this prefix or begins with it."""
    return topic == prefix or topic.startswith(f"{prefix}/")
