/** The keep-out zones: those there are, a new one, one less. */

import {element, filled} from '/static/page.js';
import {button, listening} from './controls.js';
import {History} from './history.js';

export class Zones {
  /** @type {{name: string, polygon: number[][], removable: boolean}[]} */
  list = [];

  /** `who` draws them, for the history. `changed` is called with news, `drawn` gives the outline that is being drawn, `clear` forgets
   * it, `close` ends it, `failed` takes why something did not work, `tell` the events. */
  constructor(wire, words, {language, who, changed, drawn, clear, close, failed, tell}) {
    Object.assign(this, {wire, words, who, changed, drawn, clear, failed, tell});
    this.unsubscribe = null;
    this.name = element('input', {class: 'field', maxlength: 60, autocomplete: 'off'});
    this.form = element(
      'form',
      {class: 'floor-zone-form', hidden: true},
      element('label', {}, words.zone_name, this.name),
      element('button', {class: 'button small primary'}, words.zone_save),
      button({class: 'button small'}, clear, words.zone_discard),
    );
    listening(this.form, 'submit', (event) => {
      event.preventDefault();
      this.save(this.name.value.trim());
    });
    this.outline = element(
      'div',
      {class: 'floor-zone-form', hidden: true},
      button({class: 'button small'}, close, words.zone_close),
    );
    this.items = element('ul', {class: 'floor-zone-list', 'aria-label': words.zones});
    this.history = new History(words, language, {
      describe: ({what, undoes, name}) => filled(words[`zone_${what}${undoes ? '_back' : ''}`], {name}),
      undo: (change) => this.#call('zones.undo', {change}),
    });
    this.panel = element(
      'div',
      {class: 'floor-zones'},
      ...[this.outline, this.form, this.items, this.history.panel],
    );
  }

  /** Ask which zones there are, and be told of others from then on. */
  async fetch() {
    const zones = await this.wire.request('zones.list').catch(() => null);
    if (!zones) return; // a robot that knows no zones
    this.unsubscribe ??= this.wire.subscribe('zones', (event) => {
      this.show(event.zones);
      this.history.show(event.history);
    });
    this.show(zones);
    this.history.show(await this.wire.request('zones.history').catch(() => []));
  }

  end() {
    this.unsubscribe?.();
  }

  /** How far the drawing is: "nothing", "corners" that can be closed, or a "whole" zone. */
  stage(stage) {
    this.outline.hidden = stage !== 'corners';
    this.form.hidden = stage !== 'whole';
  }

  /** Ask for the name of the zone that is drawn. */
  ask(suggestion) {
    this.stage('whole');
    this.name.value = suggestion ?? filled(this.words.zone_new, {number: this.list.length + 1});
    this.name.focus();
    this.name.select();
  }

  show(zones) {
    this.list = zones;
    const items = zones.map(({name, removable}) => {
      const label = filled(this.words.zone_remove, {name});
      const cross = button({'aria-label': label, title: label}, () => this.remove(name), '×');
      return element('li', {class: 'chip'}, name, ...(removable ? [cross] : []));
    });
    if (!items.length) items.push(element('li', {class: 'muted'}, this.words.zones_none));
    this.items.replaceChildren(...items);
    this.changed();
  }

  async save(name) {
    const zone = {polygon: this.drawn(), name};
    if (!name || !(await this.#call('zones.set', zone))) return;
    this.clear();
    this.tell('zone', zone);
  }

  async remove(name) {
    if (await this.#call('zones.remove', {name})) this.tell('zone-remove', {name});
  }

  /** Whether the server did it. */
  async #call(method, params) {
    try {
      this.show(await this.wire.request(method, {...params, who: this.who}));
      this.failed('');
      return true;
    } catch (error) {
      this.failed(error.message);
      return false;
    }
  }
}
