"""The time zone that this machine's clocks are set to."""

from __future__ import annotations

from typing import Final
from zoneinfo import ZoneInfoNotFoundError

import tzlocal

NO_NAME: Final = "UTC"


def local_zone() -> str:
    """ "Europe/Zurich"; UTC where the zone has no name that is known."""
    try:
        return tzlocal.get_localzone_name() or NO_NAME
    except ZoneInfoNotFoundError:
        return NO_NAME
