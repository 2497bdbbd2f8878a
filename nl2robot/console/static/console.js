/** What every page of the console does: STOP, the sign of the connection, the settings. */

import '/static/focus.js';
import {element, filled, keep, timeOfDay} from '/static/page.js';
import {mountNotices} from '/static/notices.js';
import {mountProposals} from '/static/proposals.js';
import {present} from '/static/state.js';
import {mountStop} from '/static/stop.js';
import {wire} from '/static/wire.js';

const {words, role, who, name, robot, language, call, microphone} = JSON.parse(document.getElementById('frame-data').textContent);
const NOTICE_FOR = 6000;
const SLOW_STOP = 300;
const TONES = {
  ...{running: 'good', pausing: 'warn', paused: 'warn', stopping: 'bad', stopped: 'warn', lost: 'bad'},
  ...{reviewing: 'accent', charging: '', idle: ''},
};

let fading = 0;

/** Say something at the top of the page; what is an alarm stays. `action` {text, act}: a button. */
export function notice(sentence, {alarm = false, action = null} = {}) {
  const told = document.getElementById('notice');
  told.replaceChildren(sentence);
  if (action) {
    const button = element('button', {type: 'button', class: 'button small'}, action.text);
    button.addEventListener('click', action.act);
    told.append(' ', button);
  }
  told.classList.toggle('alarm', alarm);
  told.hidden = false;
  clearTimeout(fading);
  if (!alarm) fading = setTimeout(() => (told.hidden = true), NOTICE_FOR);
}

/** Stop the robot and whatever program runs. */
export async function stop() {
  const waiting = setTimeout(() => notice(words.stopping), SLOW_STOP);
  try {
    await wire.request('robot.stop', name ? {who: name} : {});
    notice(words.stopped);
  } catch (error) {
    // What is not confirmed is said to everybody, by `showState`.
    if (error.kind === 'StopNotConfirmed') document.getElementById('notice').hidden = true;
    else notice(words.not_stopped, {alarm: true});
  } finally {
    clearTimeout(waiting);
  }
}

/** What the header says of the robot, and what stays below it as long as it is so: the robot may
 * move, or is lost. */
function showState(now, before) {
  const {state, unconfirmed, lost_since: lost} = now;
  const alarms = [
    lost ? filled(words.robot_lost, {time: timeOfDay(lost, language)}) : '',
    unconfirmed ? words.unconfirmed : '',
  ].filter(Boolean);
  const told = document.getElementById('robot-state');
  if (alarms.join() !== [...told.children].map((each) => each.textContent).join()) {
    told.replaceChildren(...alarms.map((sentence) => element('span', {}, sentence)));
  }
  told.hidden = !alarms.length;
  if (before.lost_since && !lost) notice(words.robot_found);
  const badge = document.getElementById('robot-badge');
  const byHand = now.driven_by && ['idle', 'charging'].includes(state);
  badge.hidden = false;
  badge.dataset.state = state;
  badge.className = `chip ${byHand ? TONES.running : (TONES[state] ?? '')}`;
  badge.title = byHand ? filled(words.driven_by, {who: now.driven_by}) : '';
  const text = words[`state_${byHand ? 'driven' : state}`];
  if (badge.textContent !== text) badge.textContent = text; // or it would be read out again
  document.documentElement.dataset.robot = state;
  showSign();
}

/** The dot in the header: green while page, server and robot are connected. */
function showSign() {
  const sign = document.getElementById('connection');
  if (sign.dataset.state === 'waiting') return;
  const robotLost = present.now.lost_since;
  const lost = !wire.connected
    ? words.lost
    : robotLost && filled(words.robot_lost, {time: timeOfDay(robotLost, language)});
  sign.dataset.state = lost ? 'lost' : 'connected';
  sign.title = sign.firstElementChild.textContent = lost || words.connected;
}

function showConnection(connected) {
  const sign = document.getElementById('connection');
  if (!connected && sign.dataset.state === 'waiting') return;
  if (!connected) notice(words.lost, {alarm: true});
  else if (sign.dataset.state === 'lost') document.getElementById('notice').hidden = true;
  sign.dataset.state = connected ? 'connected' : 'lost';
  // What was so when the connection was lost need not be so any more.
  document.getElementById('robot-badge').classList.toggle('stale', !connected);
  showSign();
}

function openSettings() {
  const dialog = document.getElementById('settings');
  const before = ['language', 'look', 'who'].map((id) => document.getElementById(id).value);
  dialog.showModal();
  dialog.addEventListener(
    'close',
    () => {
      const after = ['language', 'look', 'who'].map((id) => document.getElementById(id).value);
      if (after.every((value, index) => value === before[index])) return;
      keep('language', after[0]);
      keep('look', after[1]);
      keep('who', after[2].trim());
      location.reload();
    },
    {once: true},
  );
}

/** Calls of the robot ring on every page; a page starts one with the event "call-robot". */
async function openCalls() {
  const {mountCall} = await import('/static/face/call.js');
  const calls = mountCall(document.getElementById('calls'), {wire, words: call, role, who});
  document.addEventListener('call-robot', () => calls.start());
}

/** Off the desk, too, one can say "stop"; another command is taken to the desk. */
async function openMicrophone(button) {
  const {mountMicrophone} = await import('/static/microphone.js');
  const heard = ({text}) =>
    notice(filled(words.heard, {text}), {action: {text: words.to_desk, act: () => toDesk(text)}});
  const mounted = mountMicrophone(button, {
    wire,
    words: microphone,
    language: () => language,
    onPartial: (text) => text && notice(text),
    onHeard: heard,
    onThinking: ({text}) => {
      mounted.giveUp(); // the desk thinks about it, where that is seen
      heard({text});
    },
    onTrouble: (sentence) => notice(sentence),
  });
}

function toDesk(text) {
  sessionStorage.setItem('say', text);
  location.assign('/');
}

mountStop(document.getElementById('stop'), stop);
document.getElementById('settings-button').addEventListener('click', openSettings);
document.getElementById('settings').addEventListener('click', (event) => {
  if (event.target === event.currentTarget) event.target.close();
});
mountNotices({wire, words, language, robot});
wire.onChange(showConnection);
present.onChange(showState);
if (role === 'operator') {
  mountProposals(document.getElementById('proposals'), {wire, words, language, robot});
  openCalls();
  const button = document.getElementById('frame-microphone');
  if (button) openMicrophone(button);
}
