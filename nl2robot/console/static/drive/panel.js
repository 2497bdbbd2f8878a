/** What the panels of the page are made of. */

import {notice} from '/static/console.js';
import {element} from '/static/page.js';
import {helm} from './helm.js';
import {say} from './texts.js';

let ids = 0;

/** An id that no other element has. */
export function newId(what) {
  ids += 1;
  return `${what}-${ids}`;
}

/** A titled card; `controls` go into it where only who drives can use them. */
export function panel(name, ...inside) {
  const id = newId('title');
  return element(
    'section',
    {class: `card panel panel-${name}`, 'aria-labelledby': id},
    element('h2', {id}, say(`${name}_title`)),
    ...inside,
  );
}

/** Controls that only whoever drives can use; observers do not see them. */
export function controls(...inside) {
  const fieldset = element('fieldset', {class: 'controls'}, ...inside);
  helm.onChange(() => (fieldset.disabled = !helm.moves));
  return fieldset;
}

/** A button that does something and shows that it does; what goes wrong is told. */
export function button(text, act, attributes = {}) {
  const made = element('button', {type: 'button', ...attributes}, text);
  made.classList.add('button');
  made.addEventListener('click', () => doing(act(), made));
  return made;
}

/** Wait for it, `shown` marked as busy; resolves to its result, or to undefined if it failed. */
export async function doing(promise, shown = null) {
  shown?.setAttribute('aria-busy', 'true');
  try {
    return await promise;
  } catch (error) {
    if (error.kind !== 'Stopped') notice(error.message);
    return undefined;
  } finally {
    shown?.removeAttribute('aria-busy');
  }
}

/** A field with its label above it. */
export function labelled(text, field) {
  field.id ||= newId('field');
  return element('div', {class: 'labelled'}, element('label', {for: field.id}, text), field);
}

/**
 * A slider that shows how something of the robot is. `send(wanted)` is called as it is moved, one
 * call after the other; `wanted()` tells where it is then. Until that is done it shows both, and
 * then what the robot says: where that refuses, the slider goes back.
 */
export function slider({label, least, most, step = 1, unit = '', send}) {
  const input = element('input', {type: 'range', min: least, max: most, step});
  const shown = element('output', {class: 'value'});
  input.id = newId('slider');
  shown.htmlFor = input.id;
  let known = null; // what the robot says of itself
  let heard = 0; // how often it has said something
  let wanting = false;
  const told = (value) => (value === null ? '?' : `${Math.round(value)}${unit}`);
  const show = () => {
    const wanted = Number(input.value);
    const both = wanting && wanted !== known;
    shown.textContent = both ? `${told(known)} → ${told(wanted)}` : told(known);
    const part = (wanted - least) / (most - least || 1);
    input.style.setProperty('--part', `${part * 100}%`);
    input.classList.toggle('unknown', known === null && !wanting);
    const spoken = known === null ? say('unknown') : told(known);
    input.setAttribute('aria-valuetext', both ? told(wanted) : spoken);
  };
  const settle = () => {
    input.value = known ?? (least + most) / 2;
    show();
  };
  const put = latest(async () => {
    const before = heard;
    let reached = null;
    const done = await doing(
      send(() => (reached = Number(input.value))).then(() => true),
    );
    // A robot that says nothing of it has done it all the same.
    if (done && heard === before) known = reached;
  });
  const want = async () => {
    wanting = true;
    show();
    await put();
    if (put.busy) return;
    wanting = false;
    settle();
  };
  input.addEventListener('input', want);
  settle();
  const row = element('div', {class: 'slider'});
  row.append(element('label', {for: input.id}, label), shown, input);
  return {
    row,
    input,
    /** The robot says that it is so; null: it has not said. */
    tell: (value) => {
      known = value;
      heard += 1;
      if (wanting) show();
      else settle();
    },
    /** Go to a value, as if it had been dragged there. */
    go: (wanted) => {
      input.value = wanted;
      want();
    },
  };
}

/** A function that does `task`, once more if it was asked to while it did; it is `busy` meanwhile. */
export function latest(task) {
  let again = false;
  const run = async () => {
    again = true;
    if (run.busy) return;
    run.busy = true;
    while (again) {
      again = false;
      await task();
    }
    run.busy = false;
  };
  run.busy = false;
  return run;
}
