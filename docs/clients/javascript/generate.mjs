/**
 * The types of the client, made from an OpenRPC document by json-schema-to-typescript.
 *
 *   node generate.mjs < openrpc.json > methods.d.ts
 *
 * The document is turned into one JSON Schema, a table of groups, methods, params and results, for
 * that is what the tool reads; the types are the tool's.
 */

import {readFileSync} from 'node:fs';
import {compile} from 'json-schema-to-typescript';

const BANNER = `\
/**
 * What can be called on the wire, made by \`make client\` from what \`rpc.discover\` answers; not to be
 * edited. A robot has those of the methods of \`robot\` that it can do.
 */`;

const TAIL = `
export interface CallOptions {
  /** Cancels this call: the robot stops doing it, and it ends with \`Stopped\`. */
  signal?: AbortSignal;
}

type Method<Row> = Row extends {params: infer Params; result: infer Result}
  ? {} extends Params
    ? (params?: Params, options?: CallOptions) => Promise<Result>
    : (params: Params, options?: CallOptions) => Promise<Result>
  : never;

/** A function for each of them: \`robot.goto({place})\` calls "robot.goto". */
export type Api = {
  [Group in keyof Methods]: {[Name in keyof Methods[Group]]: Method<Methods[Group][Name]>};
};
`;

const STYLE = {singleQuote: true, bracketSpacing: false, printWidth: 100};

const described = JSON.parse(readFileSync(0, 'utf-8'));

/** An object with exactly these properties. */
function whole(properties, description) {
  const required = Object.keys(properties);
  return {type: 'object', properties, required, additionalProperties: false, description};
}

/** Without what would make a type of its own, with a number behind its name, of a part. */
function untitled(schema) {
  if (Array.isArray(schema)) return schema.map(untitled);
  if (typeof schema !== 'object' || schema === null) return schema;
  const {title, ...rest} = schema;
  const kept = typeof title === 'object' ? schema : rest; // a property that is called so
  // An object of which nothing more is said may have anything in it.
  if (schema.type === 'object' && !schema.properties) kept.additionalProperties ??= true;
  return Object.fromEntries(Object.entries(kept).map(([name, part]) => [name, untitled(part)]));
}

function paramsOf(method) {
  if (method.params.length === 0) return {tsType: 'Record<string, never>'};
  const properties = Object.fromEntries(method.params.map((each) => [each.name, each.schema]));
  const required = method.params.filter((each) => each.required).map((each) => each.name);
  const together = {type: 'object', properties, required, additionalProperties: false};
  return untitled(method['x-params-schema'] ?? together);
}

function methods() {
  const groups = {};
  for (const method of described.methods) {
    const [group, name] = method.name.split('.');
    const row = {params: paramsOf(method), result: untitled(method.result.schema)};
    (groups[group] ??= {})[name] = whole(row, method.summary);
  }
  for (const [group, rows] of Object.entries(groups)) groups[group] = whole(rows);
  return whole(groups);
}

async function typed(name, schema, bannerComment = '') {
  const how = {additionalProperties: false, ignoreMinAndMaxItems: true, unknownAny: true};
  const text = await compile(schema, name, {...how, bannerComment, style: STYLE});
  // a short comment on one line
  return text.replace(/\/\*\*\n\s*\* ([^\n]{1,80})\n\s*\*\//g, '/** $1 */');
}

const errors = {enum: Object.keys(described.components.errors)};
const events = Object.fromEntries(
  Object.entries(described['x-events']).map(([name, data]) => [
    name.replace(/^event\./, ''),
    {tsType: 'any', description: data},
  ]),
);
process.stdout.write(
  [
    await typed('Methods', methods(), BANNER),
    await typed('ErrorName', errors),
    await typed('Events', whole(events)),
    `/** Bytes. */\nexport type LongestFrame = ${described['x-longest-frame']};\n`,
    '/** The kinds of events that can be subscribed to. */\nexport type EventName = keyof Events;\n',
  ].join('\n') + TAIL,
);
