/** What stands still: rooms, walls, doors, furniture, zones, names; as in a printed floor plan. */

import {placeNames, writeLabel} from './labels.js';
import {along, area, boxAbout, boxAt, radians, rectangle, touches} from './shapes.js';

const PAUSE = 120; // milliseconds between two placings of the names while one zooms
const MUCH = 0.25; // zoomed by e to this, names are placed anew at once

/** The colours of what an image map says. */
const MAPPED = {free: 'ground', occupied: 'occupied', unknown: 'unknown'};

/**
 * Draws the plan of a floor.
 * @typedef {{camera: import("./camera.js").Camera, palette: import("./palette.js").Palette}} Look
 */
export class PlanPainter {
  #labels = [];
  #placed = {scale: 0, at: -Infinity}; // what the labels were placed for, and when

  constructor(floor) {
    this.floor = floor;
    this.rooms = floor.places
      .filter((place) => place.area.length)
      .sort((one, two) => area(two.area) - area(one.area));
  }

  /** Paint all of it. `closed` has the numbers of closed doors, `layers` what to show. */
  paint(context, {camera, palette}, {closed, layers, zones}) {
    const pen = new Pen(context, camera);
    context.clearRect(0, 0, camera.width, camera.height);
    this.#paintRooms(context, pen, palette);
    if (layers.furniture) this.#paintFurniture(pen, palette);
    this.#paintDoors(pen, palette, closed);
    this.#paintWalls(context, pen, palette);
    this.#paintSpots(pen, palette);
    this.#paintCharger(pen, palette);
    if (layers.zones) for (const zone of zones) paintZone(pen, palette, zone.polygon);
  }

  /** Write the names, over the ways that lead below them; returns their boxes in pixels. */
  paintNames(context, {camera, palette}) {
    this.#place(context, camera);
    const [ink, halo] = [palette.get('name'), palette.get('name-halo')];
    const labels = this.#inPicture(camera);
    for (const label of labels) writeLabel(context, label, ink, halo);
    return labels.map(({box}) => box);
  }

  /** Whether the names are where they are best; while one zooms they only move along. */
  settled(camera) {
    return this.#placed.scale === camera.scale;
  }

  /** The place whose name is under the pixel. */
  placeNamedAt(camera, u, v) {
    const at = boxAt(u, v, 8, 8);
    return this.#inPicture(camera).find(({box}) => touches(box, at))?.place ?? null;
  }

  #place(context, {scale}) {
    const at = performance.now();
    const zoomed = Math.abs(Math.log(scale / this.#placed.scale));
    if (!zoomed || (zoomed < MUCH && at - this.#placed.at < PAUSE)) return;
    const {now, things} = this.floor;
    const spots = [...now.people.map(([, , x, y]) => [x, y]), ...things.map(({x, y}) => [x, y])];
    this.#labels = placeNames(context, this.floor, spots, scale);
    this.#placed = {scale, at};
  }

  /** The labels in pixels of the picture. */
  #inPicture(camera) {
    const [du, dv] = camera.toScreen(0, 0);
    const ratio = camera.scale / this.#placed.scale;
    return this.#labels.map((label) => {
      const {left, top, right, bottom} = label.box;
      const u = ((left + right) / 2) * ratio + du;
      const v = ((top + bottom) / 2) * ratio + dv;
      return {...label, box: boxAt(u, v, right - left, bottom - top)};
    });
  }

  #paintRooms(context, pen, palette) {
    const {ground, bounds, walls, map} = this.floor;
    for (const [what, outline] of map) pen.area(outline, palette.get(MAPPED[what]));
    context.beginPath();
    if (!ground.length && walls.length) {
      const [x1, y1, x2, y2] = bounds;
      pen.trace([
        [x1, y1],
        [x2, y1],
        [x2, y2],
        [x1, y2],
      ]);
    }
    context.fillStyle = palette.get('ground');
    context.fill();
    for (const place of this.rooms) {
      pen.area(place.area, palette.room(place.kind));
      if (!place.part) continue;
      context.setLineDash([4, 4]);
      pen.area(place.area, null, palette.get('part-rim'), 0.9);
      context.setLineDash([]);
    }
  }

  #paintWalls(context, pen, palette) {
    const {walls, ground, wall} = this.floor;
    context.strokeStyle = palette.get('wall');
    context.lineWidth = Math.min(Math.max(wall * pen.scale, 1.6), 9);
    context.lineCap = 'square';
    context.beginPath();
    for (const [x1, y1, x2, y2] of walls) {
      context.moveTo(...pen.spot([x1, y1]));
      context.lineTo(...pen.spot([x2, y2]));
    }
    for (const outline of ground) pen.trace(outline);
    context.stroke();
    context.lineCap = 'butt';
  }

  #paintDoors(pen, palette, closed) {
    const {doors, wall} = this.floor;
    doors.forEach((door, number) => {
      const [x1, y1, x2, y2] = door.ends;
      if (closed ? closed.includes(number) : !door.open) {
        const width = Math.max(wall * pen.scale * 0.6, 2);
        pen.line([[x1, y1], [x2, y2]], palette.get('door-shut'), width);
        return;
      }
      const width = Math.hypot(x2 - x1, y2 - y1);
      if (width <= 1.45) pen.leaf([x1, y1], [x2, y2], door.side, palette);
      else if (width <= 2.2) {
        const middle = [(x1 + x2) / 2, (y1 + y2) / 2];
        pen.leaf([x1, y1], middle, door.side, palette);
        pen.leaf([x2, y2], middle, -door.side, palette);
      }
    });
  }

  #paintFurniture(pen, palette) {
    for (const piece of this.floor.furniture) {
      const {kind, pose, size} = piece;
      const [fill, rim] = palette.furniture(kind);
      if (kind === 'plant') {
        const radius = (Math.min(...size) / 2) * pen.scale;
        pen.disc(pose, radius, fill, rim, 1);
        pen.disc(pose, radius * 0.45, rim);
        continue;
      }
      pen.area(rectangle(pose, size), fill, rim, 1);
      const [length, width] = size;
      const part = (far, wide, long, colour, edge) => {
        pen.area(rectangle([...along(pose, far), pose[2]], [long, wide]), colour, edge, 0.8);
      };
      if (kind === 'bed') {
        // The head is where the bed's length points to.
        part(length * 0.36, width * 0.72, length * 0.2, palette.get('pillow'), rim);
        part(-length * 0.16, width * 0.96, length * 0.62, palette.get('blanket'), null);
      } else if (kind === 'chair') part(-length * 0.39, width, length * 0.22, rim, null);
      else if (kind === 'sofa') {
        // One sits facing to the right of its length.
        const back = [pose[0], pose[1], pose[2] + 90];
        const behind = [...along(back, -width * 0.39), back[2]];
        pen.area(rectangle(behind, [width * 0.22, length]), rim, null);
      } else if (kind === 'shelf') {
        pen.line([along(pose, -length * 0.46), along(pose, length * 0.46)], rim, 0.8);
      }
    }
  }

  /** Places that are no rooms: where one stands in them. */
  #paintSpots(pen, palette) {
    for (const {area: floor, kind, pose} of this.floor.places) {
      if (pose && !floor.length && kind !== 'charger') pen.disc(pose, 3, palette.get('name'));
    }
  }

  #paintCharger(pen, palette) {
    const charger = this.floor.places.find((place) => place.kind === 'charger' && place.pose);
    if (!charger) return;
    const [u, v] = pen.spot(charger.pose);
    const size = Math.min(Math.max(0.22 * pen.scale, 6), 14);
    const bolt = [
      [0.25, -1],
      [-0.6, 0.15],
      [-0.05, 0.15],
      [-0.25, 1],
      [0.6, -0.2],
      [0.05, -0.2],
    ];
    pen.pixels(
      bolt.map(([a, b]) => [u + a * size, v + b * size]),
      palette.get('bolt'),
    );
  }
}

/** A hatched area that the robot keeps out of. */
export function paintZone(pen, palette, polygon) {
  const {context} = pen;
  const colour = palette.get('zone');
  context.save();
  context.beginPath();
  pen.trace(polygon);
  context.fillStyle = palette.get('zone-fill');
  context.fill();
  context.clip();
  const {left, top, right, bottom} = boxAbout(polygon.map((corner) => pen.spot(corner)));
  const high = bottom - top;
  context.beginPath();
  for (let u = left - high; u < right; u += 9) {
    context.moveTo(u, bottom);
    context.lineTo(u + high, top);
  }
  context.strokeStyle = colour;
  context.globalAlpha = 0.45;
  context.lineWidth = 1.2;
  context.stroke();
  context.restore();
  context.setLineDash([6, 4]);
  pen.area(polygon, null, colour, 1.6);
  context.setLineDash([]);
}

/** Draws on a canvas what is given in metres. */
export class Pen {
  constructor(context, camera) {
    this.context = context;
    this.camera = camera;
    this.scale = camera.scale;
  }

  spot([x, y]) {
    return this.camera.toScreen(x, y);
  }

  /** Add a polygon to the path. */
  trace(polygon) {
    polygon.forEach((corner, number) => {
      if (number) this.context.lineTo(...this.spot(corner));
      else this.context.moveTo(...this.spot(corner));
    });
    this.context.closePath();
  }

  area(polygon, fill, rim = null, width = 1) {
    this.pixels(
      polygon.map((corner) => this.spot(corner)),
      fill,
      rim,
      width,
    );
  }

  /** A polygon in pixels. */
  pixels(points, fill, rim = null, width = 1) {
    const {context} = this;
    context.beginPath();
    for (const [u, v] of points) context.lineTo(u, v);
    context.closePath();
    this.#ink(fill, rim, width);
  }

  disc(spot, radius, fill, rim = null, width = 1) {
    this.context.beginPath();
    this.context.arc(...this.spot(spot), radius, 0, 2 * Math.PI);
    this.#ink(fill, rim, width);
  }

  line(points, colour, width) {
    const {context} = this;
    context.beginPath();
    for (const point of points) context.lineTo(...this.spot(point));
    context.strokeStyle = colour;
    context.lineWidth = width;
    context.stroke();
  }

  /** A door's leaf, open, and the arc it swings along. */
  leaf(hinge, end, side, palette) {
    const [u, v] = this.spot(hinge);
    const [a, b] = this.spot(end);
    const radius = Math.hypot(a - u, b - v);
    const shut = Math.atan2(b - v, a - u);
    const open = shut - radians(90 * side);
    const {context} = this;
    context.beginPath();
    context.arc(u, v, radius, shut, open, side > 0);
    context.strokeStyle = palette.get('door-swing');
    context.lineWidth = 0.8;
    context.stroke();
    context.beginPath();
    context.moveTo(u, v);
    context.lineTo(u + radius * Math.cos(open), v + radius * Math.sin(open));
    context.strokeStyle = palette.get('door');
    context.lineWidth = 1.5;
    context.stroke();
  }

  #ink(fill, rim, width) {
    const {context} = this;
    if (fill) {
      context.fillStyle = fill;
      context.fill();
    }
    if (rim) {
      context.strokeStyle = rim;
      context.lineWidth = width;
      context.stroke();
    }
  }
}
