// From another computer one shows a token, over an encrypted connection.
import assert from 'node:assert/strict';
import {connect} from 'nl2robot';

const {ROBOT, TOKEN} = process.env;
await assert.rejects(connect(ROBOT, {token: `${TOKEN}x`}), {
  name: 'AccessDenied',
  message: /token is missing or wrong/,
});
await assert.rejects(connect(ROBOT), {name: 'AccessDenied'});
const ward = await connect(ROBOT, {token: TOKEN});
assert((await ward.robot.places()).includes('pharmacy'));
ward.close();
