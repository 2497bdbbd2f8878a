// From a sentence to a robot that has done it.
import assert from 'node:assert/strict';
import {connect} from 'nl2robot';

const ward = await connect(process.env.ROBOT);
const said = [];
const states = [];
await ward.subscribe('speech', ({text}) => said.push(text));
const unsubscribe = await ward.subscribe('program', ({what, state}) => {
  if (what === 'state') states.push(state);
});

const {status, program} = await ward.program.translate({
  utterance: 'go to ward a and say good night',
});
assert.equal(status, 'ok');
const {sha256, findings, dry_run} = await ward.program.check({program});
assert.deepEqual(findings, []);
assert.deepEqual(dry_run.says, ['Good night.']);
const {id} = await ward.program.approve({program, sha256, by: 'Ann'});
const run = await ward.program.run({approval: id});
const {state, calls} = await ward.program.wait({run});
assert.equal(state, 'done');
assert.equal(calls, 2);
assert.deepEqual(said, ['Good night.']);
assert.equal(states.at(-1), 'done');
const [answer] = await ward.program.answer({run});
assert.equal(answer.text, 'I said “Good night.” here: ward a.');

// What nobody listens to any more is told no more; what the table of types does not know is there.
await unsubscribe();
const heardSoFar = states.length;
const again = await ward.program.approve({program, sha256, by: 'Ann'});
const second = await ward.request('program.run', {approval: again.id});
await ward.program.wait({run: second});
assert.equal(states.length, heardSoFar);
assert.deepEqual(said, ['Good night.', 'Good night.']);

ward.close();
assert.equal(await ward.closed, 'This connection to the robot was closed.');
assert.equal(ward.connected, false);
