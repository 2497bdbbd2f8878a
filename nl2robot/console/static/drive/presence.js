/** Telepresence: call, map and joystick in one window, and nothing else. */

import {element} from '/static/page.js';
import {button, panel} from './panel.js';
import {say} from './texts.js';

const KEPT = 'drive-view';

/** The pane of the call, and the button that shows this view or all controls again. */
export function presence(root) {
  const start = button(
    say('call_robot'),
    async () => document.dispatchEvent(new CustomEvent('call-robot')),
    {class: 'primary'},
  );
  const place = element('div', {class: 'presence-call'});
  const idle = element('div', {class: 'presence-idle'}, element('p', {}, say('presence_hint')), start);
  const pane = panel('presence', place, idle);
  const toggle = button('', async () => show(!root.classList.contains('presence')));

  const show = (on) => {
    root.classList.toggle('presence', on);
    document.documentElement.classList.toggle('with-presence', on);
    toggle.textContent = say(on ? 'all_controls' : 'presence_title');
    sessionStorage.setItem(KEPT, on ? 'presence' : '');
    // The call of every page, which lies in a corner elsewhere.
    const calls = document.getElementById('calls');
    (on ? place : document.body).append(calls);
    // A video that was taken out of the page and put back stands still.
    for (const video of calls.querySelectorAll('video')) video.play().catch(() => {});
  };
  const wanted = new URLSearchParams(location.search).get('view') ?? sessionStorage.getItem(KEPT);
  show(wanted === 'presence');
  return {pane, toggle};
}
