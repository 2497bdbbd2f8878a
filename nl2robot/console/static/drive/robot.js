/**
 * How the robot is, as it says itself: never as it was asked to be.
 *
 *   robot.follow('volume', (percent) => ...);  // null: the robot has not said
 *
 * What is known at first comes with `helm.body`, what changes with the robot's events. After a lost
 * connection it is asked anew, for the robot may be another by then.
 */

import {wire} from '/static/wire.js';

/** What an event says is so from now on; `joints` is of each joint that was heard of. */
const EVENTS = {
  pose: (data) => ({pose: data}),
  battery: (data) => ({battery: data}),
  emotion: ({name}) => ({emotion: name}),
  volume: ({percent}) => ({volume: percent}),
  language: ({code}) => ({language: code}),
  joint: ({name, degrees}, known) => ({joints: {...known.joints, [name]: degrees}}),
  screen: (data) => ({screen: data}),
  call: (data) => ({call: data}),
};

const nothing = {
  ...{pose: null, battery: null, emotion: null, volume: null},
  ...{language: null, joints: null, screen: null, call: null},
};

class Robot {
  constructor() {
    this._known = {...nothing};
    this._heard = new Set(); // what it has said since it was asked
    this._listeners = new Set();
  }

  /** Follow the robot from now on; resolves to what `helm.body` tells. */
  async start() {
    for (const [kind, read] of Object.entries(EVENTS)) {
      wire.subscribe(kind, (data) => this._hear(read(data, this._known)));
    }
    const body = await this._ask();
    let connected = wire.connected;
    wire.onChange((is) => {
      if (is && !connected) this._ask().catch((error) => console.warn(error.message));
      connected = is;
    });
    return body;
  }

  /** What it says while the answer is on its way is newer than the answer. */
  async _ask() {
    this._heard.clear();
    const body = await wire.request('helm.body');
    const {now} = body;
    const told = {...nothing, ...now, emotion: now.emotion?.name ?? null};
    for (const what of this._heard) told[what] = this._known[what];
    if (this._heard.has('joints')) told.joints = {...now.joints, ...this._known.joints};
    this._set(told);
    return body;
  }

  _hear(news) {
    for (const what of Object.keys(news)) this._heard.add(what);
    this._set(news);
  }

  /** Be told what is known of `what`, now and whenever the robot says it; null while it has not. */
  follow(what, listener) {
    this._listeners.add({what, listener});
    listener(this._known[what] ?? null);
  }

  _set(news) {
    Object.assign(this._known, news);
    for (const {what, listener} of this._listeners) {
      if (what in news) listener(news[what]);
    }
  }
}

/** The robot of this page. */
export const robot = new Robot();
