/** What the robot's camera sees, while somebody wants to see it. */

import {element} from '/static/page.js';
import {button, panel} from './panel.js';
import {say} from './texts.js';

const OLD_AFTER = 2000;
const TRY_AGAIN_AFTER = 1000;

export function cameraPanel() {
  const picture = element('img', {class: 'camera-picture', alt: say('camera_sees'), hidden: true});
  const told = element('p', {class: 'muted', role: 'status'});
  const frame = element('div', {class: 'camera-frame'}, picture);
  let looking = null;
  const stop = () => {
    looking?.abort();
    looking = null;
    picture.hidden = true;
    told.textContent = '';
    toggle.textContent = say('camera_on');
    toggle.setAttribute('aria-pressed', 'false');
  };
  const start = () => {
    looking = new AbortController();
    toggle.textContent = say('camera_off');
    toggle.setAttribute('aria-pressed', 'true');
    look(picture, frame, told, looking.signal);
  };
  const toggle = button(say('camera_on'), async () => (looking ? stop() : start()), {
    'aria-pressed': 'false',
  });
  window.addEventListener('pagehide', stop);
  return panel('camera', element('div', {class: 'row'}, toggle), frame, told);
}

/** Show one picture after the other, and say so when the one that is shown is old. */
async function look(picture, frame, told, signal) {
  let number = 0;
  let came = performance.now();
  while (!signal.aborted) {
    try {
      if (document.hidden) {
        await seen(signal);
        continue;
      }
      const answer = await fetch(`/camera?after=${number}`, {signal});
      if (answer.status === 200) {
        number = Number(answer.headers.get('Picture'));
        await shown(picture, await answer.blob());
        came = performance.now();
      } else if (!answer.ok) {
        await pause(TRY_AGAIN_AFTER);
      }
    } catch {
      await pause(TRY_AGAIN_AFTER); // the server is gone, or the picture is none
    }
    if (signal.aborted) return;
    const old = performance.now() - came > OLD_AFTER;
    frame.classList.toggle('old', old);
    told.textContent = old ? say('camera_old') : '';
  }
}

async function shown(picture, blob) {
  const before = picture.src;
  picture.src = URL.createObjectURL(blob);
  if (before) URL.revokeObjectURL(before);
  await picture.decode();
  picture.hidden = false;
}

/** Until the page is looked at again. */
function seen(signal) {
  return new Promise((resume) => {
    document.addEventListener('visibilitychange', resume, {once: true});
    signal.addEventListener('abort', resume, {once: true});
  });
}

const pause = (milliseconds) => new Promise((resume) => setTimeout(resume, milliseconds));
