/** What every page of the console does: STOP, the sign of the connection, the settings. */

import {element, filled, keep} from '/static/page.js';
import {wire} from '/static/wire.js';

const {words, role, who, language, call, microphone} = JSON.parse(document.getElementById('frame-data').textContent);
const NOTICE_FOR = 6000;

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
  try {
    await wire.request('robot.stop');
    document.dispatchEvent(new CustomEvent('robot-stopped'));
    notice(words.stopped);
  } catch {
    notice(words.not_stopped, {alarm: true});
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

function showConnection(connected) {
  const sign = document.getElementById('connection');
  if (!connected && sign.dataset.state === 'waiting') return;
  if (!connected) notice(words.lost, {alarm: true});
  else if (sign.dataset.state === 'lost') document.getElementById('notice').hidden = true;
  sign.dataset.state = connected ? 'connected' : 'lost';
  sign.title = sign.firstElementChild.textContent = connected ? words.connected : words.lost;
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
if (role === 'operator') {
  openCalls();
  const button = document.getElementById('frame-microphone');
  if (button) openMicrophone(button);
}
