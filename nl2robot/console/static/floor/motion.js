/** From frames that come some ten times a second to movement without jerks. */

import {distance, wrap} from './shapes.js';

const LEAP = 3; // metres between two frames that nobody drives: set down there, not moved
const TRAIL_STEP = 0.15;
const TRAIL_POINTS = 600;

export class Motion {
  #from = null;
  #to = null;
  #began = 0;
  #lasts = 110;
  #pushed = -Infinity;

  constructor() {
    /** Where the robot has been, in metres. */
    this.trail = [];
  }

  /** A new frame, at a time in milliseconds. */
  push(frame, now) {
    const gap = now - this.#pushed;
    // As long as frames usually are apart, so that movement ends when the next one comes.
    if (gap < 400) this.#lasts += (Math.min(Math.max(gap * 1.1, 50), 250) - this.#lasts) * 0.15;
    this.#from = this.#to && gap < 1000 ? this.at(now) : frame;
    this.#to = frame;
    this.#began = now;
    this.#pushed = now;
    this.#follow(frame);
  }

  /** Show this frame as it is. */
  set(frame) {
    this.#from = this.#to = frame;
    this.#pushed = -Infinity;
    this.#follow(frame);
  }

  /** Whether anything still moves at that time. */
  moving(now) {
    return this.#from !== this.#to && now - this.#began < this.#lasts;
  }

  /** The scene at a time, between the last two frames; null before the first. */
  at(now) {
    if (!this.moving(now)) return this.#to;
    const share = Math.max((now - this.#began) / this.#lasts, 0);
    const [from, to] = [this.#from, this.#to];
    const before = new Map(from.people.map((person) => [person[0], person]));
    return {
      ...to,
      ...between(from, to, share),
      seenFrom: to, // where the robot was when the lidar measured
      people: to.people.map((person) => {
        const [name, kind, x, y, theta, posture] = person;
        const was = before.get(name);
        if (!was) return person;
        const pose = between({x: was[2], y: was[3], theta: was[4]}, {x, y, theta}, share);
        return [name, kind, pose.x, pose.y, pose.theta, posture];
      }),
    };
  }

  #follow({x, y}) {
    if (x === null) return;
    const last = this.trail.at(-1);
    const far = last ? distance(...last, x, y) : Infinity;
    if (last && far > LEAP) this.trail.length = 0;
    if (far >= TRAIL_STEP) this.trail.push([x, y]);
    if (this.trail.length > TRAIL_POINTS) this.trail.shift();
  }
}

function between(from, to, share) {
  if (from.x === null || to.x === null || distance(from.x, from.y, to.x, to.y) > LEAP) {
    return {x: to.x, y: to.y, theta: to.theta};
  }
  return {
    x: from.x + (to.x - from.x) * share,
    y: from.y + (to.y - from.y) * share,
    theta: from.theta + wrap(to.theta - from.theta) * share,
  };
}
