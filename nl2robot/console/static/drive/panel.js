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

/** A slider that shows its value; `send(value)` is called as it moves, one call after the other. */
export function slider({label, least, most, value, step = 1, unit = '', send}) {
  const input = element('input', {type: 'range', min: least, max: most, step, value});
  const shown = element('output', {class: 'value'});
  input.id = newId('slider');
  shown.htmlFor = input.id;
  const show = () => {
    shown.textContent = `${Math.round(input.value)}${unit}`;
    const part = (input.value - least) / (most - least || 1);
    input.style.setProperty('--part', `${part * 100}%`);
  };
  const put = latest(async () => doing(send(Number(input.value))));
  input.addEventListener('input', () => {
    show();
    put();
  });
  show();
  const row = element('div', {class: 'slider'});
  row.append(element('label', {for: input.id}, label), shown, input);
  return {
    row,
    input,
    /** Show a value, and send nothing. */
    show: (shownValue) => {
      input.value = shownValue;
      show();
    },
    /** Go to a value, as if it had been dragged there. */
    go: (wanted) => {
      input.value = wanted;
      show();
      put();
    },
  };
}

/** A function that does `task`, once more if it was asked to while it did. */
export function latest(task) {
  let busy = false;
  let again = false;
  return async () => {
    again = true;
    if (busy) return;
    busy = true;
    while (again) {
      again = false;
      await task();
    }
    busy = false;
  };
}
