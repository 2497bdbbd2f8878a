/** STOP on a page of trouble: a button of its own, for nothing else of the page may be there. */

import {wire} from '/static/wire.js';

const button = document.getElementById('stop');
const told = document.getElementById('told');

async function stop() {
  try {
    await wire.request('robot.stop');
    told.textContent = button.dataset.stopped;
  } catch (error) {
    told.textContent = error.kind === 'StopNotConfirmed' ? button.dataset.unconfirmed : button.dataset.failed;
  }
  told.hidden = false;
}

button.addEventListener('click', stop);
document.addEventListener('keydown', (event) => event.key === 'Escape' && !event.repeat && stop());
