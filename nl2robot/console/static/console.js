/** What every page of the console does: STOP, the sign of the connection, the settings. */

import {element, filled, keep, timeOfDay} from '/static/page.js';
import {wire} from '/static/wire.js';

const {words, role, who, language, call, microphone} = JSON.parse(document.getElementById('frame-data').textContent);
const NOTICE_FOR = 6000;
const SLOW_STOP = 300;

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
  const button = document.getElementById('stop');
  button?.classList.add('pressed');
  setTimeout(() => button?.classList.remove('pressed'), 400);
  const waiting = setTimeout(() => notice(words.stopping), SLOW_STOP);
  try {
    await wire.request('robot.stop');
    document.dispatchEvent(new CustomEvent('robot-stopped'));
    notice(words.stopped);
  } catch (error) {
    // What is not confirmed is said to everybody, by `showStop`.
    if (error.kind === 'StopNotConfirmed') document.getElementById('notice').hidden = true;
    else notice(words.not_stopped, {alarm: true});
  } finally {
    clearTimeout(waiting);
  }
}

/** Whether the space key means something where the focus is. */
function spaceIsTaken(target) {
  return target.closest?.(
    'input, textarea, select, button, a, summary, dialog[open], [contenteditable], [role=button],' +
      ' [role=slider], [role=tab], [role=option], [role=switch], [role=checkbox], [data-space]',
  );
}

function onKey(event) {
  const escape = event.key === 'Escape';
  const space = event.key === ' ' && !spaceIsTaken(event.target);
  if (!(escape || space) || event.repeat) return;
  // An Escape that closes a window stops the robot as well: better once too often.
  if (space) event.preventDefault();
  stop();
}

/** What stays at the top of the page as long as it is so: the robot may move, or is lost. */
const alarms = {lost: '', unconfirmed: ''};

function showAlarms() {
  const told = document.getElementById('robot-state');
  told.replaceChildren(
    ...Object.values(alarms)
      .filter(Boolean)
      .map((sentence) => element('span', {}, sentence)),
  );
  told.hidden = !told.hasChildNodes();
  showSign();
}

function showStop(sentence) {
  alarms.unconfirmed = sentence;
  showAlarms();
}

function showLink({state, since}) {
  const was = alarms.lost;
  alarms.lost = state === 'lost' ? filled(words.robot_lost, {time: timeOfDay(since, language)}) : '';
  showAlarms();
  if (was && !alarms.lost) notice(words.robot_found);
}

/** The dot in the header: green while page, server and robot are connected. */
function showSign() {
  const sign = document.getElementById('connection');
  if (sign.dataset.state === 'waiting') return;
  const lost = !wire.connected ? words.lost : alarms.lost;
  sign.dataset.state = lost ? 'lost' : 'connected';
  sign.title = sign.firstElementChild.textContent = lost || words.connected;
}

function showConnection(connected) {
  const sign = document.getElementById('connection');
  if (!connected && sign.dataset.state === 'waiting') return;
  if (!connected) notice(words.lost, {alarm: true});
  else if (sign.dataset.state === 'lost') document.getElementById('notice').hidden = true;
  sign.dataset.state = connected ? 'connected' : 'lost';
  // The server tells anew how the robot is; it may have been started anew itself.
  if (connected) Object.assign(alarms, {lost: '', unconfirmed: ''});
  showAlarms();
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

document.getElementById('stop').addEventListener('click', stop);
document.getElementById('settings-button').addEventListener('click', openSettings);
document.getElementById('settings').addEventListener('click', (event) => {
  if (event.target === event.currentTarget) event.target.close();
});
document.addEventListener('keydown', onKey, {capture: true});
wire.onChange(showConnection);
wire.subscribe('link', showLink);
wire.subscribe('stopping', () => showStop(''));
wire.subscribe('stopped', () => showStop(''));
wire.subscribe('stop_not_confirmed', () => showStop(words.unconfirmed));
if (role === 'operator') {
  openCalls();
  const button = document.getElementById('frame-microphone');
  if (button) openMicrophone(button);
}
