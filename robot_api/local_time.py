"""The date and time of this machine, with the zone that its owner has set: the system's own, or
what the environment variable TZ says."""

from __future__ import annotations

from datetime import datetime
from typing import Final
from zoneinfo import ZoneInfoNotFoundError

import tzlocal

NO_NAME: Final = "UTC"


def local_now() -> datetime:
    """Now, here. Where the zone has no name that is known, as of a TZ like "CET-1CEST", it is told
    by what it is ahead of UTC now."""
    try:
        return datetime.now(tzlocal.get_localzone())
    except ZoneInfoNotFoundError:
        return datetime.now().astimezone()


def local_zone() -> str:
    """What the zone is called, "Europe/Zurich"; UTC where it has no name that is known."""
    try:
        return tzlocal.get_localzone_name() or NO_NAME
    except ZoneInfoNotFoundError:
        return NO_NAME
