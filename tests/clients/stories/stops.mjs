// A stop overtakes what is in flight, and a call can be cancelled alone.
import assert from 'node:assert/strict';
import {connect} from 'nl2robot';

const ward = await connect(process.env.ROBOT);
const inTime = [];
for (let time = 0; time < 5; time += 1) {
  const waiting = ward.robot.wait({seconds: 600});
  const driving = ward.robot.goto({place: time % 2 ? 'lobby' : 'pharmacy'});
  const ended = Promise.allSettled([waiting, driving]);
  await ward.robot.battery(); // which is answered while both are in flight
  const asked = performance.now();
  await ward.robot.stop({who: 'Ann'});
  inTime.push(performance.now() - asked);
  for (const {status, reason} of await ended) {
    assert.equal(status, 'rejected');
    assert.equal(reason.name, 'Stopped');
    assert.match(reason.message, /Ann/);
  }
}
console.log(`A stop took ${inTime.map((each) => each.toFixed(1)).join(', ')} ms.`);
assert(Math.min(...inTime) < 50, `${inTime} ms`);

const changed = new AbortController();
const cancelled = ward.robot.wait({seconds: 600}, {signal: changed.signal});
const goesOn = ward.robot.wait({seconds: 0.2});
changed.abort();
await assert.rejects(cancelled, {name: 'Stopped'});
await goesOn;
await assert.rejects(ward.robot.wait({seconds: 1}, {signal: changed.signal}), {name: 'Stopped'});
ward.close();
