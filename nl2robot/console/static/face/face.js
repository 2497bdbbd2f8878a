/** The page on the robot's tablet: the face, what the robot shows and asks, STOP, the languages. */

import {mountCall} from '/static/face/call.js';
import {Buttons} from '/static/face/buttons.js';
import {Content} from '/static/face/content.js';
import {drawFace} from '/static/face/drawing.js';
import {element, filled, pageData, timeOfDay} from '/static/page.js';
import {playSpeech} from '/static/voice.js';
import {wire} from '/static/wire.js';

const SECONDS_A_LETTER = 0.06;
const SHORTEST_SPEECH = 0.6;
const CAPTION_STAYS = 3;
const LONG_CAPTION = 120;
const NOTICE_FOR = 6000;

const {languages, role} = pageData;
const at = Object.fromEntries(
  ['stop', 'alarm', 'notice', 'languages', 'fullscreen', 'figure', 'content', 'caption', 'buttons', 'call'].map((id) => [
    id,
    document.getElementById(id),
  ]),
);
const operates = role !== 'observer'; // the tablet on the robot is a face by its role

let state = pageData.state;
let early = [];
let mine = null; // the name of our connection
let words = pageData.words[state.language] ?? pageData.words.en;
let fading = 0;
let quiet = 0;
let untold = null; // what has become of the page, and is not told yet
let telling = false;

const face = drawFace(at.figure);
const content = new Content(at.content, {
  async answered(number, answer) {
    if (!operates) return notice(words.looks_on), false;
    try {
      if (!(await wire.request('face.touch', {number, answer}))) notice(words.too_late);
      return true;
    } catch (error) {
      notice(error.message);
      return false;
    }
  },
  paged(page, html) {
    untold = {page, html};
    if (!telling) tellPage();
  },
  site: () => wire.request('face.site'),
  stop,
});
const buttons = operates
  ? new Buttons(at.buttons, {
      wire,
      pressed: (counts) => notice(counts ? words.pressed : words.pressed_lately),
      failed: notice,
    })
  : null;
const calls = operates ? mountCall(at.call, {wire, words, role: 'face'}) : null;

/** Draw everything as the state has it. */
function show() {
  words = pageData.words[state.language] ?? pageData.words.en;
  const activity = state.asking ? 'listening' : state.mood;
  const look = face.look({emotion: state.emotion, activity});
  at.figure.setAttribute('aria-label', words[`look_${look}`]);
  // Around a question the words are those of the program, unless a visitor wants another language.
  const around = (!state.chosen && pageData.words[state.asking?.language]) || words;
  const asked = state.asking?.question;
  if (asked && at.caption.textContent.includes(asked)) at.caption.classList.add('quiet');
  const beside = content.show({
    screen: state.screen,
    asking: state.asking,
    words: around,
    language: around === words ? state.language : state.asking.language,
    mine: mine !== null && state.screen.by === mine,
  });
  document.body.dataset.robot = state.robot;
  document.body.dataset.view = beside ? 'content' : 'face';
  showLanguage();
  showAlarm();
}

/** What stays there as long as it is so: the robot may move, or cannot be reached. */
function showAlarm() {
  const {lost, unconfirmed} = state;
  const since = lost ? filled(words.robot_lost, {time: timeOfDay(lost, state.language)}) : '';
  const halted = {pausing: words.pausing, paused: words.paused}[state.robot] ?? '';
  at.alarm.textContent = since || (unconfirmed ? words.unconfirmed : halted);
  at.alarm.classList.toggle('calm', !since && !unconfirmed);
  at.alarm.hidden = !at.alarm.textContent;
}

function showLanguage() {
  document.documentElement.lang = state.language;
  document.title = words.title;
  at.stop.textContent = words.stop;
  at.languages.setAttribute('aria-label', words.languages);
  at.buttons.setAttribute('aria-label', words.buttons);
  at.fullscreen.setAttribute('aria-label', words.fullscreen);
  for (const button of at.languages.children) {
    button.setAttribute('aria-pressed', button.dataset.code === state.language);
  }
  calls?.speak(words);
}

/** The robot says something: the mouth moves, and the words can be read. */
function speak({text}) {
  const seconds = Math.max(SHORTEST_SPEECH, text.length * SECONDS_A_LETTER);
  face.speak(seconds);
  at.caption.textContent = text;
  at.caption.classList.toggle('long', text.length > LONG_CAPTION);
  at.caption.classList.remove('quiet');
  clearTimeout(quiet);
  quiet = setTimeout(hush, (seconds + CAPTION_STAYS) * 1000);
}

/** What was said is no longer there, for anybody. */
function hush() {
  at.caption.classList.add('quiet');
  at.caption.textContent = '';
}

function apply(change) {
  if (change.version <= state.version) return;
  const wasLost = state.lost;
  state = {...state, ...change};
  if (change.speech) speak(change.speech);
  if (change.asking) face.speak(0);
  if (change.stopped || change.unconfirmed || change.lost) {
    face.speak(0);
    hush();
  }
  if (change.stopped) notice(words.stopped);
  if (wasLost && !state.lost) notice(words.robot_found);
  show();
}

function notice(sentence, stays = false) {
  at.notice.textContent = sentence;
  at.notice.hidden = false;
  clearTimeout(fading);
  if (stays) return;
  fading = setTimeout(() => {
    at.notice.hidden = true;
    at.notice.textContent = '';
  }, NOTICE_FOR);
}

async function stop() {
  at.stop.classList.add('pressed');
  setTimeout(() => at.stop.classList.remove('pressed'), 400);
  try {
    await wire.request('robot.stop');
  } catch (error) {
    if (error.kind !== 'StopNotConfirmed') notice(words.not_stopped, true);
  }
}

/** Tell what people have made of the page: one thing after the other, and only the newest. */
async function tellPage() {
  telling = true;
  while (untold) {
    const newest = untold;
    untold = null;
    await wire.request('face.page', newest).catch(() => {});
  }
  telling = false;
}

/** Tell that somebody can see this face, and find out what it is to show. */
async function here() {
  early ??= [];
  const visible = document.visibilityState === 'visible';
  try {
    const now = operates ? await wire.request('face.here', {visible}) : await wire.request('face.state');
    mine = now.name ?? null;
    if (now.version >= state.version) state = now;
    const changes = early ?? [];
    early = null;
    for (const change of changes) apply(change);
    await buttons?.fetch();
    show();
    document.body.dataset.ready = 'yes';
  } catch (error) {
    notice(error.message);
  }
}

function onConnection(connected) {
  document.body.classList.toggle('lost', !connected && mine !== null);
  if (connected) {
    at.notice.hidden = true;
    here();
    keepAwake();
  } else if (mine !== null) {
    early = [];
    state.version = 0; // the server may be another then, which counts from the beginning
    face.speak(0);
    notice(words.lost, true);
  }
}

/** A tablet on a robot must not fall asleep. */
async function keepAwake() {
  if (document.visibilityState !== 'visible') return;
  await navigator.wakeLock?.request('screen').catch(() => {});
}

for (const [code, name] of Object.entries(languages)) {
  const button = element('button', {type: 'button', 'data-code': code, lang: code, title: name}, code);
  button.setAttribute('aria-label', name);
  button.addEventListener('click', () => {
    if (!operates) return notice(words.looks_on);
    wire.request('face.language', {code}).catch((error) => notice(error.message));
  });
  at.languages.append(button);
}
at.stop.addEventListener('click', stop);
addEventListener('keydown', (event) => {
  if (event.key === 'Escape' && !event.repeat) stop();
});
at.fullscreen.hidden = !document.fullscreenEnabled;
at.fullscreen.addEventListener('click', () => {
  if (document.fullscreenElement) document.exitFullscreen();
  else document.documentElement.requestFullscreen();
});
// A web page of others tells nothing; that somebody is in it shows in the focus.
addEventListener('blur', () => {
  const inside = document.activeElement?.closest?.('.site iframe');
  if (operates && inside && wire.connected) wire.request('face.used').catch(() => {});
});
document.addEventListener('visibilitychange', () => {
  if (wire.connected) here();
  keepAwake();
});

playSpeech(wire, {
  onLevel: (level) => face.sound(level),
  onBlocked(blocked) {
    if (blocked) notice(words.touch_to_hear, true);
    else at.notice.hidden = true;
  },
});
wire.subscribe('face', (change) => (early ? early.push(change) : apply(change)));
wire.subscribe('face.act', async (order) => {
  const html = await content.act(order);
  wire.request('face.did', {number: order.number, html}).catch(() => {});
});
show();
wire.onChange(onConnection);
