/**
 * The joystick, for a finger, a mouse and the keys, with its dead man's switch: the robot moves only
 * while the stick or a key is held, in a page that is looked at and connected. A movement is sent
 * ten times a second and lasts 0.3 s at the robot, so that it stands whatever becomes of this page.
 */

import {present} from '/static/state.js';
import {wire} from '/static/wire.js';
import {helm} from './helm.js';

const EVERY = 100;
/** How far from its middle the stick is still at rest, of 1. */
const AT_REST = 0.12;
/** More answers than these are not waited for: the connection is too slow to drive over it. */
const MOST_WAITING = 6;

const KEYS = {
  ArrowUp: [0, 1], KeyW: [0, 1],
  ArrowDown: [0, -1], KeyS: [0, -1],
  ArrowLeft: [1, 0], KeyA: [1, 0],
  ArrowRight: [-1, 0], KeyD: [-1, 0],
};

/** Metres and degrees a second at full stick, by the position of the speed slider. */
export const SPEEDS = [
  {linear: 0.2, angular: 30},
  {linear: 0.45, angular: 60},
  {linear: 0.9, angular: 100},
];

export class Joystick {
  /**
   * `stick` is the element to drag, with its knob inside; `speed()` the limits;
   * `told({moving, obeyed, slow, error})` hears how it goes, one of them at a time.
   */
  constructor(stick, knob, speed, told) {
    this._stick = stick;
    this._knob = knob;
    this._speed = speed;
    this._told = told;
    this._keys = new Set();
    this._pointer = null;
    this._want = [0, 0];
    this._timer = 0;
    this._number = 0;
    this._waiting = 0;
    this._listen();
  }

  /** Whether it is held just now. */
  get held() {
    return this._timer !== 0;
  }

  _listen() {
    const stick = this._stick;
    stick.addEventListener('pointerdown', (event) => this._grasp(event));
    stick.addEventListener('pointermove', (event) => {
      if (event.pointerId === this._pointer) this._drag(event);
    });
    for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      stick.addEventListener(kind, (event) => {
        if (event.pointerId === this._pointer) this.end();
      });
    }
    stick.addEventListener('contextmenu', (event) => event.preventDefault());
    document.addEventListener('keydown', (event) => this._press(event));
    document.addEventListener('keyup', (event) => this._lift(event));
    // Whoever types now means to write.
    document.addEventListener('focusin', (event) => {
      if (this._keys.size && takesKeys(event.target)) this.end();
    });
    const end = () => this.end();
    window.addEventListener('blur', end);
    window.addEventListener('pagehide', end);
    document.addEventListener('visibilitychange', end);
    present.onChange(({state}) => ['stopping', 'stopped', 'lost'].includes(state) && end());
    wire.onChange((connected) => connected || this.end());
    helm.onChange(() => helm.moves || this.end());
  }

  // --- the finger and the mouse

  _grasp(event) {
    if (!helm.moves || this.held || event.button !== 0) return;
    event.preventDefault();
    this._stick.focus({preventScroll: true});
    this._pointer = event.pointerId;
    this._stick.setPointerCapture(event.pointerId);
    this._drag(event);
    this._begin();
  }

  _drag(event) {
    const box = this._stick.getBoundingClientRect();
    const reach = box.width / 2 - this._knob.offsetWidth / 2;
    const right = (event.clientX - box.left - box.width / 2) / reach;
    const down = (event.clientY - box.top - box.height / 2) / reach;
    const far = Math.max(1, Math.hypot(right, down));
    this._aim(-right / far, -down / far);
  }

  // --- the keys

  _press(event) {
    const key = KEYS[event.code];
    if (!key || event.ctrlKey || event.metaKey || event.altKey || takesKeys(event.target)) return;
    if (!helm.moves || this._pointer !== null) return;
    event.preventDefault();
    // A key that is still down after a stop has to be lifted first.
    if (event.repeat) return;
    this._keys.add(event.code);
    this._steer();
    if (!this.held) this._begin();
  }

  _lift(event) {
    if (!this._keys.delete(event.code)) return;
    if (this._keys.size) this._steer();
    else this.end();
  }

  _steer() {
    let [left, ahead] = [0, 0];
    for (const code of this._keys) {
      left += KEYS[code][0];
      ahead += KEYS[code][1];
    }
    this._aim(Math.sign(left) * (ahead ? 0.6 : 1), Math.sign(ahead));
  }

  // --- what is wanted

  _aim(left, ahead) {
    const resting = Math.hypot(left, ahead) < AT_REST;
    this._want = resting ? [0, 0] : [left, ahead];
    const reach = (this._stick.clientWidth - this._knob.offsetWidth) / 2;
    this._knob.style.transform = `translate(${-left * reach}px, ${-ahead * reach}px)`;
  }

  _begin() {
    this._stick.classList.add('held');
    this._told({moving: true});
    this._timer = setInterval(() => this._send(), EVERY);
    this._send();
  }

  async _send() {
    const [left, ahead] = this._want;
    if (this._waiting > MOST_WAITING) {
      this._told({slow: true});
      return;
    }
    const number = (this._number += 1);
    this._waiting += 1;
    try {
      if (!left && !ahead) {
        await wire.request('helm.release', {number});
      } else {
        const {linear, angular} = this._speed();
        const wanted = {linear: rounded(ahead * linear), angular: rounded(left * angular)};
        await wire.request('helm.drive', {...wanted, number});
        this._told({obeyed: true});
      }
    } catch (error) {
      // Stopped: a newer movement took over, or the stick was let go.
      if (error.kind !== 'Stopped' && this.held) this._told({error});
    } finally {
      this._waiting -= 1;
    }
  }

  /** Let go: the robot stands. */
  end() {
    if (!this.held) return;
    clearInterval(this._timer);
    this._timer = 0;
    const pointer = this._pointer;
    this._pointer = null;
    if (pointer !== null && this._stick.hasPointerCapture(pointer)) {
      this._stick.releasePointerCapture(pointer);
    }
    this._keys.clear();
    this._aim(0, 0);
    this._stick.classList.remove('held');
    this._told({moving: false});
    if (!wire.connected) return;
    wire.request('helm.release', {number: (this._number += 1)}).catch(() => {});
  }
}

/** Whether keys mean something else where the focus is. */
function takesKeys(target) {
  return Boolean(target.closest?.('input, textarea, select, [contenteditable], dialog[open]'));
}

function rounded(value) {
  return Math.round(value * 1000) / 1000;
}
