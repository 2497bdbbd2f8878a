/** The places that were named by hand on the map: a new one, one that is moved, one less. */

import {element, filled} from '/static/page.js';
import {button, listening} from './controls.js';

export class Places {
  #spot = null; // {x, y, theta} of the one in the form
  #edited = null; // the place that the form is about, if it has a name already

  /** `language` is the one of other names that are given here. `changed` is called with all places
   * when there is news, `clear` lets the map forget the spot, `failed` takes why something did not
   * work. */
  constructor(wire, words, language, {changed, clear, failed}) {
    Object.assign(this, {wire, words, language, changed, clear, failed});
    this.unsubscribe = null;
    const field = (label, attributes) => {
      const input = element('input', {class: 'field', maxlength: 60, autocomplete: 'off', ...attributes});
      return [input, element('label', {}, label, input)];
    };
    const [name, named] = field(words.place_name, {required: true});
    const [kind, ofKind] = field(words.place_kind, {placeholder: words.place_kind_hint});
    const [aliases, also] = field(words.place_aliases, {
      maxlength: 600,
      placeholder: words.place_aliases_hint,
    });
    Object.assign(this, {name, kind, aliases});
    this.form = element(
      'form',
      {class: 'floor-zone-form', hidden: true},
      named,
      ofKind,
      also,
      element('button', {class: 'button small primary'}, words.place_save),
      button({class: 'button small'}, () => this.discard(), words.zone_discard),
    );
    listening(this.form, 'submit', (event) => {
      event.preventDefault();
      this.#save();
    });
    this.note = element('p', {class: 'floor-hint', role: 'status', hidden: true});
    this.items = element('ul', {class: 'floor-zone-list', 'aria-label': words.places_by_hand});
    const take = button({class: 'button small'}, () => this.#export(), words.places_export);
    this.tail = element('div', {class: 'floor-zones'}, this.items, take);
    this.panel = element('div', {class: 'floor-zones'}, this.note, this.form, this.tail);
  }

  /** Ask which places there are, and be told of others from then on. */
  async fetch() {
    const places = await this.wire.request('places.list').catch(() => null);
    if (!places) return;
    this.unsubscribe ??= this.wire.subscribe('places', (event) => this.show(event.places));
    this.show(places);
  }

  end() {
    this.unsubscribe?.();
  }

  show(places) {
    const items = places
      .filter(({removable}) => removable)
      .map((place) => {
        const label = filled(this.words.zone_remove, {name: place.name});
        const change = filled(this.words.place_change, {name: place.name});
        return element(
          'li',
          {class: 'chip'},
          button({class: 'floor-place-named', title: change, 'aria-label': change}, () => this.edit(place), place.name),
          button({title: label, 'aria-label': label}, () => this.#remove(place), '×'),
        );
      });
    if (!items.length) items.push(element('li', {class: 'muted'}, this.words.places_none));
    this.items.replaceChildren(...items);
    this.changed(places);
  }

  /** A spot was clicked: ask what is there; or it is where the place in the form is. */
  pick(spot) {
    this.#spot = spot;
    if (!this.form.hidden) return;
    this.#open(null);
  }

  /** Change a place that was named by hand. */
  edit(place) {
    const [x, y, theta] = place.pose;
    this.#spot = {x, y, theta};
    this.#open(place);
  }

  /** A place was dragged there. */
  async move({name}, [x, y]) {
    await this.#call('places.set', {name, was: name, x, y});
  }

  discard() {
    this.form.hidden = true;
    this.tail.hidden = false;
    this.#spot = this.#edited = null;
    this.clear();
  }

  #open(place) {
    this.#edited = place;
    this.note.hidden = true;
    this.tail.hidden = true;
    this.form.hidden = false;
    this.name.value = place?.name ?? '';
    this.kind.value = place?.kind ?? '';
    this.aliases.value = (place?.aliases[this.language] ?? []).join(', ');
    this.name.focus();
    this.name.select();
  }

  async #save() {
    const {x, y, theta} = this.#spot;
    const aliases = {...this.#edited?.aliases, [this.language]: this.aliases.value.split(',')};
    const place = {name: this.name.value, kind: this.kind.value, aliases, x, y};
    if (theta !== null) place.theta = theta;
    if (this.#edited) place.was = this.#edited.name;
    if (await this.#call('places.set', place)) this.discard();
  }

  async #remove({name}) {
    await this.#call('places.remove', {name});
  }

  async #export() {
    try {
      const {file, text} = await this.wire.request('places.export');
      const address = URL.createObjectURL(new Blob([text], {type: 'application/yaml'}));
      element('a', {href: address, download: file}).click();
      URL.revokeObjectURL(address);
      this.failed('');
    } catch (error) {
      this.failed(error.message);
    }
  }

  /** Whether the server did it. */
  async #call(method, params) {
    try {
      const {places, moved} = await this.wire.request(method, params);
      this.show(places);
      this.note.hidden = moved < 0.05;
      this.note.textContent = filled(this.words.place_moved, {metres: moved.toFixed(1)});
      this.failed('');
      return true;
    } catch (error) {
      this.failed(error.message);
      return false;
    }
  }
}
