/** The texts of this page, and names as its visitor says them. */

import {filled, pageData, timeOfDay} from '/static/page.js';

const words = pageData.words ?? {};

/** A text of this page, its {gaps} filled. */
export function say(key, values = {}) {
  return filled(words[key] ?? key, values);
}

/** The name of an emotion, a gesture or a joint; one without a text is written as the robot does. */
export function named(kind, name) {
  const key = `${kind}_${name.replaceAll(' ', '_')}`;
  return words[key] ?? name.replaceAll('_', ' ');
}

/** A place or another thing of the world, by its alias in the visitor's language if it has one. */
export function spoken(thing) {
  return (pageData.language !== 'en' && thing.aliases?.[pageData.language]?.[0]) || thing.name;
}

/** A time of day, of seconds since the epoch. */
export function clock(seconds) {
  return timeOfDay(seconds, pageData.language);
}
