"""Bar codes and QR codes in pictures that a browser sends: `POST /codes`, the picture as its body.

The answer is JSON: `codes`, each with its `text` and its `format` ("QR Code", "EAN-13"). Without
any it is an empty list. What is no picture is answered by a `trouble` with its name: "too large",
"no picture".
"""

from __future__ import annotations

import io
from typing import Any, Final

import msgspec
from PIL import Image
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import JSONResponse, Response
from starlette.routing import Route

from nl2robot.station.part import Backstage, Part
from robot_api.errors import cause

LARGEST_FILE: Final = 12_000_000
"""Bytes."""
MOST_PIXELS: Final = 40_000_000
"""A picture that unpacks to more than a good camera's is not opened."""
FORMATS: Final = ("PNG", "JPEG", "WEBP", "GIF", "BMP")


class NoPicture(Exception):
    """These bytes are no picture of a kind that is read here, or a larger one than is read."""


class Code(msgspec.Struct, frozen=True):
    """A code that was found."""

    text: str
    format: str
    """As people call it: "QR Code", "EAN-13"."""


def read_codes(picture: bytes) -> list[Code]:
    """The codes in a picture file, each once, in no particular order. Raises `NoPicture`."""
    import zxingcpp

    found = zxingcpp.read_barcodes(_opened(picture), text_mode=zxingcpp.TextMode.Plain)
    return list(dict.fromkeys(Code(code.text, str(code.format)) for code in found if code.text))


def _opened(picture: bytes) -> Image.Image:
    try:
        # The size stands at a picture's beginning: it is known before the rest is unpacked.
        image = Image.open(io.BytesIO(picture), formats=FORMATS)
        if image.width * image.height > MOST_PIXELS:
            raise NoPicture("too many pixels")
        return image.convert("L")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:
        raise NoPicture(cause(error)) from error


async def _answer(request: Request) -> Response:
    picture = bytearray()
    async for block in request.stream():
        picture += block
        if len(picture) > LARGEST_FILE:
            return _told(413, trouble="too large")
    try:
        codes = await run_in_threadpool(read_codes, bytes(picture))
    except NoPicture:
        return _told(415, trouble="no picture")
    return _told(200, codes=msgspec.to_builtins(codes))


def _told(status: int, **data: Any) -> Response:
    return JSONResponse(data, status, {"Cache-Control": "no-store"})


def part(backstage: Backstage) -> Part:
    return Part(routes=[Route("/codes", _answer, methods=["POST"])])
