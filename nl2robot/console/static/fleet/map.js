/** The floor as a drawing (SVG), with all robots that are on it. */

import {filled} from '/static/page.js';

const SVG = 'http://www.w3.org/2000/svg';
const MARGIN = 0.6; // metres around the floor
const LABEL = 0.55; // metres that a robot's name is high

function shape(tag, attributes = {}, text = '') {
  const made = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text) made.textContent = text;
  return made;
}

const points = (polygon) => polygon.map(([x, y]) => `${x},${-y}`).join(' ');

export class FleetMap {
  #robots = shape('g');
  #words;
  #image = null;
  #unit = 1;

  constructor(root, words) {
    this.#words = words;
    this.root = root;
  }

  /** Draw the floor, as `scene.floor` tells it. */
  draw(floor, language) {
    const [left, bottom, right, top] = floor.bounds;
    const width = right - left + 2 * MARGIN;
    const height = top - bottom + 2 * MARGIN;
    this.#unit = Math.max(width / 40, 0.6);
    const image = shape('svg', {viewBox: `${left - MARGIN} ${-top - MARGIN} ${width} ${height}`, role: 'img', class: 'floor'});
    for (const outline of floor.ground) image.append(shape('polygon', {points: points(outline), class: 'ground'}));
    for (const place of floor.places) {
      if (place.area.length) image.append(shape('polygon', {points: points(place.area), class: 'room'}));
    }
    for (const [x1, y1, x2, y2] of floor.walls) image.append(shape('line', {x1, y1: -y1, x2, y2: -y2, class: 'wall', 'stroke-width': floor.wall}));
    for (const place of floor.places) {
      if (!place.pose || place.part) continue;
      const [x, y] = middle(place);
      const name = place.names[language] ?? place.name;
      image.append(shape('text', {x, y: -y, class: 'place', 'font-size': LABEL * 0.75 * this.#unit}, name));
    }
    this.#robots = shape('g');
    image.append(this.#robots);
    this.#image = image;
    this.root.replaceChildren(image);
  }

  /** Where they are; those of which nobody knows it are drawn where they were. */
  show(members) {
    const names = members.map(({name}) => name).join(', ');
    this.#image?.setAttribute('aria-label', filled(this.#words.map_told, {names}));
    this.#robots.replaceChildren(
      ...members.map(({id, name, known, standing, here}, number) => {
        const {x, y, theta} = standing;
        const kinds = ['robot', known ? '' : 'unknown', here ? 'here' : ''].join(' ').trim();
        const robot = shape('g', {class: kinds, transform: `translate(${x} ${-y})`, 'data-id': id});
        const size = 0.5 * this.#unit;
        robot.append(
          shape('circle', {r: size}),
          shape('path', {d: `M0 ${-size * 0.6}L${size} 0L0 ${size * 0.6}z`, transform: `rotate(${-theta})`}),
          // Several at one place: their names one below the other.
          shape('text', {y: -size * 1.3 - this.#above(members, number) * LABEL * this.#unit, 'font-size': LABEL * this.#unit}, known ? name : `${name} ?`),
        );
        return robot;
      }),
    );
  }

  /** How many of the robots before it stand where it does. */
  #above(members, number) {
    const {x, y} = members[number].standing;
    return members.slice(0, number).filter(({standing}) => Math.hypot(standing.x - x, standing.y - y) < 2 * this.#unit).length;
  }
}

function middle({area, pose}) {
  if (!area.length) return pose;
  const xs = area.map(([x]) => x);
  const ys = area.map(([, y]) => y);
  return [(Math.min(...xs) + Math.max(...xs)) / 2, (Math.min(...ys) + Math.max(...ys)) / 2];
}
