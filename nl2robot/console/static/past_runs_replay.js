/**
 * A run watched again: the robot moves over the floor as it did, while time passes or a slider is
 * drawn. What is kept of a movement is in nl2robot/run/kept_record.py.
 */

import {filled} from '/static/page.js';

const SVG = 'http://www.w3.org/2000/svg';
const TOLD_FOR = 4; // seconds that what was said is shown, at least
const TELLS = {speech: 'says', heard: 'hears', screen: 'shows', emotion: 'feels', gesture: 'gestures'};
const STANDS = 1; // seconds without a pose after which it stood
const RADIUS = 0.28; // metres; on a large floor more, to be seen
const SMALLEST = 1 / 90; // of the floor's width
const MARGIN = 1; // metres around a movement whose floor is not known

function shape(name, attributes) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  return made;
}

/** Index of the last entry at or before a time; entries begin with their time. */
function lastBefore(entries, time) {
  let low = 0;
  let high = entries.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (entries[middle][0] <= time) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Where it was: [x, y, theta in degrees], between the poses that are kept. */
export function poseAt(poses, time) {
  const at = lastBefore(poses, time);
  if (at < 0) return poses[0]?.slice(1) ?? null;
  const [since, ...from] = poses[at];
  const next = poses[at + 1];
  if (!next) return from;
  const [until, ...to] = next;
  const began = Math.max(since, until - STANDS);
  const share = Math.min(1, Math.max(0, (time - began) / (until - began || 1)));
  const turn = ((to[2] - from[2] + 540) % 360) - 180;
  return [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share, from[2] + turn * share];
}

/** The floor's drawing with its empty group in metres, or a bare one as large as the movement. */
async function drawing(address, poses) {
  const response = await fetch(address);
  if (response.ok) {
    const read = new DOMParser().parseFromString(await response.text(), 'image/svg+xml');
    const svg = document.importNode(read.documentElement, true);
    const width = svg.viewBox.baseVal.width / Number(svg.dataset.scale);
    return {svg, live: svg.querySelector('#live'), width};
  }
  const xs = poses.map((pose) => pose[1]);
  const ys = poses.map((pose) => pose[2]);
  const [left, right] = [Math.min(0, ...xs) - MARGIN, Math.max(0, ...xs) + MARGIN];
  const [low, high] = [Math.min(0, ...ys) - MARGIN, Math.max(0, ...ys) + MARGIN];
  const svg = shape('svg', {viewBox: `${left} ${-high} ${right - left} ${high - low}`});
  const live = shape('g', {transform: 'scale(1 -1)'});
  svg.append(live);
  return {svg, live, width: right - left};
}

function written(seconds) {
  const whole = Math.floor(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

/** Watch the run that is described in `root`; `light(line)` is told where the program was. */
export async function mountReplay(root, light, words) {
  const place = root.querySelector('[data-replay]');
  if (!place) return;
  const part = (name) => place.querySelector(`[data-${name}]`);
  const [floor, caption, play, slider, clock, speed] = [
    ...['floor', 'caption', 'play', 'time', 'clock', 'speed'],
  ].map(part);
  let movement;
  let drawn;
  try {
    movement = await (await fetch(place.dataset.replay)).json();
    drawn = await drawing(floor.dataset.floor, movement.poses);
  } catch {
    caption.textContent = words.replay_failed;
    return;
  }
  const {poses, happenings, lines, seconds} = movement;

  drawn.svg.removeAttribute('width');
  drawn.svg.removeAttribute('height');
  const points = (some) => some.map((pose) => `${pose[1]},${pose[2]}`).join(' ');
  const way = shape('polyline', {class: 'way', points: points(poses)});
  const been = shape('polyline', {class: 'been'});
  const robot = shape('g', {class: 'robot'});
  robot.append(shape('circle', {r: 1}), shape('path', {d: 'M0.75 0 L-0.35 0.55 V-0.55Z'}));
  robot.setAttribute('visibility', poses.length ? 'visible' : 'hidden');
  const size = Math.max(RADIUS, drawn.width * SMALLEST);
  way.style.strokeWidth = been.style.strokeWidth = size * 0.45;
  drawn.live.append(way, been, robot);
  floor.replaceChildren(drawn.svg);

  slider.max = Math.max(0.1, seconds);
  let time = 0;
  let playing = false;
  let last = 0;

  function show() {
    slider.value = time;
    clock.textContent = `${written(time)} / ${written(seconds)}`;
    slider.setAttribute('aria-valuetext', clock.textContent);
    const pose = poseAt(poses, time);
    if (pose) {
      const [x, y, theta] = pose;
      robot.setAttribute('transform', `translate(${x} ${y}) rotate(${theta}) scale(${size})`);
      const until = lastBefore(poses, time) + 1;
      been.setAttribute('points', `${points(poses.slice(0, until))} ${until ? `${x},${y}` : ''}`);
    }
    tell();
    const at = lastBefore(lines, time + 0.05);
    light(at < 0 ? null : lines[at][1]);
  }

  function tell() {
    const happened = happenings[lastBefore(happenings, time)];
    const [when, kind, text] = happened ?? [-Infinity];
    const length = text ? TOLD_FOR + text.length / 15 : 0;
    const called = words[`${kind}_${text}`] ?? text; // looks and gestures are words of ours
    const said = time - when < length ? filled(words[TELLS[kind] ?? kind], {text: called}) : '';
    const shown = said || (movement.shortened && time >= seconds ? words.shortened : '');
    if (caption.textContent !== shown) caption.textContent = shown;
  }

  function step(now) {
    if (!playing || !place.isConnected) return;
    time = Math.min(seconds, time + ((now - last) / 1000) * Number(speed.value));
    last = now;
    show();
    if (time >= seconds) run(false);
    else requestAnimationFrame(step);
  }

  function run(go) {
    playing = go;
    play.textContent = go ? '❚❚' : '▶';
    play.setAttribute('aria-label', go ? words.pause : words.play);
    if (!go) return;
    if (time >= seconds) time = 0;
    last = performance.now();
    requestAnimationFrame(step);
  }

  play.addEventListener('click', () => run(!playing));
  slider.addEventListener('input', () => {
    time = Number(slider.value);
    show();
  });
  slider.step = Math.max(0.05, seconds / 1000);
  show();
  light(null);
  place.dataset.ready = '';
}
