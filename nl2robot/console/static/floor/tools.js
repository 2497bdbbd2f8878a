/** What a press on the map means: one tool for each mode. Positions are in metres. */

import {paintFlag, paintRobot, robotSize} from './paint_live.js';
import {paintZone} from './paint_plan.js';
import {along, area, distance, radians} from './shapes.js';

const KNOB = 26; // pixels from the robot's rim to the knob that turns it
const GRASP = 14; // pixels that a finger may miss by
const LEAST_ZONE = 0.05; // square metres
const ARROW = 34; // pixels that show which way to face

/** Look only: a click asks what is there. */
export class Look {
  constructor(map) {
    this.map = map;
  }

  /** Whether the drag that begins here is this tool's. */
  press() {
    return false;
  }

  drag() {}

  release() {}

  hover() {}

  leave() {}

  paint() {}

  /** A place was chosen from the list. */
  choose(place) {
    this.map.showPlace(place);
  }
}

/** A click sends the robot there. */
export class Send extends Look {
  #aim = null; // {x, y, place}
  #sent = null;

  hover(spot, pixel) {
    this.#aim = this.map.targetAt(spot, pixel);
    this.map.draw();
  }

  leave() {
    this.#aim = null;
    this.map.draw();
  }

  release(spot, pixel, clicked) {
    if (clicked) this.#go(this.map.targetAt(spot, pixel));
  }

  choose(place) {
    const [x, y] = place.pose ?? this.map.floor.middleOf(place);
    this.#go({x, y, place: place.name});
  }

  paint(pen, palette) {
    for (const target of [this.#sent, this.#aim]) {
      if (target) paintFlag(pen, [target.x, target.y], palette.get('dry-run'));
    }
  }

  /** It was sent there, beside where it was aimed perhaps; null: nowhere. */
  sentTo(spot) {
    this.#sent = spot;
    this.map.draw();
  }

  #go(target) {
    this.#sent = target;
    this.map.draw();
    this.map.tell('go', target);
  }
}

/** The robot is dragged to where it really is, and turned by a knob. */
export class Localise extends Look {
  #pose = null;
  #turning = false;

  press(spot, pixel) {
    const pose = this.map.robotPose();
    if (!pose) return false;
    const [u, v] = this.map.camera.toScreen(...pose);
    const [a, b] = this.#knob(pose);
    this.#turning = distance(...pixel, a, b) < GRASP;
    const size = robotSize(this.map.camera.scale, this.map.floor.robot.radius);
    if (!this.#turning && distance(...pixel, u, v) > size + GRASP) return false;
    this.#pose = pose;
    return true;
  }

  drag([x, y]) {
    const pose = this.#pose;
    if (this.#turning) {
      const degrees = (Math.atan2(y - pose[1], x - pose[0]) * 180) / Math.PI;
      this.#pose = [pose[0], pose[1], Math.round(degrees)];
    } else this.#pose = [x, y, pose[2]];
    this.map.draw();
  }

  release(spot, pixel, clicked) {
    const pose = this.#pose;
    this.#pose = null;
    if (pose && !clicked) this.#tell(pose);
    this.map.draw();
  }

  choose(place) {
    const [x, y, theta] = place.pose ?? [...this.map.floor.middleOf(place), 0];
    this.#tell([x, y, theta]);
  }

  paint(pen, palette) {
    const pose = this.#pose ?? this.map.robotPose();
    if (!pose) return;
    if (this.#pose) paintRobot(pen, palette, pose, this.map.floor.robot.radius, true);
    const {context} = pen;
    const knob = this.#knob(pose);
    const colour = palette.get('dry-run');
    context.beginPath();
    context.moveTo(...pen.spot(pose));
    context.lineTo(...knob);
    context.strokeStyle = colour;
    context.lineWidth = 2;
    context.stroke();
    context.beginPath();
    context.arc(...knob, 7, 0, 2 * Math.PI);
    context.fillStyle = colour;
    context.fill();
    context.strokeStyle = palette.get('robot-rim');
    context.stroke();
  }

  #knob(pose) {
    const [u, v] = this.map.camera.toScreen(...pose);
    const far = robotSize(this.map.camera.scale, this.map.floor.robot.radius) + KNOB;
    return [u + far * Math.cos(radians(pose[2])), v - far * Math.sin(radians(pose[2]))];
  }

  #tell([x, y, theta]) {
    this.map.localise({x: round(x), y: round(y), theta});
  }
}

/** A click names a place; a drag from there says which way to face. Those named by hand are dragged
 * elsewhere. */
export class Name extends Look {
  #spot = null; // {x, y, theta} of the one that is being named
  #start = null; // where a drag began
  #held = null; // the place that is dragged, and where it is now
  #at = null;

  press(spot, pixel) {
    this.#held = this.#nearest(pixel);
    this.#start = spot;
    this.#at = this.#held?.pose ?? null;
    return true;
  }

  drag([x, y]) {
    if (this.#held) this.#at = [x, y];
    else this.#spot = {...this.#whereItBegan(), theta: this.#angle([x, y])};
    this.map.draw();
  }

  release([x, y], pixel, clicked) {
    const held = this.#held;
    this.#held = null;
    if (held && clicked) this.map.places.edit(held);
    else if (held) this.map.places.move(held, [round(x), round(y)]);
    else if (clicked || this.#farFrom(pixel)) {
      this.#spot = {...this.#whereItBegan(), theta: clicked ? null : this.#angle([x, y])};
      this.map.places.pick(this.#spot);
    } else this.#spot = null;
    this.map.draw();
  }

  choose(place) {
    if (place.removable) this.map.places.edit(place);
    else this.map.showPlace(place);
  }

  /** Forget the spot. */
  clear() {
    this.#spot = null;
    this.map.draw();
  }

  paint(pen, palette) {
    const colour = palette.get('dry-run');
    for (const place of this.map.floor.places) {
      if (!place.removable) continue;
      const at = place === this.#held ? this.#at : place.pose;
      pen.disc(at, 6, palette.get('robot-rim'), colour, 2.5);
    }
    if (!this.#spot) return;
    const {x, y, theta} = this.#spot;
    if (theta !== null) pen.line([[x, y], along([x, y, theta], ARROW / pen.scale)], colour, 3);
    paintFlag(pen, [x, y], colour);
  }

  #nearest(pixel) {
    const far = ({pose}) => distance(...this.map.camera.toScreen(...pose), ...pixel);
    const near = this.map.floor.places.filter((place) => place.removable && far(place) < GRASP);
    return near.sort((one, two) => far(one) - far(two))[0] ?? null;
  }

  /** Whether it was a drag, and not two fingers that came to move the map. */
  #farFrom(pixel) {
    return distance(...this.map.camera.toScreen(...this.#start), ...pixel) > GRASP;
  }

  #whereItBegan() {
    const [x, y] = this.#start;
    return {x: round(x), y: round(y)};
  }

  #angle([x, y]) {
    return Math.round((Math.atan2(y - this.#start[1], x - this.#start[0]) * 180) / Math.PI);
  }
}

/** A zone to keep out of: a dragged rectangle, or clicked corners. */
export class Zone extends Look {
  #corners = [];
  #aim = null;
  #start = null; // of the rectangle that is being dragged

  /** The corners so far; three make an area. */
  get corners() {
    return this.#corners;
  }

  press(spot) {
    this.#start = this.#corners.length ? null : spot;
    return true;
  }

  drag(spot) {
    this.#aim = spot;
    this.map.draw();
  }

  hover(spot) {
    if (!this.#corners.length) return;
    this.#aim = spot;
    this.map.draw();
  }

  release(spot, pixel, clicked) {
    if (!clicked && this.#start) {
      this.#finish(box(this.#start, spot));
    } else if (this.#closes(pixel)) this.#finish(this.#corners);
    else this.#corners = [...this.#corners, spot];
    this.#start = null;
    this.map.zoneChanged();
  }

  choose(place) {
    if (place.area.length) this.#finish(place.area, place);
    this.map.zoneChanged();
  }

  /** Forget the corners. */
  clear() {
    this.#corners = [];
    this.#aim = null;
    this.map.zoneChanged();
  }

  paint(pen, palette) {
    const dragged = this.#start && this.#aim ? box(this.#start, this.#aim) : null;
    const outline = dragged ?? this.#corners;
    const colour = palette.get('zone');
    if (outline.length > 2) paintZone(pen, palette, outline);
    if (dragged) return;
    if (this.#aim && outline.length) pen.line([...outline, this.#aim], colour, 1.6);
    for (const corner of outline) pen.disc(corner, 4, palette.get('robot-rim'), colour, 2);
  }

  /** A click on the first corner, or twice on the last, closes the polygon. */
  #closes(pixel) {
    if (this.#corners.length < 3) return false;
    return [this.#corners[0], this.#corners.at(-1)].some(
      (corner) => distance(...this.map.camera.toScreen(...corner), ...pixel) < GRASP,
    );
  }

  #finish(corners, place = null) {
    this.#corners = area(corners) < LEAST_ZONE ? [] : corners.map(([x, y]) => [round(x), round(y)]);
    this.#aim = null;
    if (this.#corners.length) this.map.zoneDrawn(place);
  }
}

const box = ([x1, y1], [x2, y2]) => [
  [x1, y1],
  [x2, y1],
  [x2, y2],
  [x1, y2],
];

const round = (metres) => Math.round(metres * 100) / 100;
