/** Who changed what, and taking it back. */

import {element, filled} from '/static/page.js';
import {button} from './controls.js';

const SHOWN = 8;

/** A time of today; of another day with its date. */
function moment(seconds, language) {
  const then = new Date(seconds * 1000);
  const today = then.toDateString() === new Date().toDateString();
  const format = today ? {timeStyle: 'short'} : {dateStyle: 'short', timeStyle: 'short'};
  return new Intl.DateTimeFormat(language, format).format(then);
}

/** The list of changes, the newest first, as the server tells them. */
export class History {
  /** `describe` puts a change into words, but for who and when; `undo` takes one back. */
  constructor(words, language, {describe, undo}) {
    Object.assign(this, {words, language, describe, undo});
    this.items = element('ol', {class: 'floor-changes'});
    this.panel = element(
      'details',
      {class: 'floor-history', hidden: true},
      element('summary', {}, words.history),
      this.items,
    );
  }

  show(changes) {
    this.panel.hidden = !changes.length;
    this.items.replaceChildren(
      ...changes.slice(0, SHOWN).map((change) => {
        const what = this.describe(change);
        const told = filled(this.words.history_line, {
          what,
          who: change.who || this.words.history_somebody,
          when: moment(change.when, this.language),
        });
        const label = filled(this.words.undo_this, {what});
        const take = button(
          {class: 'button small', 'aria-label': label, title: label},
          () => this.undo(change.number),
          this.words.undo,
        );
        return element('li', {}, element('span', {}, told), ...(change.undoable ? [take] : []));
      }),
    );
  }
}
