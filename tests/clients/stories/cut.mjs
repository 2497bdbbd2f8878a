// The network goes in the middle of a call: once with a word, once without.
import assert from 'node:assert/strict';
import net from 'node:net';
import {connect} from 'nl2robot';

const {hostname, port} = new URL(process.env.ROBOT);
const cables = new Set();
const wall = net.createServer((near) => {
  const far = net.connect(Number(port), hostname);
  near.pipe(far).pipe(near);
  for (const end of [near, far]) {
    cables.add(end);
    end.on('error', () => {});
  }
});
await new Promise((resolve) => wall.listen(0, '127.0.0.1', resolve));
const throughTheWall = `ws://127.0.0.1:${wall.address().port}`;

const witness = await connect(process.env.ROBOT);
const told = [];
await witness.subscribe('speech', ({text}) => told.push(text));

const ward = await connect(throughTheWall);
const waiting = ward.robot.wait({seconds: 600});
await ward.robot.say({text: 'Before'});
for (const end of cables) end.destroy();
cables.clear();
await assert.rejects(waiting, {name: 'LostConnection', message: /was lost/});
assert.match(await ward.closed, /Connect again/);
await assert.rejects(ward.robot.say({text: 'Never'}), {name: 'LostConnection'});

const again = await connect(throughTheWall);
await again.robot.say({text: 'After'});
assert.deepEqual(told, ['Before', 'After']);
again.close();

const silent = await connect(throughTheWall, {timeout: 0.5});
const hoping = silent.robot.wait({seconds: 600});
await silent.robot.battery();
for (const end of cables) end.unpipe().pause();
await assert.rejects(hoping, {name: 'LostConnection', message: /does not answer any more/});
for (const end of cables) end.destroy();

// Who answers is left alone, however long nothing happens.
const patient = await connect(process.env.ROBOT, {timeout: 0.2});
await patient.robot.wait({seconds: 1});
assert(patient.connected);
patient.close();
witness.close();
wall.close();
