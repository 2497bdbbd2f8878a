/** The pages of past runs: searching while one types, a run that goes on kept up to date. */

import {appears, pageData} from '/static/page.js';
import {wire} from '/static/wire.js';
import {mountReplay} from '/static/past_runs_replay.js';

const TYPED = 250; // milliseconds without a key after which is searched
const OFTEN = 250; // milliseconds between two looks at a run that goes on

/** Calls `act` soon, and not more often than every so many milliseconds; never twice at a time. */
function atMost(often, act) {
  let wanted = false;
  let busy = false;
  return async function ask() {
    wanted = true;
    if (busy) return;
    busy = true;
    while (wanted) {
      wanted = false;
      await act();
      await new Promise((resolve) => setTimeout(resolve, often));
    }
    busy = false;
  };
}

async function fetched(address) {
  const response = await fetch(address, {headers: {Accept: '*/*'}});
  if (!response.ok) throw new Error(await response.text());
  return response;
}

// --- the list

function listPage(root) {
  const form = root.querySelector('form');
  const found = root.querySelector('[data-part=found]');
  let asked = 0;

  async function look(query) {
    const number = (asked += 1);
    let html;
    try {
      html = await (await fetched(`/runs/found${query}`)).text();
    } catch (error) {
      const told = document.createElement('p');
      told.className = 'card runs-trouble';
      told.role = 'alert';
      told.textContent = error.message;
      html = told.outerHTML;
    }
    if (number === asked) found.innerHTML = html; // else something newer was asked for meanwhile
  }

  function query() {
    const given = [...new FormData(form)].filter(([, value]) => value.trim());
    return given.length ? `?${new URLSearchParams(given)}` : '';
  }

  function search() {
    history.replaceState(null, '', `/runs${query()}`);
    return look(query());
  }

  let typing = 0;
  form.addEventListener('input', () => {
    clearTimeout(typing);
    typing = setTimeout(search, TYPED);
  });
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    clearTimeout(typing);
    search();
  });
  const again = atMost(OFTEN, () => look(location.search));
  wire.subscribe('program', (event) => {
    if (event.what === 'state') again();
  });
}

// --- one run

function runPage(root) {
  const number = Number(root.dataset.run);
  const part = (name) => root.querySelector(`[data-part=${name}]`);
  const replay = () => mountReplay(part('watch'), light, pageData.words);
  let watched = null; // the page came with it, but not as it is written here
  let state = root.dataset.state;

  function light(line) {
    for (const item of root.querySelectorAll('.run-program li[data-line]')) {
      item.classList.toggle('lit', Number(item.dataset.line) === line);
    }
  }

  const look = atMost(OFTEN, async () => {
    let parts;
    try {
      parts = await (await fetched(`/runs/${number}/parts.json`)).json();
    } catch {
      return; // it is asked again at the next event, or when the connection is there again
    }
    part('head').innerHTML = parts.head;
    part('calls').innerHTML = parts.calls;
    root.dataset.state = state = parts.state;
    light(parts.line);
    if (parts.watch !== watched) {
      part('watch').innerHTML = watched = parts.watch;
      replay();
    }
  });

  replay();
  wire.subscribe('program', (event) => {
    if (event.run !== number) return;
    if (event.what === 'line') light(event.line);
    else look();
  });
  let been = false;
  wire.onChange((connected) => {
    root.classList.toggle('stale', been && !connected && state === 'running');
    if (connected && state === 'running') look(); // what happened while there was no connection
    been ||= connected;
  });
}

const root = await appears('[data-runs], [data-run]');
if (root.hasAttribute('data-runs')) listPage(root);
else runPage(root);
