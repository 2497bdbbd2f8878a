/** The page of the appointments: the week, all of them, and whether this browser notifies. */

import {appears, element, filled, pageData} from '/static/page.js';
import {notice} from '/static/console.js';
import {notifies, notify} from '/static/notices.js';
import {wire} from '/static/wire.js';
import {Appointments} from '/static/schedule/appointments.js';
import {planCards} from '/static/fleet/plans.js';
import {showEvents} from '/static/schedule/events.js';
import {Reminders} from '/static/schedule/reminders.js';
import {showWeek} from '/static/schedule/week.js';
import {datesIn, dayAfter} from '/static/schedule/days.js';

const {words, language, role} = pageData;
const LOOKS_EVERY = 60_000;

const root = await appears('#schedule');
const week = element('section', {class: 'card week', 'aria-labelledby': 'week-title'});
const events = element('section', {class: 'card events', 'aria-labelledby': 'events-title', hidden: true});
const record = element('section', {class: 'card reminders', 'aria-labelledby': 'reminders-title', hidden: true});
const all = element('section', {'aria-labelledby': 'all-title'});
const others = element('section', {class: 'card of-fleet', 'aria-labelledby': 'of-fleet-title', hidden: true});
let day = null; // of the week that is shown; null: this one
let at = 0;

function weekHead() {
  const button = (text, act, more = {}) => {
    const made = element('button', {type: 'button', class: 'button small', ...more}, text);
    made.addEventListener('click', act);
    return made;
  };
  const title = element('h2', {id: 'week-title', 'aria-live': 'polite'}, words.week);
  const go = (days) => () => {
    day = dayAfter(shown.days[0], days);
    refresh();
  };
  const back = button('‹', go(-7), {'aria-label': words.before, title: words.before});
  const on = button('›', go(7), {'aria-label': words.after, title: words.after});
  const now = button(words.this_week, () => {
    day = null;
    refresh();
  });
  return {title, row: element('div', {class: 'row week-head'}, title, back, now, on)};
}

let shown = null;
let drawn = '';
let eventsDrawn = '';
const head = weekHead();
const body = element('div', {class: 'week-body'});
week.append(head.row, body);
const narrow = matchMedia('(max-width: 900px)');

function drawWeek() {
  if (!shown) return;
  const date = (written) =>
    new Date(`${written}T12:00Z`).toLocaleDateString(datesIn(language), {day: 'numeric', month: 'long', timeZone: 'UTC'});
  head.title.textContent = filled(words.week_of, {first: date(shown.days[0]), last: date(shown.days.at(-1))});
  showWeek(body, shown, {words, language, narrow: narrow.matches, known: appointments.known});
  root.dataset.week = shown.days[0];
}

function drawEvents(listed) {
  const happening = listed.filter(({appointment}) => appointment.trigger);
  const now = JSON.stringify(happening);
  if (now === eventsDrawn) return;
  eventsDrawn = now;
  showEvents(events, happening, {
    words,
    moment: (seconds) => appointments.moment(seconds),
    operates: role === 'operator',
    act: (number, act) => appointments.actOn(number, act),
  });
}

/** What other robots keep for the fleet: it is changed there. */
function drawOthers(kept) {
  const cards = planCards(kept.filter(({here}) => !here), {words, language});
  others.hidden = cards.length === 0;
  others.replaceChildren(element('h2', {id: 'of-fleet-title'}, words.of_fleet), element('ul', {class: 'plans'}, ...cards));
}

/** Fetch all of it anew, and draw what has changed. */
async function refresh() {
  const number = (at += 1);
  try {
    const [found, listed] = await Promise.all([
      wire.request('schedule.week', {language, ...(day ? {date: day} : {})}),
      wire.request('schedule.list', {language}),
    ]);
    if (number !== at) return;
    shown = found;
    appointments.show(listed, found);
    drawEvents(listed);
    const now = JSON.stringify([found, [...appointments.known]]);
    if (now !== drawn) drawWeek();
    drawn = now;
    await reminders.refresh(found.zone);
    if (pageData.fleet) drawOthers(await wire.request('fleet.plans', {language}));
    appointments.goToTheOneAsked(); // after the week above has its height
    root.dataset.ready = 'yes';
  } catch (error) {
    notice(error.message, {alarm: true});
  }
}

/** The button by which this browser may tell of notices by itself. */
function notifying() {
  const button = element('button', {type: 'button', class: 'button', id: 'notify'});
  const told = element('p', {class: 'muted', role: 'status'});
  const draw = (state) => {
    button.hidden = state === 'none' || state === 'denied';
    button.textContent = state === 'on' ? words.notify_off : words.notify_on;
    told.textContent = {none: words.notify_none, denied: words.notify_denied, on: words.notify_is_on}[state] ?? '';
  };
  button.addEventListener('click', async () => draw(await notify(notifies() !== 'on')));
  draw(notifies());
  return element('div', {class: 'row notifying'}, button, told);
}

const appointments = new Appointments(all, {wire, words, language, role, who: pageData.who, changed: refresh});
const reminders = new Reminders(record, {wire, words, language});
const looksOn = role === 'operator' ? [] : [element('p', {class: 'muted'}, words.looking_on)];
root.replaceChildren(notifying(), ...looksOn, events, week, all, others, record);
narrow.addEventListener('change', drawWeek);
wire.subscribe('schedule', refresh);
wire.subscribe('notice', refresh);
if (pageData.fleet) wire.subscribe('fleet.plans', refresh);
wire.onChange((connected) => connected && refresh());
setInterval(() => document.hidden || refresh(), LOOKS_EVERY);
