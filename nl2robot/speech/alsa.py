"""ALSA, the sound system of Linux, kept quiet."""

from __future__ import annotations

import contextlib
import ctypes
from functools import cache
from typing import Any


@cache
def quieten() -> Any:
    """Without this, ALSA writes dozens of lines to standard error of what it looked for and did
    not find. Returns the function that it calls instead, which must live on."""
    handler = ctypes.CFUNCTYPE(None)(lambda: None)  # C lets it ignore the arguments it is given
    with contextlib.suppress(OSError, AttributeError):  # a system without ALSA
        ctypes.CDLL("libasound.so.2").snd_lib_error_set_handler(handler)
    return handler
