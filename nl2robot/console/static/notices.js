/** What somebody has to know who was not looking: on every page at once, and in the list behind the
 * bell until it was seen there. What was seen is kept in this browser. */

import {element, filled, timeOfDay} from '/static/page.js';

const SEEN = 'notices-seen';
const NOTIFIES = 'notify';
const STAYS_FOR = 20_000;
const SHOWN = 50;
/** Seconds: what a browser is told of that has never been here. */
const A_DAY = 24 * 3600;

/** Whether this browser can show notifications of its own: "none" | "denied" | "on" | "off". */
export function notifies() {
  if (!window.isSecureContext || !('Notification' in window)) return 'none';
  if (Notification.permission === 'denied') return 'denied';
  return Notification.permission === 'granted' && localStorage.getItem(NOTIFIES) === 'yes' ? 'on' : 'off';
}

/** Ask the person whether it may; resolves to what `notifies` says then. */
export async function notify(wanted) {
  if (wanted && Notification.permission === 'default') await Notification.requestPermission();
  localStorage.setItem(NOTIFIES, wanted ? 'yes' : 'no');
  return notifies();
}

export function mountNotices({wire, words, language, robot}) {
  const bell = document.getElementById('bell');
  const count = bell.querySelector('.count');
  const dialog = document.getElementById('notices');
  const list = dialog.querySelector('ul');
  let known = []; // the oldest first

  const seen = () => Number(localStorage.getItem(SEEN) ?? 0);
  const unseen = () => known.filter(({id}) => id > seen());

  function showCount() {
    const many = unseen().length;
    count.hidden = many === 0;
    count.textContent = many > 99 ? '99+' : many;
    bell.title = many ? filled(words.notices_new, {count: many}) : words.notices;
    bell.setAttribute('aria-label', bell.title);
  }

  function showList() {
    const news = new Set(unseen());
    const rows = known.toReversed().map((each) =>
      element(
        'li',
        {class: news.has(each) && 'unseen'},
        element('p', {}, each.told),
        element(
          'p',
          {class: 'muted'},
          when(each.time, language),
          ...(news.has(each) ? [' · ', element('strong', {}, words.notices_not_seen)] : []),
        ),
      ),
    );
    list.replaceChildren(...(rows.length ? rows : [element('li', {class: 'muted'}, words.notices_none)]));
  }

  async function fetchThem() {
    const found = await wire.request('schedule.notices', {last: SHOWN, language}).catch(() => null);
    if (!found) return;
    known = found.map(({notice, told}) => ({id: notice.id, time: notice.time, told}));
    const last = known.at(-1)?.id ?? 0;
    if (localStorage.getItem(SEEN) === null) {
      const old = known.filter(({time}) => time < Date.now() / 1000 - A_DAY);
      localStorage.setItem(SEEN, old.at(-1)?.id ?? 0);
    } else if (seen() > last) {
      localStorage.setItem(SEEN, 0); // another book, which begins anew
    }
    showCount();
  }

  bell.addEventListener('click', () => {
    showList();
    dialog.showModal();
    localStorage.setItem(SEEN, known.at(-1)?.id ?? seen());
    showCount();
  });
  dialog.addEventListener('click', (event) => event.target === dialog && dialog.close());
  addEventListener('storage', ({key}) => key === SEEN && showCount());
  wire.subscribe('notice', ({id, time, told}) => {
    const sentence = told[language] ?? told.en;
    toast(sentence, words);
    tellBrowser(sentence, id, {words, language, robot});
    if (id === null) return;
    known = [...known.filter((each) => each.id !== id), {id, time, told: sentence}].slice(-SHOWN);
    showCount();
  });
  // What was told while there was no connection is found, too.
  wire.onChange((connected) => connected && fetchThem());
}

function toast(sentence, words) {
  const close = element('button', {type: 'button', class: 'icon-button', 'aria-label': words.close}, '×');
  const shown = element(
    'div', {class: 'toast'},
    element('p', {}, sentence, ' ', element('a', {href: '/schedule'}, words.notices_all)),
    close,
  );
  close.addEventListener('click', () => shown.remove());
  document.getElementById('toasts').append(shown);
  const fade = () => (shown.matches(':hover, :focus-within') ? setTimeout(fade, STAYS_FOR) : shown.remove());
  setTimeout(fade, STAYS_FOR);
}

/** Several open pages tell it once: the tag is the same. `address`: the page to look at it. */
export function tellBrowser(sentence, id, {words, language, robot, address = '/schedule'}) {
  if (notifies() !== 'on') return;
  try {
    const tag = id === null ? 'nl2robot' : `nl2robot-${id}`;
    const told = new Notification(filled(words.notice_from_robot, {robot}), {body: sentence, tag, lang: language, icon: '/static/icon.svg'});
    told.addEventListener('click', () => {
      window.focus();
      location.assign(address);
    });
  } catch {
    // Browsers of phones have them for installed pages only; the toast says it.
  }
}

function when(seconds, language) {
  const day = new Date(seconds * 1000);
  const today = day.toDateString() === new Date().toDateString();
  return today
    ? timeOfDay(seconds, language)
    : day.toLocaleString(language, {dateStyle: 'medium', timeStyle: 'short'});
}
