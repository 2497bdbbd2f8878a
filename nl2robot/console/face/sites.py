"""Whether the web page that the robot shows lets itself be shown in a frame of ours.

The server asks for it in the place of the face, so it asks only where anybody could: an address
within the hospital's network is never called from here, not by a detour either. There the face just
tries.
"""

from __future__ import annotations

import ipaddress
import socket
from typing import Final, Literal
from urllib.parse import urljoin, urlsplit

import requests

ANSWERS_WITHIN: Final = 4.0
MOST_DETOURS: Final = 4

Answer = Literal["yes", "refuses", "away"]


def lets_itself_be_framed(url: str) -> Answer:
    """`away`: nobody answers there."""
    try:
        for _ in range(1 + MOST_DETOURS):
            if not _is_public(url):
                return "yes"
            with requests.get(
                url, timeout=ANSWERS_WITHIN, stream=True, allow_redirects=False
            ) as answer:
                if not answer.is_redirect:
                    policy = answer.headers.get("Content-Security-Policy", "").lower()
                    refuses = "X-Frame-Options" in answer.headers or "frame-ancestors" in policy
                    return "refuses" if refuses else "yes"
                url = urljoin(url, answer.headers["Location"])
    except (requests.RequestException, OSError, ValueError):
        pass
    return "away"


def _is_public(url: str) -> bool:
    """Whether all that its name stands for is in the open internet. Raises `OSError` if it stands
    for nothing, `ValueError` if it is no address of a web page."""
    parts = urlsplit(url)
    if parts.scheme not in ("http", "https") or not parts.hostname:
        raise ValueError(url)
    found = socket.getaddrinfo(parts.hostname, parts.port or parts.scheme, type=socket.SOCK_STREAM)
    return all(ipaddress.ip_address(str(each[4][0]).partition("%")[0]).is_global for each in found)
