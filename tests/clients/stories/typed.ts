// What compiles; the line below each mark must not.
import {connect, RobotError, type Robot} from 'nl2robot';

const ward: Robot = await connect('ws://127.0.0.1:9090', {token: 'secret'});
await ward.robot.goto({place: 'pharmacy'});
await ward.robot.goto({x: 1.5, y: 2, theta: null});
await ward.robot.stop();
await ward.robot.stop({who: 'Ann'});
const answer: string = await ward.robot.ask({question: 'Tea?', options: ['yes', 'no']});
const {program, status} = await ward.program.translate({utterance: 'say hello'});
if (status === 'ok' && program !== null) await ward.program.check({program});
const signal = AbortSignal.timeout(1000);
await ward.robot.battery({}, {signal});
const unsubscribe = await ward.subscribe('speech', ({text}) => console.log(text));
await unsubscribe();
await ward.request('visits.count', {people: 3});
try {
  await ward.robot.say({text: answer});
} catch (error) {
  if (error instanceof RobotError && error.name === 'Blocked') console.log(error.message);
}

// @ts-expect-error a parameter that is misspelt
await ward.robot.goto({plase: 'pharmacy'});
// @ts-expect-error a method that is misspelt
await ward.robot.gotto({place: 'pharmacy'});
// @ts-expect-error one of another kind
await ward.robot.set_volume({percent: 'loud'});
// @ts-expect-error one that is missing
await ward.robot.say({});
// @ts-expect-error two ways of calling it at a time
await ward.robot.goto({x: 1});
// @ts-expect-error what may be null, where it may not
await ward.program.check({program});
// @ts-expect-error an answer taken for something else
const many: number = await ward.robot.ask({question: 'Tea?'});
// @ts-expect-error an event that there is not
await ward.subscribe('speach', () => {});
// @ts-expect-error an error that there is not
console.log(new RobotError('Bloked', 'A bed.'), many);
// @ts-expect-error params of what takes none
await ward.rpc.discover({all: true});
