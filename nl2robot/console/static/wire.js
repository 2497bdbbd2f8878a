/**
 * The robot's wire in a browser: JSON-RPC 2.0 over one WebSocket of this page.
 *
 *   import {wire} from '/static/wire.js';
 *   await wire.request('robot.say', {text: 'Hello'});
 *   const unsubscribe = wire.subscribe('pose', (pose) => ...);
 *
 * It connects again by itself when the connection is lost, and subscribes again to what it had
 * subscribed to. Requests that were in flight then fail; none is sent twice.
 */

const FIRST_WAIT = 250;
const LONGEST_WAIT = 4000;

/** An error of the robot; `kind` is its name on the wire, such as "Blocked". */
export class RobotError extends Error {
  constructor(message, kind) {
    super(message);
    this.name = this.kind = kind;
  }
}

class Wire {
  constructor() {
    this.connected = false;
    this._number = 0;
    this._waiting = new Map();
    this._unsent = [];
    this._listeners = new Map();
    this._changes = new Set();
    this._wait = FIRST_WAIT;
    this._connect();
  }

  /**
   * Call a method; resolves to its result, rejects with a RobotError. A request made while there is
   * no connection waits for one only if the page has just been opened.
   */
  request(method, params = {}) {
    return this.call(method, params).answer;
  }

  /** As `request`, with a way to cancel it: {answer, cancel}. */
  call(method, params = {}) {
    const id = (this._number += 1);
    const answer = new Promise((resolve, reject) => this._waiting.set(id, {resolve, reject}));
    const frame = JSON.stringify({jsonrpc: '2.0', id, method, params});
    if (this.connected) {
      this._socket.send(frame);
    } else if (this._unsent) {
      this._unsent.push(frame);
    } else {
      this._fail(id, 'There is no connection to the robot.');
    }
    return {answer, cancel: () => this.request('rpc.cancel', {id}).catch(() => false)};
  }

  /** Be told of a kind of event; returns what ends it. */
  subscribe(kind, listener) {
    if (!this._listeners.has(kind)) {
      this._listeners.set(kind, new Set());
      if (this.connected) this._subscribe([kind]);
    }
    this._listeners.get(kind).add(listener);
    return () => {
      const listeners = this._listeners.get(kind);
      if (!listeners?.delete(listener) || listeners.size) return;
      this._listeners.delete(kind);
      if (this.connected) this.request('rpc.unsubscribe', {events: [kind]}).catch(() => {});
    };
  }

  /** Be told, now and at each change, whether there is a connection; returns what ends it. */
  onChange(listener) {
    this._changes.add(listener);
    listener(this.connected);
    return () => this._changes.delete(listener);
  }

  /** Let go of the connection at once and stay away; for pages that are left. */
  close() {
    this._closed = true;
    this._socket.close();
  }

  _subscribe(events) {
    this.request('rpc.subscribe', {events}).catch((error) => console.warn(error.message));
  }

  _connect() {
    const scheme = location.protocol === 'https:' ? 'wss:' : 'ws:';
    const socket = (this._socket = new WebSocket(`${scheme}//${location.host}/`));
    socket.addEventListener('open', () => {
      this._wait = FIRST_WAIT;
      this.connected = true;
      if (this._listeners.size) this._subscribe([...this._listeners.keys()]);
      for (const frame of this._unsent ?? []) socket.send(frame);
      this._unsent = null;
      this._changed();
    });
    socket.addEventListener('message', (message) => this._receive(JSON.parse(message.data)));
    socket.addEventListener('close', () => {
      const was = this.connected;
      this.connected = false;
      this._unsent = null;
      for (const id of [...this._waiting.keys()]) {
        this._fail(id, 'The connection to the robot was lost.');
      }
      if (was) this._changed();
      else if (!this._closed) this._lookWhetherShutOut();
      if (this._closed) return;
      setTimeout(() => this._connect(), this._wait);
      this._wait = Math.min(LONGEST_WAIT, this._wait * 2);
    });
  }

  /** Who was let in and is no longer is told so by the server's own page. */
  async _lookWhetherShutOut() {
    try {
      const answer = await fetch(location.pathname, {cache: 'no-store', redirect: 'manual'});
      if (answer.status === 401 || answer.status === 403) location.reload();
    } catch {
      // The server is down: the connection is tried again.
    }
  }

  _receive(message) {
    if (message.method?.startsWith('event.')) {
      const kind = message.method.slice('event.'.length);
      for (const listener of this._listeners.get(kind) ?? []) listener(message.params);
      return;
    }
    const waiting = this._waiting.get(message.id);
    if (!waiting) return;
    this._waiting.delete(message.id);
    if (message.error) {
      this._refuse(waiting, message.error);
    } else {
      waiting.resolve(message.result);
    }
  }

  /** What the server says in English is told in the language of the page. */
  async _refuse(waiting, {message, data}) {
    const language = document.documentElement.lang.slice(0, 2);
    const foreign = language && language !== 'en' && !waiting.isTelling && this.connected;
    const told = foreign ? await this._told(message, language) : message;
    waiting.reject(new RobotError(told, data?.error ?? 'RobotError'));
  }

  /** A sentence of an error in another language; as it is where the server cannot tell it. */
  _told(sentence, language) {
    const id = (this._number += 1);
    const params = {sentence, language};
    return new Promise((resolve) => {
      this._waiting.set(id, {resolve, reject: () => resolve(sentence), isTelling: true});
      this._socket.send(JSON.stringify({jsonrpc: '2.0', id, method: 'sentence.told', params}));
    });
  }

  _fail(id, sentence) {
    this._waiting.get(id)?.reject(new RobotError(sentence, 'LostConnection'));
    this._waiting.delete(id);
  }

  _changed() {
    for (const listener of this._changes) listener(this.connected);
  }
}

/** The connection of this page. */
export const wire = new Wire();
