"""The date and time of this machine, with the zone that its owner has set: the system's own, or
what the environment variable TZ says."""

from __future__ import annotations

from datetime import datetime
from zoneinfo import ZoneInfoNotFoundError

import tzlocal


def local_now() -> datetime:
    """Now, here. Where the zone has no name that is known, as of a TZ like "CET-1CEST", it is told
    by what it is ahead of UTC now."""
    try:
        return datetime.now(tzlocal.get_localzone())
    except ZoneInfoNotFoundError:
        return datetime.now().astimezone()
