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
import type { Api, CallOptions, ErrorName, EventName } from './methods.js';
export type ConnectOptions = {
    /**
     * what a server that asks for one was given, or a person's or device's own
     */
    token?: string;
    /**
     * seconds that the server may be silent before the connection counts as
     * lost, and that it may take to be made; 10 if left out
     */
    timeout?: number;
    /**
     * the class to connect with; if left out the one that is there, and in an
     * older Node that of the package `ws`
     */
    WebSocket?: any;
};
export type Robot = RobotConnection & Api;
/** What went wrong, in a sentence; `name` is its name on the wire, such as "Blocked". */
export declare class RobotError extends Error {
    /** @type {ErrorName} */
    name: ErrorName;
    /**
     * @param {ErrorName} name
     * @param {string} sentence
     */
    constructor(name: ErrorName, sentence: string);
}
/**
 * Connect to a robot's server. In a page that the server itself shows, the address may be left out.
 * Rejects with `LostConnection` if there is no robot, with `AccessDenied` for a wrong token.
 *
 * @param {string} [address] such as "ws://127.0.0.1:9090"
 * @param {ConnectOptions} [options]
 * @returns {Promise<Robot>}
 */
export declare function connect(address?: string, { token, timeout, WebSocket }?: ConnectOptions): Promise<Robot>;
/** A connection to a robot, from the moment that it is open until it is lost. */
declare class RobotConnection {
    #private;
    /** Whether it stands, as far as is known. A lost one is not made again: `connect` anew. */
    connected: boolean;
    /**
     * Fulfilled with a sentence that says why, when the connection has ended.
     * @type {Promise<string>}
     */
    closed: Promise<string>;
    /**
     * @param {WebSocket} socket that is open
     * @param {number} timeout seconds
     */
    constructor(socket: WebSocket, timeout: number);
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
    request(method: string, params?: object, { signal }?: CallOptions): Promise<any>;
    /**
     * Be told of a kind of event, "*" for all. The server tells of some at once how it stands.
     *
     * @param {EventName | '*'} kind such as "speech"
     * @param {(data: any, kind: EventName) => void} listener
     * @returns {Promise<() => Promise<void>>} what ends it
     */
    subscribe(kind: EventName | '*', listener: (data: any, kind: EventName) => void): Promise<() => Promise<void>>;
    /** Let go of the robot: what is in flight is rejected, and the server stops its motion. */
    close(): void;
}
export {};
