/** The map in words, for who does not see it. */

import {filled} from '/static/page.js';

const PACE = 3000; // milliseconds between two texts, so that a screen reader can keep up

/** Where the robot is, where it goes, and how many people are there, in a sentence or two. */
export function inWords(scene, floor, words) {
  if (!scene || scene.x === null) return words.told_unknown;
  const {name} = floor.robot;
  const robot = name.slice(0, 1).toUpperCase() + name.slice(1); // it begins a sentence
  const place = floor.placeAt(scene.x, scene.y);
  const told = [
    place
      ? filled(words.told_place, {robot, place: floor.nameOf(place)})
      : filled(words.told_spot, {robot, x: scene.x.toFixed(1), y: scene.y.toFixed(1)}),
  ];
  if (scene.way.length) {
    const goal = floor.placeAt(...scene.way.at(-1));
    if (goal && goal !== place) told.push(filled(words.told_goal, {place: floor.nameOf(goal)}));
  }
  if (scene.holding.length) {
    const things = scene.holding.map((name) => floor.thingName(name)).join(', ');
    told.push(filled(words.told_holding, {things}));
  }
  const count = scene.people.length;
  if (count) told.push(count === 1 ? words.told_person : filled(words.told_people, {count}));
  return told.join(' ');
}

/** Says a text now and then, and only if it is news. */
export class Teller {
  #waiting = null;
  #next = '';
  #said = 0;

  constructor(say) {
    this.say = say;
  }

  tell(text) {
    this.#next = text;
    if (this.#waiting !== null) return;
    const wait = Math.max(this.#said + PACE - Date.now(), 0);
    this.#waiting = setTimeout(() => {
      this.#waiting = null;
      this.#said = Date.now();
      this.say(this.#next);
    }, wait);
  }

  close() {
    clearTimeout(this.#waiting);
  }
}
