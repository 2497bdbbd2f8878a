/** Where the robot really stands: telling it so, and taking that back. */

import {element, filled} from '/static/page.js';
import {History} from './history.js';

export class Corrections {
  /** `who` corrects it, for the history. `nameOf` gives the name of a spot, `failed` takes why
   * something did not work. */
  constructor(wire, words, {language, who, nameOf, failed}) {
    Object.assign(this, {wire, words, who, failed});
    this.unsubscribe = null;
    this.history = new History(words, language, {
      describe: ({undoes, before, after}) =>
        filled(undoes ? words.location_undone : words.location_set, {
          from: nameOf(before),
          to: nameOf(after),
        }),
      undo: (correction) => this.#call('location.undo', {correction}),
    });
    this.history.panel.open = true;
    this.panel = element('div', {class: 'floor-zones', hidden: true}, this.history.panel);
  }

  /** Ask who corrected it, and be told from then on. */
  async fetch() {
    const history = await this.wire.request('location.history').catch(() => null);
    if (!history) return;
    this.unsubscribe ??= this.wire.subscribe('location', (event) => this.history.show(event.history));
    this.history.show(history);
  }

  end() {
    this.unsubscribe?.();
  }

  /** Tell the robot where it is: {x, y, theta}. */
  async set(where) {
    await this.#call('location.set', where);
  }

  async #call(method, params) {
    try {
      this.history.show(await this.wire.request(method, {...params, who: this.who}));
      this.failed('');
    } catch (error) {
      this.failed(error.message);
    }
  }
}
