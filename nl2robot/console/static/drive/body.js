/** What the robot's body does: speaking, looks, gestures, joints. */

import {element} from '/static/page.js';
import {wire} from '/static/wire.js';
import {face} from './faces.js';
import {helm} from './helm.js';
import {button, controls, doing, labelled, panel, slider} from './panel.js';
import {robot} from './robot.js';
import {named, say} from './texts.js';

const MOST_SAID = 30;

// --- speaking

export function sayPanel(body, language) {
  const text = element('textarea', {class: 'field', rows: 2, maxlength: 2000});
  const spoken = element('select', {class: 'field'});
  const names = new Intl.DisplayNames([language], {type: 'language'});
  for (const code of body.languages) {
    spoken.append(element('option', {value: code}, names.of(code) ?? code));
  }
  spoken.value = body.languages.includes(language) ? language : (body.now.language ?? 'en');
  const saidBefore = [];
  let back = 0;
  const speak = async (words, code) => {
    if (!words.trim()) return;
    await helm.call('say', {text: words, language: code});
  };
  const speakField = async () => {
    const words = text.value.trim();
    if (!words) return;
    if (saidBefore.at(-1) !== words) saidBefore.push(words);
    back = 0;
    text.value = '';
    await speak(words, spoken.value);
  };
  const go = button(say('say'), speakField, {class: 'primary'});
  text.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && !event.shiftKey) {
      event.preventDefault();
      go.click();
      return;
    }
    // What was said before, as in the conversation, where there is nothing to move through.
    const step = {ArrowUp: 1, ArrowDown: -1}[event.key];
    if (!step || text.value.includes('\n')) return;
    event.preventDefault();
    back = Math.max(0, Math.min(saidBefore.length, back + step));
    text.value = back ? saidBefore.at(-back) : '';
  });
  const inside = [labelled(say('say_what'), text)];
  inside.push(
    element('div', {class: 'row say-row'}, labelled(say('language'), spoken), go),
  );
  if (body.methods.includes('set_volume')) inside.push(volume());
  if (body.methods.includes('set_language')) inside.push(ownLanguage(body, names));
  return panel('say', controls(...inside), said(speak));
}

function volume() {
  const made = slider({
    label: say('volume'),
    least: 0,
    most: 100,
    step: 5,
    unit: ' %',
    send: (wanted) => helm.call('set_volume', {percent: wanted()}),
  });
  robot.follow('volume', made.tell);
  return made.row;
}

/** What the robot speaks and hears where nobody says otherwise. */
function ownLanguage(body, names) {
  const chosen = element('select', {class: 'field'});
  const unknown = element('option', {value: '', disabled: true}, say('unknown'));
  chosen.append(unknown);
  for (const code of body.languages) {
    chosen.append(element('option', {value: code}, names.of(code) ?? code));
  }
  let known = null;
  const show = () => {
    chosen.value = known ?? '';
    unknown.hidden = known !== null;
  };
  robot.follow('language', (code) => {
    known = code;
    show();
  });
  chosen.addEventListener('change', async () => {
    await doing(helm.call('set_language', {code: chosen.value}), chosen);
    show();
  });
  return labelled(say('own_language'), chosen);
}

/** What the robot said, whoever told it to; a click says it again. */
function said(speak) {
  const list = element('ol', {class: 'said', 'aria-label': say('said')});
  const none = element('p', {class: 'muted'}, say('said_nothing'));
  wire.subscribe('speech', ({text, language}) => {
    none.hidden = true;
    const again = button('↻', () => speak(text, language), {class: 'small quiet again'});
    again.setAttribute('aria-label', say('say_again', {text}));
    again.title = say('again');
    const words = element('span', {lang: language}, text);
    list.prepend(element('li', {}, words, controls(again)));
    while (list.children.length > MOST_SAID) list.lastElementChild.remove();
  });
  return element('div', {class: 'said-box'}, element('h3', {}, say('said')), none, list);
}

// --- looks

export function facePanel(body) {
  const emotions = body.emotions.map((name) => [name, emotionButton(name)]);
  const now = element('div', {class: 'face-now', role: 'status'});
  const show = (shown) => {
    now.innerHTML = face(shown ?? '?');
    now.append(element('span', {}, shown === null ? say('unknown') : named('emotion', shown)));
    for (const [name, made] of emotions) made.setAttribute('aria-pressed', String(name === shown));
  };
  robot.follow('emotion', show);
  const grid = element('div', {class: 'faces'}, ...emotions.map(([, made]) => made));
  return panel('face', now, controls(grid));
}

function emotionButton(name) {
  const made = button('', () => helm.call('emotion', {name}), {class: 'emotion'});
  made.dataset.emotion = name;
  made.innerHTML = face(name);
  made.append(element('span', {}, named('emotion', name)));
  return made;
}

// --- gestures and the robot's own skills

export function gesturePanel(body) {
  const gestures = body.gestures.map((name) =>
    button(named('gesture', name), () => helm.call('gesture', {name}), {class: 'small'}),
  );
  const inside = [element('div', {class: 'row'}, ...gestures)];
  const skills = Object.entries(body.skills).map(([skill, what]) =>
    button(skill, () => helm.call('do', {skill}), {class: 'small', title: what}),
  );
  if (skills.length) {
    inside.push(element('h3', {}, say('skills')), element('div', {class: 'row'}, ...skills));
  }
  return panel('gesture', controls(...inside));
}

// --- joints

export function jointPanel(body) {
  // A body makes one movement at a time: one joint after the other, each to its newest angle.
  let last = Promise.resolve();
  const move = (name, wanted) => {
    const moved = last.then(() => helm.call('joint', {name, degrees: wanted()}));
    last = moved.catch(() => {});
    return moved;
  };
  const joints = Object.entries(body.joints).map(([name, [least, most]]) => [
    name,
    slider({
      label: named('joint', name),
      least,
      most,
      unit: '°',
      send: (wanted) => move(name, wanted),
    }),
  ]);
  const told = {};
  robot.follow('joints', (known) => {
    for (const [name, made] of joints) {
      const degrees = known?.[name] ?? null;
      if (degrees !== told[name]) made.tell(degrees);
      told[name] = degrees;
    }
  });
  const sliders = joints.map(([, made]) => made);
  const level = button(
    say('level'),
    () => sliders.forEach((each) => each.go(Math.max(each.input.min, Math.min(each.input.max, 0)))),
    {class: 'small'},
  );
  return panel('joints', controls(...sliders.map((each) => each.row), level));
}
