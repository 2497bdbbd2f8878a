/**
 * STOP: the button of every page, Escape, and space where it types nothing.
 *
 * A dialog makes all that is below it unreachable, so each dialog that opens gets a STOP of its own,
 * in the same place and as the first thing in it: a stop never closes a dialog first.
 */

import {element} from '/static/page.js';

const PRESSED_FOR = 400;

/** Whether the space key means something where the focus is. */
function spaceIsTaken(target) {
  return target.closest?.(
    'input, textarea, select, button, a, summary, dialog[open], [contenteditable], [role=button],' +
      ' [role=slider], [role=tab], [role=option], [role=switch], [role=checkbox], [data-space]',
  );
}

/** Let the button, each dialog's own and the keys stop the robot; `stop` does it. */
export function mountStop(button, stop) {
  const press = ({currentTarget}) => {
    currentTarget.classList.add('pressed');
    setTimeout(() => currentTarget.classList.remove('pressed'), PRESSED_FOR);
    stop();
  };
  button.addEventListener('click', press);
  document.addEventListener(
    'keydown',
    (event) => {
      const escape = event.key === 'Escape';
      const space = event.key === ' ' && !spaceIsTaken(event.target);
      if (!(escape || space) || event.repeat) return;
      // An Escape that closes a window stops the robot as well: better once too often.
      if (space) event.preventDefault();
      stop();
    },
    {capture: true},
  );
  new MutationObserver((changes) => {
    for (const {target} of changes) if (target.matches('dialog')) cover(target, button, press);
  }).observe(document.documentElement, {subtree: true, attributes: true, attributeFilter: ['open']});
}

function cover(dialog, button, press) {
  const there = dialog.querySelector(':scope > .stop');
  if (!dialog.open || !dialog.matches(':modal')) {
    there?.remove();
    return;
  }
  if (there) return;
  const {top, left, width, height} = button.getBoundingClientRect();
  const above = element(
    'button',
    {type: 'button', class: 'stop above', title: button.title},
    button.textContent.trim(),
  );
  Object.assign(above.style, {top: `${top}px`, left: `${left}px`, width: `${width}px`, height: `${height}px`});
  above.addEventListener('click', press);
  dialog.prepend(above);
}
