/** Where the names of rooms go, so that none is cut, covers another, or hides much below it. */

import {area, boxAbout, boxAt, contains, overlap, rectangle, touches} from './shapes.js';

const SIZES = [15, 14, 13, 12, 11, 10, 9];
const SHARE = 0.6; // of a metre: how large a name may be on a small plan
const SMALLER = 90; // what being one size smaller counts, in square pixels covered
const LINE = 1.2;
const GRID = 12;
const SPOT = 16; // pixels that a person or a thing takes
const SYMBOL = 24; // and the charger, on which the robot often stands
export const FONT = 'system-ui, sans-serif';

/**
 * The labels of all places that there is room for at a scale.
 * They are placed in pixels of a floor whose origin is pixel 0, 0: panning moves them all alike.
 * @param {import('./floor.js').Floor} floor
 * @param {number[][]} spots where people and things are at first:
 *   labels keep off them, as far as they can
 * @returns {{place: object, lines: string[], size: number, box: object}[]}
 */
export function placeNames(context, floor, spots, scale) {
  const {places, furniture} = floor;
  const toPixels = ([x, y]) => [x * scale, -y * scale];
  const drawn = furniture.map((piece) =>
    boxAbout(rectangle(piece.pose, piece.size).map(toPixels)),
  );
  const walls = floor.walls.map(([x1, y1, x2, y2]) => boxAbout([[x1, y1], [x2, y2]].map(toPixels)));
  const busy = spots.map((spot) => boxAt(...toPixels(spot), SPOT, SPOT));
  const smallFirst = places
    .map((place) => ({place, size: place.area.length ? area(place.area) : 0}))
    .sort((one, two) => one.size - two.size);
  const labels = [];
  const parts = [];
  const charger = places.find(({kind, pose}) => kind === 'charger' && pose);
  const symbols = charger ? [boxAt(...toPixels(charger.pose), SYMBOL, SYMBOL)] : [];
  for (const {place} of smallFirst) {
    const name = floor.nameOf(place);
    if (place.area.length) {
      const outline = place.area.map(toPixels);
      const around = boxAbout(outline);
      const board = {
        taken: [...symbols, ...labels.map(({box}) => box)].filter((box) => overlap(box, around)),
        drawn: [...drawn, ...parts, ...busy].filter((box) => overlap(box, around)),
      };
      const label = inOutline(context, name, outline, around, board, scale);
      if (label) labels.push({place, ...label});
      if (place.part) parts.push(around);
      if (label || !place.part) continue;
    }
    // What has no room inside, or no outline, is named beside where one stands in it.
    if (!place.pose) continue;
    const taken = [...symbols, ...labels.map(({box}) => box)];
    const free = (box) => !taken.some((other) => overlap(other, box));
    const offWalls = (box) => free(box) && !walls.some((wall) => touches(wall, box));
    const radius = place === charger ? SYMBOL / 2 : 4;
    const box = beside(context, name, ...toPixels(place.pose), radius, 11, offWalls, free);
    if (box) labels.push({place, lines: [name], size: 11, box});
  }
  return labels;
}

/** Beside something small: below, above, right or left of it, the first box that is free by the
 * first test that any passes; null where there is no room. */
export function beside(context, name, u, v, radius, size, ...tests) {
  const width = textWidth(context, name, size) + size * 0.4;
  const height = size * LINE;
  const far = radius + 1 + height / 2;
  const aside = radius + 2 + width / 2;
  const boxes = [
    [0, far],
    [0, -far],
    [aside, 0],
    [-aside, 0],
  ].map(([du, dv]) => boxAt(u + du, v + dv, width, height));
  for (const isFree of tests) {
    const box = boxes.find(isFree);
    if (box) return box;
  }
  return null;
}

/** Write lines of text in the middle of a box. */
export function writeLabel(context, {lines, size, box}, ink, halo) {
  context.font = `${size}px ${FONT}`;
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.lineJoin = 'round';
  const u = (box.left + box.right) / 2;
  const top = (box.top + box.bottom) / 2 - (size * LINE * (lines.length - 1)) / 2;
  lines.forEach((line, number) => {
    const v = top + size * LINE * number + size * 0.05;
    if (halo) {
      context.strokeStyle = halo;
      context.lineWidth = 3;
      context.strokeText(line, u, v);
    }
    context.fillStyle = ink;
    context.fillText(line, u, v);
  });
}

function inOutline(context, name, outline, around, board, scale) {
  const middleX = (around.left + around.right) / 2;
  const middleY = (around.top + around.bottom) / 2;
  let best = null;
  const sizes = SIZES.filter((size) => size <= Math.max(SHARE * scale, SIZES.at(-2)));
  sizes.forEach((size, step) => {
    const penalty = SMALLER * step;
    if (best && best.cost <= penalty) return;
    for (const lines of breakings(context, name, size, around.right - around.left)) {
      const width = Math.max(...lines.map((line) => textWidth(context, line, size))) + size * 0.4;
      const height = size * LINE * lines.length;
      if (height > around.bottom - around.top) continue;
      for (const [x, y] of grid(around)) {
        const box = boxAt(x, y, width, height);
        if (!rim(box).every(([u, v]) => contains(outline, u, v))) continue;
        if (board.taken.some((other) => overlap(other, box))) continue;
        const covered = board.drawn.reduce((sum, other) => sum + overlap(other, box), 0);
        const far = Math.hypot((x - middleX) / 2, y - middleY);
        const cost = penalty + covered + far + 40 * (lines.length - 1);
        if (!best || cost < best.cost) best = {cost, lines, size, box};
      }
    }
  });
  return best;
}

/** The name on one line, two, three, as far as it is several words. */
function* breakings(context, name, size, width) {
  const words = name.split(' ');
  for (let count = 1; count <= Math.min(3, words.length); count++) {
    const lines = broken(context, words, count, size);
    if (lines.length === count && lines.every((l) => textWidth(context, l, size) < width)) {
      yield lines;
    }
  }
}

function broken(context, words, count, size) {
  const share = (textWidth(context, words.join(' '), size) / count) * 1.15;
  const lines = [];
  for (const word of words) {
    const longer = lines.length ? `${lines.at(-1)} ${word}` : word;
    if (lines.length && (lines.length === count || textWidth(context, longer, size) <= share)) {
      lines[lines.length - 1] = longer;
    } else lines.push(word);
  }
  return lines;
}

const widths = new Map();

/** Measured once: text grows with its size. */
function textWidth(context, text, size) {
  if (!widths.has(text)) {
    context.font = `100px ${FONT}`;
    widths.set(text, context.measureText(text).width / 100);
  }
  return widths.get(text) * size;
}

function* grid(box) {
  for (let i = 1; i < GRID; i++) {
    for (let j = 1; j < GRID; j++) {
      yield [
        box.left + ((box.right - box.left) * i) / GRID,
        box.top + ((box.bottom - box.top) * j) / GRID,
      ];
    }
  }
}

function rim({left, top, right, bottom}) {
  const x = (left + right) / 2;
  const y = (top + bottom) / 2;
  return [left, x, right].flatMap((u) => [top, y, bottom].map((v) => [u, v]));
}
