"""Face: `emotion`. A robot without one shows it on its screen (`ScreenFace`)."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from robot_api.capabilities.base import Capability, Hub
from robot_api.capabilities.emulation import InEmulation
from robot_api.capabilities.names import listed, one_of
from robot_api.capabilities.simulation import InSimulation
from robot_api.driver import StopFlag
from robot_api.errors import NotSupported
from robot_api.methods import SUGGESTED_EMOTIONS

if TYPE_CHECKING:
    from robot_api.capabilities.screen import Screen


class Face(Capability):
    """Something that shows emotions."""

    name = "face"
    lacking = "has no face and no screen to show one on"
    emotions: tuple[str, ...] = SUGGESTED_EMOTIONS

    @abstractmethod
    def express(self, stop: StopFlag, emotion: str) -> None:
        """Show it, one of `emotions`, and tell it to those who subscribed."""

    def emotion(self, stop: StopFlag, name: str) -> None:
        known = one_of(name, self.emotions)
        if known is None:
            raise NotSupported(f"I cannot look '{name}'. I can look {listed(self.emotions)}.")
        self.express(stop, known)

    def declares(self) -> dict[str, Any]:
        return {"emotions": self.emotions}


class EmulatedFace(InEmulation, Face):
    def express(self, stop: StopFlag, emotion: str) -> None:
        self.emulation.emotion = emotion
        self.emulation.publish("emotion", name=emotion)


class SimulatedFace(InSimulation, Face):
    def express(self, stop: StopFlag, emotion: str) -> None:
        self.simulation.set_emotion(emotion)


class ScreenFace(Face):
    """A face drawn on the screen."""

    stand_in = "a face on the screen"

    def __init__(self, screen: Screen, hub: Hub) -> None:
        self._screen = screen
        self._hub = hub

    def express(self, stop: StopFlag, emotion: str) -> None:
        self._screen.show(stop, None, face_page(emotion), None)
        self._hub.publish("emotion", name=emotion)


@dataclass(frozen=True)
class _Features:
    """How a face looks, in a drawing 200 wide and 200 high."""

    mouth: str
    """Path of the mouth."""
    brow: tuple[float, float] = (62, 62)
    """Height of the left brow's outer and inner end; the right one mirrors it."""
    eye: float = 11
    """Half the height of an eye."""
    lift: float = 0
    """How much higher the right brow is than the left."""


_FACES: Mapping[str, _Features] = {
    "neutral": _Features("M68 142 H132"),
    "happy": _Features("M60 132 Q100 176 140 132", brow=(60, 56)),
    "sad": _Features("M64 154 Q100 122 136 154", brow=(68, 56)),
    "confused": _Features("M64 146 Q82 132 100 146 T136 142", brow=(64, 60), lift=12),
    "angry": _Features("M66 150 Q100 134 134 150", brow=(54, 70), eye=9),
    "surprised": _Features("M86 146 a14 17 0 1 0 28 0 a14 17 0 1 0 -28 0", brow=(48, 46), eye=15),
}


def face_page(emotion: str) -> str:
    """A page of HTML with the face of that emotion, one of `SUGGESTED_EMOTIONS`."""
    look = _FACES[emotion]
    outer, inner = look.brow
    strokes = (
        f'<path class="mouth" d="{look.mouth}"/>'
        f'<path class="brow" d="M46 {outer} L80 {inner}"/>'
        f'<path class="brow" d="M154 {outer - look.lift} L120 {inner - look.lift}"/>'
    )
    eyes = "".join(
        f'<ellipse class="eye" cx="{x}" cy="90" rx="10" ry="{look.eye}"/>' for x in (64, 136)
    )
    return (
        f"<!doctype html><html><head><title>{emotion}</title><style>"
        "body{margin:0;background:#10222e;display:grid;place-items:center;height:100vh}"
        "svg{height:96vh;max-width:96vw}"
        "path{fill:none;stroke:#8fe3ff;stroke-width:8;stroke-linecap:round}"
        "ellipse{fill:#8fe3ff;animation:blink 5s infinite;transform-origin:50% 45%}"
        "@keyframes blink{0%,96%,100%{transform:scaleY(1)}98%{transform:scaleY(.1)}}"
        f'</style></head><body><svg viewBox="0 0 200 200" role="img" aria-label="{emotion}">'
        f"{eyes}{strokes}</svg></body></html>"
    )
