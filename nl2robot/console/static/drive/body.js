/** What the robot's body does: speaking, looks, gestures, joints. */

import {element} from '/static/page.js';
import {wire} from '/static/wire.js';
import {face} from './faces.js';
import {helm} from './helm.js';
import {button, controls, doing, labelled, panel, slider} from './panel.js';
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
  if (body.methods.includes('set_volume')) inside.push(volume(body).row);
  return panel('say', controls(...inside), said(speak));
}

function volume(body) {
  return slider({
    label: say('volume'),
    least: 0,
    most: 100,
    step: 5,
    value: body.now.volume ?? 70,
    unit: ' %',
    send: (percent) => helm.call('set_volume', {percent}),
  });
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
    now.innerHTML = face(shown);
    now.append(element('span', {}, named('emotion', shown)));
    for (const [name, made] of emotions) made.setAttribute('aria-pressed', String(name === shown));
  };
  show(body.now.emotion?.name ?? body.emotions[0]);
  wire.subscribe('emotion', ({name}) => show(name));
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
  const wanted = new Map();
  let busy = false;
  // A body makes one movement at a time: the newest angle of each joint, one joint after the other.
  const move = async () => {
    if (busy) return;
    busy = true;
    while (wanted.size) {
      const [name, degrees] = wanted.entries().next().value;
      wanted.delete(name);
      await doing(helm.call('joint', {name, degrees}));
    }
    busy = false;
  };
  const sliders = Object.entries(body.joints).map(([name, [least, most]]) =>
    slider({
      label: named('joint', name),
      least,
      most,
      value: body.now.joints?.[name] ?? Math.max(least, Math.min(most, 0)),
      unit: '°',
      send: (degrees) => {
        wanted.set(name, degrees);
        return move();
      },
    }),
  );
  const level = button(
    say('level'),
    () => sliders.forEach((each) => each.go(Math.max(each.input.min, Math.min(each.input.max, 0)))),
    {class: 'small'},
  );
  return panel('joints', controls(...sliders.map((each) => each.row), level));
}
