/** Tablets and devices: pair one by a QR code, withdraw what somebody came in by. */

import {appears, element, filled, pageData} from '/static/page.js';
import {notice} from '/static/console.js';
import {wire} from '/static/wire.js';

const {words, language} = pageData;
const LOOKS_EVERY = 3000;
const HERE = /^(localhost|127\.|\[::1\])/;

/** A moment: the time, and the day as well if it is not today's. */
function moment(seconds) {
  const then = new Date(seconds * 1000);
  const today = then.toDateString() === new Date().toDateString();
  return then.toLocaleString(language, today ? {timeStyle: 'short'} : {dateStyle: 'short', timeStyle: 'short'});
}

function pairing(hereOnly) {
  const card = element('section', {class: 'card', 'aria-labelledby': 'pair'}, element('h2', {id: 'pair'}, words.pair));
  if (hereOnly) {
    card.append(element('p', {}, words.here_only));
    return card;
  }
  const role = element('select', {class: 'field', id: 'pair-role'});
  for (const each of ['face', 'observer', 'operator']) role.append(element('option', {value: each}, words[each]));
  const label = element('input', {
    class: 'field', id: 'pair-label', maxlength: 60, required: true, placeholder: words.label_hint,
  });
  const form = element(
    'form', {},
    element('label', {}, words.role, role),
    element('label', {}, words.label, label),
    element('button', {class: 'button primary'}, words.show_code),
  );
  const code = element('div', {class: 'code', role: 'status'});
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    const at = HERE.test(location.hostname) ? {} : {at: location.origin};
    const {devices} = await wire.request('devices.list');
    const known = new Set(devices.map(({id}) => id));
    try {
      const made = await wire.request('devices.pair', {role: role.value, label: label.value, ...at});
      waiting = {...made, role: role.value, label: label.value.trim(), code, known};
      code.replaceChildren(
        element('img', {src: made.picture, alt: words.code_alt}),
        element('p', {}, filled(words.code_told, {time: moment(made.ends)})),
        element('p', {class: 'muted'}, words.code_link, ' ', element('code', {}, made.link)),
        element('p', {class: 'muted'}, words.trust_hint),
      );
    } catch (error) {
      notice(error.message);
    }
  });
  card.append(element('p', {class: 'muted'}, words.pair_told), form, code);
  return card;
}

/** The code that is shown; it goes when a tablet has come in by it, or it is good for nothing any more. */
let waiting = null;

function lookAfterCode(devices) {
  if (!waiting) return;
  const came = devices.some(({id, role, label}) =>
    !waiting.known.has(id) && role === waiting.role && label === waiting.label);
  if (!came && Date.now() < waiting.ends * 1000) return;
  const told = came ? filled(words.came_in, waiting) : words.code_over;
  waiting.code.replaceChildren(element('p', {}, told));
  waiting = null;
}

function named(device) {
  if (device.link) return words[`${device.role}s_link`];
  return device.account ? filled(words.of, device) : device.label;
}

/** A link is made before anybody comes in by it. */
function lastUsed({made, used, link}) {
  return link && used === made ? words.not_yet : moment(used);
}

function row(device) {
  const paired = !device.account && device.made_by ? ` · ${filled(words.paired_by, {who: device.made_by})}` : '';
  const button = element(
    'button', {type: 'button', class: 'button small', 'aria-label': `${words.withdraw}: ${named(device)}`}, words.withdraw,
  );
  let sure = false;
  button.addEventListener('click', async () => {
    if (!sure) {
      sure = true;
      button.textContent = words.withdraw_sure;
      button.classList.add('danger');
      return;
    }
    try {
      await wire.request('devices.withdraw', {device: device.id});
      notice(words.withdrawn);
    } catch (error) {
      notice(error.message);
    }
    show();
  });
  return element(
    'li', {},
    element(
      'span', {},
      element('strong', {}, named(device)),
      element('span', {class: 'muted'}, `${words[`is_${device.role}`]}${paired} · ${words.used}: ${lastUsed(device)}`),
    ),
    button,
  );
}

function list(title, rows, ...more) {
  const items = rows.length ? element('ul', {}, ...rows) : element('p', {class: 'muted'}, words.nobody);
  return element('section', {class: 'card'}, element('h2', {}, title), ...more, items);
}

async function show() {
  const root = await appears('#devices');
  const {here_only: hereOnly, devices, failures, accounts} = await wire.request('devices.list');
  lookAfterCode(devices);
  const pair = root.querySelector('[aria-labelledby=pair]') ?? pairing(hereOnly);
  const cards = [pair, list(words.devices, devices.map(row))];
  if (accounts) {
    const people = accounts.map(({name, role}) =>
      element('li', {}, element('strong', {}, name), element('span', {class: 'muted'}, words[`is_${role}`])));
    cards.push(list(words.accounts, people, element('p', {class: 'muted'}, words.accounts_told)));
  }
  if (failures.length) {
    cards.push(list(words.failures, failures.map((each) =>
      element('li', {}, element('span', {}, filled(words.failure, each)), element('span', {class: 'muted'}, moment(each.time))))));
  }
  const known = JSON.stringify([devices, failures, accounts]);
  if (known === shown) return;
  shown = known;
  root.replaceChildren(...cards);
}

let shown = '';
show();
// Somebody comes in elsewhere; who is about to be withdrawn stays under one's finger.
setInterval(() => {
  if (!document.hidden && !document.querySelector('#devices li .danger')) show().catch(() => {});
}, LOOKS_EVERY);
