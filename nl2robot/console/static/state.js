/**
 * How the robot and its program stand: the one state that every page shows, as the server tells it.
 *
 *   import {present} from '/static/state.js';
 *   present.onChange(({state, run}) => ...);
 *
 * The server tells the present one first to whoever comes, or comes again.
 */

import {wire} from '/static/wire.js';

class Present {
  constructor() {
    this.now = {sequence: 0, state: null, run: null, line: null, unconfirmed: false, lost_since: null};
    this._listeners = new Set();
    wire.subscribe('state', (state) => this._take(state));
  }

  /** Whether this run goes on. */
  goesOn(run) {
    return run != null && this.now.run === run;
  }

  /** Be told, now (once there is something to tell) and at each change; returns what ends it. */
  onChange(listener) {
    this._listeners.add(listener);
    if (this.now.state) listener(this.now, this.now);
    return () => this._listeners.delete(listener);
  }

  _take(state) {
    if (state.sequence <= this.now.sequence) return; // overtaken on the way
    const before = this.now;
    this.now = state;
    for (const listener of this._listeners) listener(state, before);
  }
}

/** The present state. */
export const present = new Present();
