"""Links as QR codes: for a page, and for a terminal."""

from __future__ import annotations

from typing import Any, Final

HALVES: Final = {(0, 0): " ", (1, 0): "▀", (0, 1): "▄", (1, 1): "█"}
"""Two rows of a code in one of a terminal, by whether each is light: codes are dark on light, and
most terminals are dark."""


def as_svg(text: str) -> str:
    """The code as a picture of its own, which a page may scale."""
    svg = str(_made(text).to_svg(add_quiet_zones=True))
    return svg[svg.index("<svg") :]


def in_terminal(text: str) -> str:
    """The code in block elements, some 35 columns wide."""
    rows: list[list[int]] = memoryview(_made(text).to_image(scale=1)).tolist()  # type: ignore[assignment]
    modules = [[int(light > 127) for light in row] for row in rows]
    if len(modules) % 2:
        modules.append([1] * len(modules[0]))
    pairs = zip(modules[::2], modules[1::2], strict=True)
    return "\n".join(
        "".join(HALVES[above, below] for above, below in zip(*pair, strict=True)) for pair in pairs
    )


def _made(text: str) -> Any:
    import zxingcpp

    return zxingcpp.create_barcode(text, zxingcpp.BarcodeFormat.QRCode, ec_level="M")
