/** A week of times: a table of days and hours, or on a narrow screen a list by day. */

import {element, filled} from '/static/page.js';
import {datesIn} from '/static/schedule/days.js';

/** Hours that are always shown. */
const FROM = 7;
const TO = 19;
const FEW = 3;
const PAST = new Set(['done', 'failed', 'missed', 'skipped', 'asked']);
const TONES = {
  ...{done: 'good', failed: 'bad', missed: 'bad', asked: 'warn', unapproved: 'warn', due: 'warn'},
  ...{running: 'accent', claimed: 'accent'},
};
const LEFT_OUT = new Set(['off', 'skipped', 'paused']);

/** `known`: the numbers of the appointments that there still are. */
export function showWeek(root, week, {words, language, narrow, known}) {
  const about = {words, language, known};
  const shown = narrow ? [days(week, about)] : [table(week, about)];
  if (!week.times.length) shown.unshift(element('p', {class: 'muted'}, words.nothing_this_week));
  if (week.more) shown.push(element('p', {class: 'muted'}, words.more));
  root.replaceChildren(...shown);
}

function table(week, about) {
  const {words, language} = about;
  const hours = week.times.map(({at}) => Number(at.slice(0, 2)));
  const first = Math.min(FROM, ...hours);
  const last = Math.max(TO, ...hours);
  const names = week.days.map((day) =>
    element(
      'th', {scope: 'col', class: day === week.today && 'today', 'aria-current': day === week.today && 'date'},
      dayName(day, language, 'short'),
      ...(day === week.today ? [element('span', {class: 'sr'}, ` (${words.today})`)] : []),
    ));
  const body = element('tbody');
  for (let hour = first; hour <= last; hour++) {
    const name = `${String(hour).padStart(2, '0')}:00`;
    const row = element('tr', {}, element('th', {scope: 'row'}, name));
    for (const day of week.days) {
      const now = day === week.today && Number(week.at.slice(0, 2)) === hour;
      const cell = element('td', {class: day === week.today && 'today'});
      const there = week.times.filter((each) => each.day === day && Number(each.at.slice(0, 2)) === hour);
      cell.append(...together(there).map((several) => card(several, about)));
      if (now) cell.append(nowLine(week, words));
      row.append(cell);
    }
    body.append(row);
  }
  const head = element('thead', {}, element('tr', {}, element('td', {}, element('span', {class: 'sr'}, words.hour)), ...names));
  return element('table', {class: 'week-table'}, head, body);
}

/** The line at the present time, as far down as the hour has gone. */
function nowLine(week, words) {
  const line = element('div', {class: 'now'}, element('span', {class: 'sr'}, filled(words.now, {time: week.at})));
  line.style.top = `${(Number(week.at.slice(3)) / 60) * 100}%`;
  return line;
}

function days(week, about) {
  const {words, language} = about;
  return element('div', {class: 'week-days'}, ...week.days.map((day) => {
    const today = day === week.today;
    const there = week.times.filter((each) => each.day === day);
    const items = together(there).map((several) => ({at: several[0].at, item: element('li', {}, card(several, about))}));
    if (today) {
      const line = element('li', {class: 'now'}, element('span', {}, filled(words.now, {time: week.at})));
      const place = items.findIndex(({at}) => at > week.at);
      items.splice(place < 0 ? items.length : place, 0, {at: week.at, item: line});
    }
    const title = element('h3', {class: today && 'today'}, dayName(day, language, 'long'), ...(today ? [` · ${words.today}`] : []));
    const nothing = items.length ? [] : [element('p', {class: 'muted'}, words.nothing_then)];
    return element('section', {}, title, ...nothing, element('ul', {}, ...items.map(({item}) => item)));
  }));
}

/** Times of the same appointment that stand as the others do, on one card. */
function together(times) {
  const cards = new Map();
  for (const each of times) {
    const key = JSON.stringify([each.appointment, each.told, PAST.has(each.state) ? each.run : null]);
    cards.set(key, [...(cards.get(key) ?? []), each]);
  }
  return [...cards.values()];
}

function card(several, {words, known}) {
  const [{appointment, sentence, when, state, told, run}] = several;
  const times = several.map(({at}) => at);
  const clock = times.length > FEW
    ? `${times[0]} – ${times.at(-1)} (${filled(words.many, {count: times.length})})`
    : times.join(', ');
  const name = element(LEFT_OUT.has(state) ? 's' : 'span', {class: 'sentence'}, sentence);
  return element(
    'article', {class: `time ${TONES[state] ?? ''}${LEFT_OUT.has(state) ? ' left-out' : ''}`, 'data-state': state, title: when},
    element('time', {}, clock),
    known.has(appointment) ? element('a', {href: `#appointment-${appointment}`}, name) : name,
    element('span', {class: 'rhythm'}, when),
    ...(state === 'coming' ? [] : [element('span', {class: 'state'}, told)]),
    ...(run === null ? [] : [element('a', {class: 'run', href: `/runs/${run}`}, filled(words.run, {run}))]),
  );
}

function dayName(day, language, length) {
  const format = {weekday: length, day: 'numeric', month: length, timeZone: 'UTC'};
  return new Date(`${day}T12:00Z`).toLocaleDateString(datesIn(language), format);
}
