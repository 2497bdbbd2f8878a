"""Bar codes and QR codes in pictures, and in what is none."""

import http.client
import io
import json
from typing import Any

import numpy
import pytest
import zxingcpp
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image
from starlette.applications import Starlette

from nl2robot.console.face import codes
from nl2robot.console.face.codes import Code, NoPicture, part, read_codes
from robot_api import Server
from robot_api.drivers import emulated

QR = zxingcpp.BarcodeFormat.QRCode
EAN = zxingcpp.BarcodeFormat.EAN13


def drawn(text: str, kind: Any = QR, scale: int = 4) -> Image.Image:
    return Image.fromarray(numpy.array(zxingcpp.create_barcode(text, kind).to_image(scale=scale)))


def as_file(image: Image.Image, form: str = "PNG") -> bytes:
    file = io.BytesIO()
    image.save(file, form)
    return file.getvalue()


@pytest.mark.parametrize("form", ["PNG", "JPEG", "WEBP", "GIF", "BMP"])
def test_a_code_is_read_from_every_kind_of_picture(form: str) -> None:
    assert read_codes(as_file(drawn("Bett 12, Größe M"), form)) == [
        Code("Bett 12, Größe M", "QR Code")
    ]


def test_bar_codes_and_several_codes_are_read() -> None:
    sheet = Image.new("L", (900, 500), 255)
    sheet.paste(drawn("4006381333931", EAN), (20, 20))
    sheet.paste(drawn("ward 7"), (600, 250))
    found = {code.format: code.text for code in read_codes(as_file(sheet))}
    assert found == {"EAN-13": "4006381333931", "QR Code": "ward 7"}


def test_a_turned_code_in_colour_is_read() -> None:
    turned = drawn("stapler", scale=6).convert("RGB").rotate(30, expand=True, fillcolor="white")
    assert read_codes(as_file(turned, "JPEG"))[0].text == "stapler"


def test_no_code_is_an_empty_list() -> None:
    assert read_codes(as_file(Image.new("RGB", (320, 240), "white"))) == []


@given(st.binary(max_size=300))
def test_what_is_no_picture_is_told(junk: bytes) -> None:
    for beginning in (b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0", b"GIF89a", b"BM"):
        with pytest.raises(NoPicture):
            read_codes(beginning + junk)


def test_a_picture_that_unpacks_to_too_much_is_not_opened() -> None:
    with pytest.raises(NoPicture, match="pixels"):
        read_codes(as_file(Image.new("1", (10_000, 5_000))))


def test_over_the_wire(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(codes, "LARGEST_FILE", 20_000)
    pages = Starlette(routes=list(part(None).routes))  # type: ignore[arg-type]
    with Server(emulated(), port=0, pages=pages) as server:

        def sent(body: bytes) -> tuple[int, Any]:
            connection = http.client.HTTPConnection(server.address, timeout=20)
            connection.request("POST", "/codes", body)
            answer = connection.getresponse()
            return answer.status, json.loads(answer.read())

        found = {"text": "ward 7", "format": "QR Code"}
        assert sent(as_file(drawn("ward 7"))) == (200, {"codes": [found]})
        assert sent(b"no picture at all") == (415, {"trouble": "no picture"})
        assert sent(bytes(30_000)) == (413, {"trouble": "too large"})
