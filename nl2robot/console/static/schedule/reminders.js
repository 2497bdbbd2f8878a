/** The record of reminders: who was reminded of what, and what came of it. */

import {element} from '/static/page.js';
import {datesIn} from '/static/schedule/days.js';

const SHOWN = 50;

export class Reminders {
  constructor(root, {wire, words, language}) {
    this._root = root;
    this._wire = wire;
    this._words = words;
    this._language = language;
    this._drawn = '';
  }

  /** Show them by the clocks of that zone. */
  async refresh(zone) {
    this._zone = zone;
    const found = await this._wire.request('schedule.reminders', {language: this._language, last: SHOWN});
    const now = JSON.stringify(found);
    if (now === this._drawn) return;
    this._drawn = now;
    this._root.hidden = !found.length;
    if (found.length) this._root.replaceChildren(this._head(), this._table(found));
  }

  _head() {
    const title = element('h2', {id: 'reminders-title'}, this._words.reminders);
    const file = {class: 'button small', href: '/schedule/reminders.csv', download: ''};
    return element('div', {class: 'row reminders-head'}, title, element('a', file, this._words.reminders_save));
  }

  _table(found) {
    const names = ['due', 'said', 'person', 'what', 'place', 'result', 'robot'];
    const head = names.map((name) => element('th', {scope: 'col'}, this._words[`reminder_${name}`]));
    const rows = found.map((each) => {
      const cells = [
        this._when(each.due, true),
        each.said === null ? '' : this._when(each.said, false),
        each.person,
        each.what,
        each.place ?? '',
        each.told,
        each.robot,
      ];
      const row = element('tr', {class: `result-${each.result}`});
      row.append(...cells.map((cell) => element('td', {}, cell)));
      return row;
    });
    const table = element('table', {'aria-labelledby': 'reminders-title'});
    table.append(element('thead', {}, element('tr', {}, ...head)), element('tbody', {}, ...rows));
    return element('div', {class: 'reminders-table', tabindex: '0', role: 'region', 'aria-labelledby': 'reminders-title'}, table);
  }

  _when(seconds, day) {
    const time = {hour: '2-digit', minute: '2-digit', timeZone: this._zone};
    const format = day ? {day: 'numeric', month: 'short', ...time} : time;
    return new Date(seconds * 1000).toLocaleString(datesIn(this._language), format);
  }
}
