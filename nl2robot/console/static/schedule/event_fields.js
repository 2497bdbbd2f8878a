/** The fields that ask what has to happen for a program to be done. */

import {element, filled} from '/static/page.js';

export const EVENTS = ['seen', 'battery', 'pressed', 'heard', 'scanned', 'place', 'message'];
const ANYBODY = 'person'; // whom the robot looks for where anybody is meant
const LONGEST = 200;
const LONGEST_BUTTON = 40; // letters
const MINUTE = 60;
const A_MONTH = 31 * 24 * 60; // minutes

export class EventFields {
  /** `said`: {when, trigger}, if an event was said. */
  constructor({words, places, said}) {
    Object.assign(this, {words, said});
    const kinds = EVENTS.map((kind) => element('option', {value: kind}, words[`event_${kind}`]));
    if (said) kinds.unshift(element('option', {value: 'said'}, filled(words.form_said, said)));
    this.what = element('select', {class: 'field', name: 'event'}, ...kinds);
    const text = (more = {}) => element('input', {class: 'field', maxlength: LONGEST, ...more});
    const number = (value, min, max) => element('input', {type: 'number', class: 'field', value, min, max, step: 1, required: true});
    const named = (first) => element('select', {class: 'field'}, ...first, ...places.map((name) => element('option', {value: name}, name)));
    this.below = number(20, 1, 99);
    this.thing = text({placeholder: words.event_anybody});
    this.where = named([element('option', {value: ''}, words.event_anywhere)]);
    this.place = named([]);
    this.words_heard = text({required: true});
    this.code = text({placeholder: words.event_any_code});
    this.button = text({required: true, maxlength: LONGEST_BUTTON});
    this.topic = text({required: true, placeholder: 'ward-a/call', spellcheck: 'false', autocapitalize: 'off'});
    this.payload = text({placeholder: words.event_anything});
    this.every = number(1, 1, A_MONTH);
  }

  /** What is asked, each with the kinds of event that it is asked for. */
  labels() {
    const {words} = this;
    const label = (name, field, kinds, hint) =>
      element(
        'label', {'data-for': kinds.map((kind) => `event-${kind}`).join(' ')}, words[name], field,
        ...(hint ? [element('small', {class: 'muted'}, words[hint])] : []),
      );
    return [
      label('form_what', this.what, ['said', ...EVENTS]),
      label('event_below', this.below, ['battery']),
      label('event_thing', this.thing, ['seen']),
      label('event_where', this.where, ['seen'], 'event_where_hint'),
      label('event_place_name', this.place, ['place']),
      label('event_words', this.words_heard, ['heard'], 'event_words_hint'),
      label('event_code', this.code, ['scanned']),
      label('event_button', this.button, ['pressed'], 'event_button_hint'),
      label('event_topic', this.topic, ['message'], 'event_topic_hint'),
      label('event_payload', this.payload, ['message']),
      label('event_every', this.every, EVENTS),
    ];
  }

  /** What was chosen, as `schedule.add` takes it. */
  trigger() {
    const what = this.what.value;
    if (what === 'said') return this.said.trigger;
    const value = (field) => field.value.trim();
    const details = {
      battery: () => ({below: Number(this.below.value)}),
      seen: () => ({thing: value(this.thing) || ANYBODY, place: this.where.value}),
      place: () => ({place: this.place.value}),
      heard: () => ({text: value(this.words_heard)}),
      scanned: () => ({text: value(this.code)}),
      pressed: () => ({text: value(this.button)}),
      message: () => ({topic: value(this.topic), text: value(this.payload)}),
    };
    return {what, every: Number(this.every.value) * MINUTE, ...details[what]()};
  }
}
