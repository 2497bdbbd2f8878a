"""The floor of a world: rooms tinted by their kind, walls, doors, furniture, people, things."""

from __future__ import annotations

import colorsys
import itertools
import math
import zlib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from sim.hospital import chart_of
from sim.physics.placing import people_at_start, things_at_start
from sim.pictures.labels import Board, label_area, label_spot
from sim.pictures.scene import (
    Area,
    Box,
    Disc,
    Frame,
    Line,
    Scene,
    Shape,
    Spot,
    Text,
    arc,
    box_about,
    box_at,
    dashes,
    hatching,
    mixed,
)
from sim.world.geometry import Pose, polygon_area, rectangle
from sim.world.maps import painted
from sim.world.model import Door, Furniture, Place, Thing, World, name_in

LARGEST = (1480.0, 1080.0)
"""Pixels that the floor's width and height may have."""
MOST_SCALE = 90.0
"""Pixels a metre, for the smallest worlds."""
MARGIN = 26.0

BACKGROUND = "#fbfbfa"
INK = "#27313d"
WALL = "#3d4855"
ROOM_NAME = "#54606d"
FLOOR = "#f1f1ee"
_ON_A_MAP = {"free": FLOOR, "occupied": "#8e98a3", "unknown": "#d9dde2"}
NO_ENTRY = "#d9b3b0"

_ROOMS = {
    "ward": "#d9e8f5",
    "office": "#fbf0cf",
    "lab": "#d8eee5",
    "lobby": "#f7ebdf",
    "reception": "#f3dfcc",
    "pharmacy": "#d6efd9",
    "corridor": "#f3f3f0",
    "cafeteria": "#fde4d3",
    "kitchen": "#fad9c6",
    "lift": "#dfe1e8",
    "restroom": "#e2e8f2",
    "charger": "#dcf3c6",
    "department": "#e6dff2",
    "room": "#e9ecef",
}
_PEOPLE = {
    "nurse": "#2b7bbd",
    "doctor": "#148a7d",
    "patient": "#d27a1c",
    "visitor": "#8257c2",
    "receptionist": "#bd4179",
    "pharmacist": "#35934a",
    "technician": "#57708a",
    "porter": "#9a6b32",
}
_WOOD, _WOOD_RIM = "#efe6d6", "#c9baa0"
_STEEL, _STEEL_RIM = "#e3e7eb", "#b4bec8"
_LINEN, _LINEN_RIM = "#ffffff", "#aab8c6"
_CLOTH, _CLOTH_RIM = "#dfe3ee", "#b3bacd"
_FURNITURE = {
    "bed": (_LINEN, _LINEN_RIM),
    "chair": (_CLOTH, _CLOTH_RIM),
    "sofa": (_CLOTH, _CLOTH_RIM),
    "plant": ("#bfdcae", "#8fb878"),
    **dict.fromkeys(("fridge", "machine", "scanner", "monitor"), (_STEEL, _STEEL_RIM)),
    **dict.fromkeys(("incubator", "washbasin", "trolley"), (_STEEL, _STEEL_RIM)),
}
_COLOURS = {
    "red": "#d64541",
    "blue": "#3f78c9",
    "green": "#4a9d55",
    "yellow": "#ecc32f",
    "white": "#ffffff",
    "black": "#33383d",
    "brown": "#8d6540",
    "orange": "#e8862e",
    "pink": "#e58bb1",
    "purple": "#8a5fc0",
    "grey": "#9aa3ab",
    "gray": "#9aa3ab",
}


Inhabitant = tuple[float, float, str, str]
"""Somebody's x, y, name and kind."""


@dataclass(frozen=True)
class Floor:
    """A drawn floor, and what is taken on it, for those who draw on top."""

    scene: Scene
    frame: Frame
    board: Board


def draw_floor(
    world: World,
    people: Sequence[Inhabitant] | None = None,
    ways: Iterable[Sequence[tuple[float, float]]] = (),
    *,
    symbols: bool = True,
    top: float = 0.0,
    largest: tuple[float, float] = LARGEST,
    language: str = "en",
) -> Floor:
    """The floor with these people, or with everybody where the simulation begins. Labels
    keep off the `ways` (in metres) that will be drawn on it, as far as they can. Without `symbols`
    the people are not drawn, only kept clear of. `top` pixels are left free for a title. What is
    on the floor goes by its name in the `language`.

    Raises `sim.world.map_image.ImageError` if the image of the world's map can be read no more.
    """
    x1, y1, x2, y2 = _extent(world)
    scale = min(MOST_SCALE, largest[0] / (x2 - x1), largest[1] / (y2 - y1))
    width, height = (x2 - x1) * scale + 2 * MARGIN, (y2 - y1) * scale + 2 * MARGIN
    frame = Frame(scale, MARGIN - x1 * scale, top + MARGIN + y2 * scale)
    scene = Scene(width, height + top, BACKGROUND)
    board = Board(Box(4, top + 4, width - 4, height + top - 4))

    _draw_rooms(world, frame, scene, language)
    _draw_furniture(world, frame, scene, board, language)
    _draw_doors(world, frame, scene, board)
    _draw_walls(world, frame, scene, board)
    _draw_charger(world, frame, scene, board)
    inhabitants = _inhabitants(world) if people is None else people
    things = _things(world, language)
    for x, y, *_ in inhabitants:
        board.labels.append(box_at(*frame.spot(x, y), 2 * _head(frame), 2 * _head(frame)))
    for x, y, *_ in things:
        board.draw(box_at(*frame.spot(x, y), 9, 9), 3.0)
    for way in ways:
        for one, two in itertools.pairwise(_even(frame.spots(way), 12)):
            board.draw(box_about((one, two)).grown(3), 4.0)
    _draw_place_names(world, frame, scene, board, language)
    _draw_things(things, frame, scene)
    for x, y, name, kind in inhabitants if symbols else ():
        scene.layer("people").extend(person_shapes(frame, x, y, name, kind))
        label = label_spot(board, name, frame.spot(x, y), _head(frame), 10.5, INK)
        scene.layer("names").extend(label or [])
    return Floor(scene, frame, board)


def person_shapes(frame: Frame, x: float, y: float, name: str, kind: str) -> list[Shape]:
    """A head with the person's initial in it, in the colour of their kind."""
    u, v = frame.spot(x, y)
    radius = _head(frame)
    colour = _PEOPLE.get(kind) or tint(kind, 0.55, 0.42)
    note = f"{name}, {kind}" if name != kind else name
    initial = Text(u, v + radius * 0.44, name[:1].upper(), radius * 1.25, "#ffffff", "middle", True)
    return [Disc(u, v, radius, colour, "#ffffff", 1.5, note), initial]


def robot_shapes(frame: Frame, x: float, y: float, theta: float, radius: float) -> list[Shape]:
    """The robot: a disc with a nose that shows which way it faces."""
    u, v = frame.spot(x, y)
    size = max(radius * frame.scale, 7.0)
    angle = math.radians(theta)
    ahead, aside = (math.cos(angle), -math.sin(angle)), (math.sin(angle), math.cos(angle))
    nose = tuple(
        (u + size * (a * ahead[0] + b * aside[0]), v + size * (a * ahead[1] + b * aside[1]))
        for a, b in ((0.78, 0.0), (-0.3, 0.52), (-0.3, -0.52))
    )
    return [Disc(u, v, size, "#1f2a36", "#ffffff", 2.0, "the robot"), Area(nose, "#7fe0c3")]


def tint(kind: str, saturation: float, lightness: float) -> str:
    """A colour of its own for any kind, always the same."""
    hue = zlib.crc32(kind.encode()) % 360 / 360
    red, green, blue = colorsys.hls_to_rgb(hue, lightness, saturation)
    return f"#{round(red * 255):02x}{round(green * 255):02x}{round(blue * 255):02x}"


def _even(way: Sequence[Spot], step: float) -> list[Spot]:
    """Points of a way that are at most about a step apart, and not many more than needed."""
    even: list[Spot] = []
    for x, y in way:
        if even and (far := math.dist(even[-1], (x, y))) < step:
            continue
        if even and far > 2 * step:
            (u, v), pieces = even[-1], math.ceil(far / step)
            even += [(u + (x - u) * i / pieces, v + (y - v) * i / pieces) for i in range(1, pieces)]
        even.append((x, y))
    return even


def _head(frame: Frame) -> float:
    return min(max(0.22 * frame.scale, 6.5), 11.0)


def _extent(world: World) -> tuple[float, float, float, float]:
    """What is drawn, at least four metres each way."""
    x1, y1, x2, y2 = world.bounds
    around = 0.2 if world.drawn_walls or world.map else 1.5
    wide, high = max(around, 2 - (x2 - x1) / 2), max(around, 2 - (y2 - y1) / 2)
    return (x1 - wide, y1 - high, x2 + wide, y2 + high)


# --- the building --------------------------------------------------------------------------------


def _draw_rooms(world: World, frame: Frame, scene: Scene, language: str) -> None:
    rooms = scene.layer("rooms")
    if world.map is not None:
        for what, outline in painted(world.map):
            rooms.append(Area(frame.spots(outline), _ON_A_MAP[what], note=what))
    places = sorted(
        (place for place in world.places if place.area), key=lambda p: -polygon_area(p.area)
    )
    for place in places:
        fill = _ROOMS.get(place.kind) or tint(place.kind, 0.5, 0.91)
        rooms.append(Area(frame.spots(place.area), fill, note=_note(place, language)))
        if place.inside and world.place(place.inside):
            rim = mixed(fill, INK, 0.22)
            outline = frame.spots((*place.area, place.area[0]))
            rooms += [Line(dash, rim, 0.9) for dash in dashes(outline, 4, 4)]
    for zone in world.zones:
        outline = frame.spots(zone.polygon)
        rooms += [Line(line, NO_ENTRY, 1.2) for line in hatching(outline, 9)]
        rooms.append(Area(outline, None, NO_ENTRY, 2, zone.name))


def _note(place: Place, language: str) -> str:
    """Its kind has an English name only."""
    return f"{place.name} ({place.kind})" if language == "en" else name_in(place, language)


def _draw_furniture(world: World, frame: Frame, scene: Scene, board: Board, language: str) -> None:
    layer = scene.layer("furniture")
    for piece in world.furniture:
        if piece.pose is None:
            continue
        layer.extend(_furniture_shapes(piece, piece.pose, frame, name_in(piece, language)))
        board.draw(box_about(frame.spots(piece.outline)), 1.0)


def _furniture_shapes(piece: Furniture, pose: Pose, frame: Frame, name: str) -> Iterable[Shape]:
    fill, rim = _FURNITURE.get(piece.kind, (_WOOD, _WOOD_RIM))
    if piece.kind == "plant":
        u, v = frame.spot(pose.x, pose.y)
        radius = min(piece.size) / 2 * frame.scale
        yield Disc(u, v, radius, fill, rim, 1, name)
        yield Disc(u, v, radius * 0.45, rim)
        return
    yield Area(frame.spots(piece.outline), fill, rim, 1, name)
    length, width = piece.size
    if piece.kind == "bed":
        # The head is where the bed's length points to.
        yield _part(pose, frame, length * 0.36, width * 0.72, length * 0.2, "#e6edf4", rim)
        yield _part(pose, frame, -length * 0.16, width * 0.96, length * 0.62, "#eef4f9", None)
    elif piece.kind == "chair":
        # One sits facing where its length points to; on a sofa, with it to the right.
        yield _part(pose, frame, -length * 0.39, width, length * 0.22, _back(fill, rim), rim)
    elif piece.kind == "sofa":
        back = Pose(pose.x, pose.y, pose.theta + 90)
        yield _part(back, frame, -width * 0.39, length, width * 0.22, _back(fill, rim), rim)
    elif piece.kind == "shelf":
        ends = (frame.spot(*point) for point in _middle_line(pose, length))
        yield Line(tuple(ends), rim, 0.8)


def _back(fill: str, rim: str) -> str:
    return mixed(fill, rim, 0.6)


def _part(
    pose: Pose, frame: Frame, along: float, width: float, length: float, fill: str, rim: str | None
) -> Area:
    """A rectangle on a piece of furniture, so far along from its middle."""
    angle = math.radians(pose.theta)
    middle = Pose(pose.x + along * math.cos(angle), pose.y + along * math.sin(angle), pose.theta)
    return Area(frame.spots(rectangle(middle, (length, width))), fill, rim, 0.8)


def _middle_line(pose: Pose, length: float) -> Iterable[tuple[float, float]]:
    angle = math.radians(pose.theta)
    for along in (-length * 0.46, length * 0.46):
        yield (pose.x + along * math.cos(angle), pose.y + along * math.sin(angle))


def _draw_doors(world: World, frame: Frame, scene: Scene, board: Board) -> None:
    layer = scene.layer("doors")
    for door in world.doors:
        x1, y1, x2, y2 = door.ends
        if not door.open:
            ends = (frame.spot(x1, y1), frame.spot(x2, y2))
            layer.append(Line(ends, "#b08a5b", max(world.wall_thickness * frame.scale * 0.6, 2)))
            continue
        width = math.hypot(x2 - x1, y2 - y1)
        side = _side(world, door)
        leaves: list[Shape] = []
        if width <= 1.45:
            leaves += _leaf(frame, (x1, y1), (x2, y2), side)
        elif width <= 2.2:
            middle = ((x1 + x2) / 2, (y1 + y2) / 2)
            leaves += _leaf(frame, (x1, y1), middle, side)
            leaves += _leaf(frame, (x2, y2), middle, -side)
        for leaf in leaves:
            if isinstance(leaf, Line):
                board.draw(box_about(leaf.points), 0.4)
        layer.extend(leaves)


def _side(world: World, door: Door) -> int:
    """1 if the door opens to the left of its line, -1 if to the right: into its place."""
    place = world.place(door.at) if door.at else None
    if place is None or place.pose is None:
        return 1
    x1, y1, x2, y2 = door.ends
    cross = (x2 - x1) * (place.pose.y - y1) - (y2 - y1) * (place.pose.x - x1)
    return 1 if cross > 0 else -1


def _leaf(
    frame: Frame, hinge: tuple[float, float], end: tuple[float, float], side: int
) -> Iterable[Shape]:
    """A door's leaf, open, and the arc it swings along."""
    width = math.hypot(end[0] - hinge[0], end[1] - hinge[1])
    shut = math.degrees(math.atan2(end[1] - hinge[1], end[0] - hinge[0]))
    u, v = frame.spot(*hinge)
    swing = arc(u, v, width * frame.scale, shut, shut + 90 * side)
    yield Line(swing, "#c3c9d0", 0.8)
    yield Line(((u, v), swing[-1]), "#8d98a4", 1.5)


def _draw_walls(world: World, frame: Frame, scene: Scene, board: Board) -> None:
    width = min(max(world.wall_thickness * frame.scale, 2.0), 7.0)
    layer = scene.layer("walls")
    for x1, y1, x2, y2 in world.walls:
        ends = (frame.spot(x1, y1), frame.spot(x2, y2))
        layer.append(Line(ends, WALL, width, square=world.map is None))
        if ends[0][0] == ends[1][0] or ends[0][1] == ends[1][1]:
            board.draw(box_about(ends).grown(width / 2 + 1), 8.0)


def _draw_charger(world: World, frame: Frame, scene: Scene, board: Board) -> None:
    """A bolt where the robot is charged."""
    charger = world.charger
    if charger is None or charger.pose is None:
        return
    u, v = frame.spot(charger.pose.x, charger.pose.y)
    size = min(max(0.22 * frame.scale, 7.0), 14.0)
    bolt = ((0.25, -1), (-0.6, 0.15), (-0.05, 0.15), (-0.25, 1), (0.6, -0.2), (0.05, -0.2))
    points = tuple((u + a * size, v + b * size) for a, b in bolt)
    scene.layer("charger").append(Area(points, "#6cae3e", note="charging station"))
    board.labels.append(box_at(u, v, 2 * size, 2 * size))


# --- who and what is there -----------------------------------------------------------------------


def _inhabitants(world: World) -> list[Inhabitant]:
    """Everybody as they are when the simulation begins."""
    return [
        (placing.x, placing.y, person.name, person.kind)
        for person, placing in people_at_start(world, chart_of(world))
    ]


def _things(world: World, language: str) -> list[tuple[float, float, str, str]]:
    """x, y, description and colour of every object."""
    return [
        (
            item.x,
            item.y,
            _described(item.thing, language),
            next((_COLOURS[word] for word in item.thing.is_ if word in _COLOURS), "#9aa3ab"),
        )
        for item in things_at_start(world, chart_of(world))
        if item.present
    ]


def _described(thing: Thing, language: str) -> str:
    """Its attributes are English words."""
    attributes = thing.is_ if language == "en" else ()
    return " ".join([*attributes, name_in(thing, language)])


def _draw_things(
    things: Iterable[tuple[float, float, str, str]], frame: Frame, scene: Scene
) -> None:
    layer = scene.layer("objects")
    for x, y, note, colour in things:
        u, v = frame.spot(x, y)
        diamond = ((u, v - 4.6), (u + 4.6, v), (u, v + 4.6), (u - 4.6, v))
        layer.append(Area(diamond, colour, INK, 1.1, note))


def _draw_place_names(
    world: World, frame: Frame, scene: Scene, board: Board, language: str
) -> None:
    """Small places first: they have less choice. A part's floor is taken for what it is in."""
    layer = scene.layer("names")
    named = sorted(world.places, key=lambda p: polygon_area(p.area) if p.area else 0.0)
    for place in named:
        name = name_in(place, language)
        if place.area:
            outline = frame.spots(place.area)
            label = label_area(board, name, outline, ROOM_NAME)
            if label is None and place.pose is not None:
                spot = frame.spot(place.pose.x, place.pose.y)
                label = label_spot(board, name, spot, 8, 11, ROOM_NAME)
            layer.extend(label or [])
            if place.inside and world.place(place.inside):
                board.draw(box_about(outline), 2.0)
        elif place.pose is not None:
            spot = frame.spot(place.pose.x, place.pose.y)
            layer.append(Disc(*spot, 3, ROOM_NAME, note=_note(place, language)))
            layer.extend(label_spot(board, name, spot, 3, 12, ROOM_NAME) or [])
