"""Of an input that does harm, the smallest that can be got at in the time there is."""

from __future__ import annotations

import dataclasses
import time
from collections.abc import Callable

from tests.attacks.inputs import Case


def smaller(case: Case, harms: Callable[[Case], bool], seconds: float) -> Case:
    """What is left of it when all is cut out that it does as much harm without."""
    ends = time.monotonic() + seconds
    piece = max(1, len(case.data) // 2)
    while True:
        at, cut = 0, False
        while at < len(case.data):
            left = dataclasses.replace(case, data=case.data[:at] + case.data[at + piece :])
            if time.monotonic() > ends:
                return case
            if harms(left):
                case, cut = left, True
            else:
                at += piece
        if piece == 1 and not cut:
            return case
        piece = max(1, piece // 2)
