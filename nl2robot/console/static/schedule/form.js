/** Asks at what times, or at what event, a reviewed program is to be done, and has it approved for that. */

import {element, filled} from '/static/page.js';
import {datesIn, dayAfter, endOf} from '/static/schedule/days.js';
import {EVENTS, EventFields} from '/static/schedule/event_fields.js';

const HOLDS = 30; // days
const KINDS = ['once', 'daily', 'weekdays', 'chosen', 'passing'];
const WEEKDAYS = ['MO', 'TU', 'WE', 'TH', 'FR', 'SA', 'SU'];
const A_MONDAY = '2026-11-30';
const PRIORITIES = {first: 7, in_turn: 5, last: 3};
const MAKES_UP = [30, 60, 120, 720]; // minutes
const LONGEST_SENTENCE = 2000;
const OF_ANYBODY = ['message', 'pressed', 'scanned'].map((kind) => `event-${kind}`).join(' '); // else it is about the robot itself
const OF_EVENTS = ['said', ...EVENTS].map((kind) => `event-${kind}`).join(' ');

/**
 * Resolves to {appointment, when} once there is an appointment, to null if nobody wanted one.
 * `what`: program, sha256, sentence, insists, and times {when, rhythm} or {when, trigger} if some were said.
 */
export async function askForTimes({wire, words, language, who, what}) {
  const [{zone, today, at}, named, fleet] = await Promise.all([
    wire.request('schedule.week', {language}),
    wire.request('places.list').catch(() => []), // a robot whose places nobody knows
    wire.request('fleet.list').then(() => true).catch(() => false), // one that has joined none
  ]);
  const places = named.map(({name}) => name);
  const asked = new Form({wire, words, language, who, what, zone, today, at, places, fleet});
  document.body.append(asked.dialog);
  asked.dialog.showModal();
  asked.form.querySelector('select, input').focus();
  return new Promise((resolve) => {
    asked.dialog.addEventListener('close', () => {
      asked.dialog.remove();
      resolve(asked.planned);
    });
  });
}

class Form {
  constructor(about) {
    Object.assign(this, about);
    this.planned = null;
    this.seen = new Set([...document.querySelectorAll('.desk-review .mark')].map((mark) => mark.textContent.trim()));
    this.confirmed = '';
    this.dialog = element('dialog', {class: 'times-form', 'aria-label': this.words.form_title});
    this.form = element('form', {});
    this.trouble = element('p', {role: 'alert', class: 'wrong', hidden: true});
    this.build();
    this.dialog.append(this.form);
    this.form.addEventListener('change', () => this.showFields());
    this.form.addEventListener('submit', (event) => {
      event.preventDefault();
      this.approve();
    });
    this.showFields();
  }

  build() {
    const {words, what, today, at, places} = this;
    const said = what.times;
    const modes = ['times', 'event'].map((mode) => element('option', {value: mode}, words[`form_mode_${mode}`]));
    this.mode = element('select', {class: 'field', name: 'mode'}, ...modes);
    if (said?.trigger) this.mode.value = 'event';
    this.event = new EventFields({words, places, said: said?.trigger ? said : null});
    const kinds = KINDS.map((kind) => element('option', {value: kind}, words[`form_${kind}`]));
    if (said?.rhythm) kinds.unshift(element('option', {value: 'said'}, filled(words.form_said, said)));
    this.kind = element('select', {class: 'field', name: 'kind'}, ...kinds);
    if (!said?.rhythm) this.kind.value = 'daily';
    const hour = String((Number(at.slice(0, 2)) + 1) % 24).padStart(2, '0');
    const day = hour === '00' ? dayAfter(today, 1) : today;
    const date = (value) => element('input', {type: 'date', class: 'field', value, min: today, required: true});
    const time = (value) => element('input', {type: 'time', class: 'field', value, required: true});
    Object.assign(this, {day: date(day), time: time(`${hour}:00`), from: time('08:00'), to: time('17:00')});
    this.minutes = element('input', {type: 'number', class: 'field', min: 5, max: 720, value: 30, required: true});
    this.days = WEEKDAYS.map((day, index) => element('input', {type: 'checkbox', value: day, 'aria-label': this.dayName(index, 'long')}));
    this.until = date(dayAfter(today, HOLDS));
    this.until.max = dayAfter(today, 365);
    this.sentence = element('input', {class: 'field', value: what.sentence, required: true, maxlength: LONGEST_SENTENCE});
    const within = MAKES_UP.map((each) => {
      const long = each < 120 ? filled(words.form_minutes_long, {number: each}) : filled(words.form_hours_long, {number: each / 60});
      return element('option', {value: each}, filled(words.form_within, {time: long}));
    });
    this.missed = element('select', {class: 'field'}, element('option', {value: 0}, words.form_leave), ...within);
    const turns = Object.entries(PRIORITIES).map(([name, value]) => element('option', {value}, words[`form_${name}`]));
    this.priority = element('select', {class: 'field'}, ...turns);
    this.priority.value = PRIORITIES.in_turn;
    this.robot = element('select', {class: 'field', name: 'robot'}, ...['this', 'any'].map((each) => element('option', {value: each}, words[`form_robot_${each}`])));
    this.button = element('button', {type: 'submit', class: 'button primary'}, words.form_approve);
    const cancel = element('button', {type: 'button', class: 'button'}, words.form_cancel);
    cancel.addEventListener('click', () => this.dialog.close());
    const label = (text, field, kind = '') => element('label', {'data-for': kind}, text, field);
    const boxes = this.days.map((box, index) => element('label', {}, box, this.dayName(index, 'short')));
    const ofTimes = ['said', ...KINDS].join(' ');
    this.missedLabel = element('span', {});
    this.title = element('h2', {});
    this.what_for = element('p', {class: 'muted'});
    this.form.append(
      this.title,
      this.what_for,
      label(words.form_begins, this.mode),
      ...this.event.labels(),
      label(words.form_when, this.kind, ofTimes),
      label(words.form_day, this.day, 'once'),
      element('fieldset', {'data-for': 'chosen'}, element('legend', {}, words.form_days), element('div', {class: 'row'}, ...boxes)),
      label(words.form_time, this.time, 'once daily weekdays chosen'),
      label(words.form_minutes, this.minutes, 'passing'),
      element('div', {class: 'from-to', 'data-for': 'passing'}, label(words.form_from, this.from), label(words.form_to, this.to)),
      label(words.form_until, this.until, `said daily weekdays chosen passing ${OF_EVENTS}`),
      label(this.missedLabel, this.missed),
      label(words.form_priority, this.priority),
      ...(this.fleet ? [label(words.form_robot, this.robot, `${ofTimes} ${OF_ANYBODY}`)] : []),
      element('label', {}, words.form_sentence, this.sentence, element('small', {class: 'muted'}, words.form_sentence_hint)),
      this.trouble,
      element('div', {class: 'row'}, this.button, cancel),
    );
  }

  dayName(index, weekday) {
    return new Date(`${dayAfter(A_MONDAY, index)}T12:00Z`).toLocaleDateString(datesIn(this.language), {weekday, timeZone: 'UTC'});
  }

  /** Only what is asked of this kind of times is there, and has to be filled in. */
  showFields() {
    const {words} = this;
    const event = this.mode.value === 'event';
    const chosen = event ? `event-${this.event.what.value}` : this.kind.value;
    this.title.textContent = event ? words.form_title_event : words.form_title;
    this.dialog.setAttribute('aria-label', this.title.textContent);
    this.what_for.textContent = event ? words.form_told_event : words.form_told;
    this.button.textContent = event ? words.form_approve_event : words.form_approve;
    this.missedLabel.textContent = event ? words.form_waits : words.form_missed;
    this.missed.options[0].textContent = event ? words.form_leave_soon : words.form_leave;
    for (const part of this.form.querySelectorAll('[data-for]')) {
      const kinds = part.dataset.for.split(' ').filter(Boolean);
      part.hidden = kinds.length > 0 && !kinds.includes(chosen);
    }
    for (const field of this.form.querySelectorAll('[data-for] :is(input, select)')) field.disabled = field.closest('[hidden]') !== null;
  }

  tell(sentence, ...more) {
    this.trouble.replaceChildren(sentence, ...more);
    this.trouble.hidden = false;
    this.trouble.scrollIntoView({block: 'nearest'});
  }

  /** The rhythm that was chosen; null, with a word on it, if it is none. */
  rhythm() {
    const {zone, today, what, words} = this;
    const kind = this.kind.value;
    const begins = `${today}T${this.time.value}`;
    if (kind === 'said') return what.times.rhythm;
    if (kind === 'once') return {begins: `${this.day.value}T${this.time.value}`, zone, rule: null};
    if (kind === 'daily') return {begins, zone, rule: 'FREQ=DAILY'};
    if (kind === 'weekdays') return {begins, zone, rule: 'FREQ=WEEKLY;BYDAY=MO,TU,WE,TH,FR'};
    if (kind === 'chosen') {
      const days = this.days.filter((box) => box.checked).map((box) => box.value);
      if (days.length) return {begins, zone, rule: `FREQ=WEEKLY;BYDAY=${days}`};
      this.tell(words.form_no_day);
      return null;
    }
    const [from, to] = [minutesOf(this.from.value), minutesOf(this.to.value)];
    if (to >= from) return {begins: `${today}T00:00`, zone, rule: `FREQ=DAILY;${timesOfDay(from, to, Number(this.minutes.value))}`};
    this.tell(words.form_backwards);
    return null;
  }

  async approve() {
    const {what, words, language, wire} = this;
    this.trouble.hidden = true;
    const event = this.mode.value === 'event';
    const rhythm = event ? null : this.rhythm();
    if (!event && !rhythm) return;
    const trigger = event ? this.event.trigger() : null;
    this.button.disabled = true;
    try {
      if (rhythm && (await this.hasNews(rhythm))) return;
      const once = !event && this.kind.value === 'once';
      const added = await wire.request('schedule.add', {
        program: what.program, sha256: what.sha256, by: this.who, sentence: this.sentence.value.trim(),
        language, rhythm, trigger,
        priority: Number(this.priority.value),
        makes_up: Number(this.missed.value),
        until: endOf(once ? dayAfter(this.day.value, 1) : this.until.value, this.zone),
        insists: what.insists,
        ...(this.fleet && !this.robot.disabled && this.robot.value === 'any' && {fleet: true}),
      });
      const listed = await wire.request('schedule.list', {language});
      const {when} = listed.find(({appointment}) => appointment.id === added.id) ?? {when: words.form_title};
      this.planned = {appointment: added.id, when};
      this.dialog.close();
    } catch (error) {
      this.tell(error.message);
    } finally {
      this.button.disabled = false;
    }
  }

  /** What is to be minded at that time of day and was not in the review is shown before it is
   * approved: at night it may be loud. Whether there is any that was not. */
  async hasNews(rhythm) {
    if (this.kind.value === 'said') return false; // it was reviewed for its time
    const {what, words, language} = this;
    const first = rhythm.rule === null ? rhythm.begins : this.firstTime();
    const {marks, outcome, good} = await this.wire.request('desk.check', {program: what.program, language, at: first});
    const news = marks.map(({text}) => text).filter((text) => !this.seen.has(text));
    if (!good && !what.insists) news.unshift(outcome);
    const told = JSON.stringify([first, news]);
    if (!news.length || this.confirmed === told) return false;
    this.confirmed = told;
    this.tell(words.form_news, element('ul', {}, ...news.map((text) => element('li', {}, text))));
    return true;
  }

  /** When it would be done first, whatever day that is. */
  firstTime() {
    const time = this.kind.value === 'passing' ? this.from.value : this.time.value;
    return `${time > this.at ? this.today : dayAfter(this.today, 1)}T${time}`;
  }
}

function minutesOf(time) {
  const [hour, minute] = time.split(':').map(Number);
  return 60 * hour + minute;
}

/** The times of each day, as a rule says them: hours times minutes, and which of those. */
function timesOfDay(from, to, step) {
  const wanted = new Set();
  for (let at = from; at <= to; at += step) wanted.add(at);
  const several = (values) => [...new Set(values)].sort((a, b) => a - b);
  const hours = several([...wanted].map((at) => Math.floor(at / 60)));
  const minutes = several([...wanted].map((at) => at % 60));
  const whole = hours.flatMap((hour) => minutes.map((minute) => 60 * hour + minute));
  const places = whole.flatMap((at, index) => (wanted.has(at) ? [index + 1] : []));
  const which = places.length < whole.length ? `;BYSETPOS=${places}` : '';
  return `BYHOUR=${hours};BYMINUTE=${minutes}${which}`;
}
