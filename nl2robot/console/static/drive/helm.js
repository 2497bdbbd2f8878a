/** The helm as this page knows it: who drives, and calls of the robot in the driver's name. */

import {present} from '/static/state.js';
import {wire} from '/static/wire.js';

const KEPT = 'helm';
/** How long after a reload or a lost connection the helm is taken again by itself, if it is free. */
const AGAIN_WITHIN = 8000;

class Helm {
  constructor() {
    this.state = {driver: null, who: null, since: null, asking: []};
    this.me = null;
    this._who = '';
    /** Whether a program runs, and drives. */
    this.program = false;
    this._listeners = new Set();
    this._againUntil = 0;
  }

  /** Follow who drives from now on; `who` is the name of this page's operator. */
  start(who, operates) {
    this._who = who;
    wire.subscribe('helm', (state) => this._show(state));
    present.onChange(({run}) => this._showProgram(run));
    wire.onChange((connected) => {
      if (!connected) {
        this.me = null;
        this._tell();
        return;
      }
      if (operates && sessionStorage.getItem(KEPT)) {
        this._againUntil = performance.now() + AGAIN_WITHIN;
      }
      wire.request('helm.state').then((state) => this._show(state), () => {});
    });
  }

  /** Whether this page drives. */
  get mine() {
    return this.me !== null && this.state.driver === this.me;
  }

  /** Whether this page can move the robot. */
  get moves() {
    return this.mine && !this.program;
  }

  /** Whether this page has asked for the helm. */
  get asked() {
    return this.state.asking.some((asking) => asking.connection === this.me);
  }

  /** Be told, now and at each change; returns what ends it. */
  onChange(listener) {
    this._listeners.add(listener);
    listener();
    return () => this._listeners.delete(listener);
  }

  async take() {
    this._show(await wire.request('helm.take', {who: this._who}));
  }

  /** Hand over to one who asks, or let go of the helm. */
  async give(to = null) {
    sessionStorage.removeItem(KEPT);
    this._show(await wire.request('helm.give', {to}));
  }

  async keep() {
    this._show(await wire.request('helm.keep'));
  }

  /** A robot method in the driver's name; as `wire.request`. */
  call(name, given = {}) {
    return wire.request('helm.call', {name, arguments: given});
  }

  /** The same, with a way to cancel it; as `wire.call`. */
  errand(name, given = {}) {
    return wire.call('helm.call', {name, arguments: given});
  }

  _show(state) {
    if (state.me) this.me = state.me;
    this.state = {driver: state.driver, who: state.who, since: state.since, asking: state.asking};
    if (this.mine) {
      sessionStorage.setItem(KEPT, 'mine');
      this._againUntil = 0;
    } else if (performance.now() < this._againUntil) {
      if (state.driver === null && this.me !== null) {
        this._againUntil = 0;
        this.take().catch(() => {});
      }
    } else if (state.driver !== null && this.me !== null) {
      sessionStorage.removeItem(KEPT);
    }
    this._tell();
  }

  _showProgram(run) {
    if (this.program === (run !== null)) return;
    this.program = run !== null;
    this._tell();
  }

  _tell() {
    for (const listener of this._listeners) listener();
  }
}

/** The helm of this page's robot. */
export const helm = new Helm();
