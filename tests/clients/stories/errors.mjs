// What goes wrong has a name and a sentence.
import assert from 'node:assert/strict';
import {connect, RobotError} from 'nl2robot';

const ward = await connect(process.env.ROBOT);
await assert.rejects(ward.robot.goto({place: 'swimming pool'}), (error) => {
  assert(error instanceof RobotError);
  assert.equal(error.name, 'UnknownPlace');
  assert.match(error.message, /^I know no place called 'swimming pool'\./);
  return true;
});
await assert.rejects(ward.robot.gotto({place: 'ward a'}), {name: 'InvalidCall', message: /goto/});
await assert.rejects(ward.robot.goto({plase: 'ward a'}), {name: 'InvalidCall'});
// JSON has no word for what is no number; the robot must not take it for a null.
await assert.rejects(ward.robot.move({metres: NaN}), {
  name: 'InvalidCall',
  message: 'metres of robot.move must be a number; got NaN.',
});
await assert.rejects(ward.robot.wait({seconds: 10n}), TypeError);
// Not even to be sent: the server would let go of everything that this connection does.
const long = 'é'.repeat(150_000);
await assert.rejects(ward.program.check({program: long}), {name: 'InvalidCall', message: /too long/});
await assert.rejects(ward.subscribe('poze', () => {}), {name: 'InvalidCall', message: /pose/});

// One listener that fails silences no other.
const heard = [];
const complain = console.error;
const complaints = [];
console.error = (error) => complaints.push(error.message);
await ward.subscribe('speech', () => {
  throw new Error('a fault in the page');
});
await ward.subscribe('*', (data, kind) => heard.push(kind));
await ward.robot.say({text: 'Hello'});
console.error = complain;
assert(heard.includes('speech'));
assert.deepEqual(complaints, ['a fault in the page']);

ward.close();
await assert.rejects(ward.robot.say({text: 'Hello'}), {name: 'LostConnection'});
await assert.rejects(connect('127.0.0.1:1'), {
  name: 'LostConnection',
  message: /^There is no robot at 127\.0\.0\.1:1\./,
});
await assert.rejects(connect('https://127.0.0.1:1'), {name: 'InvalidCall', message: /ws:/});
