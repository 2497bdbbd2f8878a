/**
 * A robot somewhere else, for JavaScript in a browser, in Node, in Deno or Bun.
 *
 *   import {connect} from './nl2robot.js';
 *   const ward = await connect('ws://127.0.0.1:9090');
 *   await ward.robot.goto({place: 'pharmacy'});
 *   ward.close();
 *
 * Every method of the wire is there under its own name, and takes its params by name; which there
 * are stands in methods.d.ts, made from what the server says of itself. Calls run side by side, and
 * `robot.stop` overtakes them all. This file needs no other, and nothing needs to be built.
 */

/** @import {Api, CallOptions, ErrorName, EventName, LongestFrame} from './methods.js' */

/**
 * @typedef {object} ConnectOptions
 * @property {string} [token] what a server that asks for one was given, or a person's or device's own
 * @property {number} [timeout] seconds that the server may be silent before the connection counts as
 *   lost, and that it may take to be made; 10 if left out
 * @property {*} [WebSocket] the class to connect with; if left out the one that is there, and in an
 *   older Node that of the package `ws`
 */

/** @typedef {RobotConnection & Api} Robot */

/**
 * Bytes. A server closes the connection on whoever sends more, with all that is in flight. It says so
 * itself: with another number here, this does not compile.
 * @type {LongestFrame}
 */
const LONGEST_FRAME = 262144;
const IN_A_PAGE = typeof document !== 'undefined';

/** What went wrong, in a sentence; `name` is its name on the wire, such as "Blocked". */
export class RobotError extends Error {
  /**
   * @param {ErrorName} name
   * @param {string} sentence
   */
  constructor(name, sentence) {
    super(sentence);
    /** @type {ErrorName} */
    this.name = name;
  }
}

/**
 * Connect to a robot's server. In a page that the server itself shows, the address may be left out.
 * Rejects with `LostConnection` if there is no robot, with `AccessDenied` for a wrong token.
 *
 * @param {string} [address] such as "ws://127.0.0.1:9090"
 * @param {ConnectOptions} [options]
 * @returns {Promise<Robot>}
 */
export async function connect(address = ownAddress(), {token, timeout = 10, WebSocket} = {}) {
  const url = urlOf(address);
  const headers = token ? {Authorization: `Bearer ${token}`} : {};
  const Socket = WebSocket ?? globalThis.WebSocket ?? (await fromPackage());
  const target = new URL(url);
  // A page cannot give a WebSocket a header.
  if (token && IN_A_PAGE) target.searchParams.set('token', token);
  const socket = IN_A_PAGE ? new Socket(target.href) : new Socket(target.href, {headers});
  const late = setTimeout(() => socket.close(), timeout * 1000);
  const opened = await new Promise((resolve) => {
    socket.onopen = () => resolve(true);
    socket.onerror = socket.onclose = () => resolve(false);
  });
  clearTimeout(late);
  if (!opened) throw await whyNot(url, headers, timeout);
  return withMethods(new RobotConnection(socket, timeout));
}

/** A connection to a robot, from the moment that it is open until it is lost. */
class RobotConnection {
  #socket;
  #number = 0;
  /** @type {Map<number, {resolve: (result: any) => void, reject: (error: Error) => void}>} */
  #waiting = new Map();
  /** @type {Map<string, Set<(data: any, kind: EventName) => void>>} */
  #listeners = new Map();
  #awaitsSign = false;
  #looked = performance.now();
  #timer;
  /** @type {(because: string) => void} */
  #end = () => {};

  /** Whether it stands, as far as is known. A lost one is not made again: `connect` anew. */
  connected = true;
  /**
   * Fulfilled with a sentence that says why, when the connection has ended.
   * @type {Promise<string>}
   */
  closed = new Promise((resolve) => (this.#end = resolve));

  /**
   * @param {WebSocket} socket that is open
   * @param {number} timeout seconds
   */
  constructor(socket, timeout) {
    this.#socket = socket;
    socket.onmessage = (message) => this.#receive(message.data);
    socket.onclose = (event) =>
      this.#lose(event.reason || 'The connection to the robot was lost. Connect again.');
    this.#timer = setInterval(() => this.#look(timeout * 1000), timeout * 1000);
  }

  /**
   * Call any method of the server, also one that methods.d.ts does not know.
   *
   * A call that is in flight when the connection is lost rejects with `LostConnection` and is never
   * sent again: the robot may have done it.
   *
   * @param {string} method such as "robot.goto"
   * @param {object} [params]
   * @param {CallOptions} [options]
   * @returns {Promise<any>} its result; rejects with a `RobotError`
   */
  request(method, params = {}, {signal} = {}) {
    if (!this.connected) {
      return Promise.reject(lost('There is no connection to the robot any more. Connect again.'));
    }
    if (signal?.aborted) {
      return Promise.reject(new RobotError('Stopped', 'It was cancelled before it began.'));
    }
    const id = (this.#number += 1);
    /** @type {Promise<any>} */
    const answer = new Promise((resolve, reject) => {
      const frame = written({jsonrpc: '2.0', id, method, params}, method);
      this.#waiting.set(id, {resolve, reject});
      this.#socket.send(frame);
    });
    if (!signal) return answer;
    const cancel = () => void this.request('rpc.cancel', {id}).catch(() => {});
    signal.addEventListener('abort', cancel);
    return answer.finally(() => signal.removeEventListener('abort', cancel));
  }

  /**
   * Be told of a kind of event, "*" for all. The server tells of some at once how it stands.
   *
   * @param {EventName | '*'} kind such as "speech"
   * @param {(data: any, kind: EventName) => void} listener
   * @returns {Promise<() => Promise<void>>} what ends it
   */
  async subscribe(kind, listener) {
    const listeners = this.#listeners.get(kind) ?? new Set();
    this.#listeners.set(kind, listeners.add(listener));
    const forget = () => {
      if (!listeners.delete(listener) || listeners.size) return false;
      return this.#listeners.delete(kind);
    };
    try {
      await this.request('rpc.subscribe', {events: [kind]});
    } catch (error) {
      forget();
      throw error;
    }
    return async () => {
      if (forget() && this.connected) await this.request('rpc.unsubscribe', {events: [kind]});
    };
  }

  /** Let go of the robot: what is in flight is rejected, and the server stops its motion. */
  close() {
    this.#lose('This connection to the robot was closed.');
  }

  /** @param {string} frame */
  #receive(frame) {
    this.#awaitsSign = false;
    const {id, method, params, result, error} = read(frame);
    if (method?.startsWith('event.')) {
      this.#tell(method.slice('event.'.length), params);
      return;
    }
    const waiting = this.#waiting.get(id);
    this.#waiting.delete(id);
    if (error) {
      waiting?.reject(new RobotError(error.data?.error ?? 'RobotError', error.message));
    } else {
      waiting?.resolve(result);
    }
  }

  /**
   * @param {EventName} kind
   * @param {any} data
   */
  #tell(kind, data) {
    const all = [...(this.#listeners.get(kind) ?? []), ...(this.#listeners.get('*') ?? [])];
    for (const listener of all) {
      try {
        listener(data, kind);
      } catch (error) {
        console.error(error); // one listener must not silence the others
      }
    }
  }

  /**
   * Ask for a sign of life. A network may go without a word, and a script is not told of the pings
   * that the server sends.
   * @param {number} pause milliseconds from one look to the next
   */
  #look(pause) {
    const now = performance.now();
    const slept = now - this.#looked > 1.5 * pause; // an answer may be there, unread
    this.#looked = now;
    if (this.#awaitsSign && !slept) {
      this.#lose('The robot does not answer any more. Connect again.');
      return;
    }
    this.#awaitsSign = true;
    this.request('rpc.subscribe', {events: []}).catch(() => {});
  }

  /** @param {string} because */
  #lose(because) {
    if (!this.connected) return;
    this.connected = false;
    clearInterval(this.#timer);
    this.#socket.onmessage = this.#socket.onclose = null;
    this.#socket.close();
    for (const {reject} of this.#waiting.values()) reject(lost(because));
    this.#waiting.clear();
    this.#end(because);
  }
}

/**
 * The connection, and in it the methods of the wire, each under its own name.
 * @param {RobotConnection} connection
 */
function withMethods(connection) {
  /** @param {string} method @returns {(params?: object, options?: CallOptions) => Promise<any>} */
  const call = (method) => (params, options) => connection.request(method, params, options);
  /** @param {string} group */
  const methods = (group) =>
    new Proxy({}, {get: (_, name) => (isWord(name) ? call(`${group}.${name}`) : undefined)});
  /** @type {ProxyHandler<RobotConnection>} */
  const handler = {
    get(own, name) {
      const value = Reflect.get(own, name, own);
      if (typeof value === 'function') return value.bind(own);
      return value === undefined && isWord(name) ? methods(name) : value;
    },
  };
  return /** @type {Robot} */ (new Proxy(connection, handler));
}

/**
 * What may be part of a method's name; "then" is what JavaScript looks for in everything awaited.
 * @param {string | symbol} name
 * @returns {name is string}
 */
function isWord(name) {
  return typeof name === 'string' && /^[a-z][a-z_]*$/.test(name) && name !== 'then';
}

/**
 * The frame of a request. JSON has no word for a number that is none, and would say nothing instead.
 * @param {object} content
 * @param {string} method
 */
function written(content, method) {
  const frame = JSON.stringify(content, (name, value) => {
    if (typeof value !== 'number' || Number.isFinite(value)) return value;
    throw new RobotError('InvalidCall', `${name} of ${method} must be a number; got ${value}.`);
  });
  if (new TextEncoder().encode(frame).length <= LONGEST_FRAME) return frame;
  throw new RobotError('InvalidCall', `What was given to ${method} is too long.`);
}

/**
 * What a frame says; nothing for what no robot says.
 * @param {string} frame
 */
function read(frame) {
  try {
    return JSON.parse(frame) ?? {};
  } catch {
    return {};
  }
}

/** @param {string} because */
function lost(because) {
  return new RobotError('LostConnection', because);
}

/** @param {string} address */
function urlOf(address) {
  const url = address.includes('://') ? address : `ws://${address}`;
  if (/^wss?:/.test(url) && URL.canParse(url)) return new URL(url);
  const sentence = `${address} is no address of a robot, which looks like ws://127.0.0.1:9090.`;
  throw new RobotError('InvalidCall', sentence);
}

function ownAddress() {
  if (!IN_A_PAGE) return 'ws://127.0.0.1:9090';
  return `${location.protocol === 'https:' ? 'wss:' : 'ws:'}//${location.host}`;
}

/** The WebSocket of the package `ws`, for a Node that has none of its own. */
async function fromPackage() {
  try {
    return (await import(/* webpackIgnore: true */ /* @vite-ignore */ 'ws')).WebSocket;
  } catch {
    throw lost('This Node has no WebSocket. Take Node 22 or newer, or: npm install ws');
  }
}

/**
 * Why no connection was opened: a WebSocket is not told, but the server tells whoever asks for a page.
 * @param {URL} url
 * @param {Record<string, string>} headers
 * @param {number} timeout seconds
 */
async function whyNot(url, headers, timeout) {
  const page = new URL(url.href.replace(/^ws/, 'http'));
  try {
    const answer = await fetch(page, {headers, signal: AbortSignal.timeout(timeout * 1000)});
    if ([401, 403, 426].includes(answer.status)) {
      return new RobotError('AccessDenied', (await answer.text()).trim());
    }
  } catch {
    // Nobody is there, or it is not for this page to know.
  }
  return lost(`There is no robot at ${url.host}. Is its server running, and the address right?`);
}
