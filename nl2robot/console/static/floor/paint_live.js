/** What moves: people, things, the lidar's points, the robot and its ways. */

import {beside, FONT, writeLabel} from './labels.js';
import {Pen} from './paint_plan.js';
import {along, boxAbout, boxAt, overlap, radians, touches} from './shapes.js';

const COLOURS = {
  red: '#d64541',
  blue: '#3f78c9',
  green: '#4a9d55',
  yellow: '#ecc32f',
  white: '#ffffff',
  black: '#33383d',
  brown: '#8d6540',
  orange: '#e8862e',
  pink: '#e58bb1',
  purple: '#8a5fc0',
  grey: '#9aa3ab',
  gray: '#9aa3ab',
};
const NAMES_FROM = 16; // pixels a metre: on a smaller plan the initials must do
const REACH = 795; // centimetres: what the lidar reports beyond that is nothing

/** Paints the scene of a frame.
 * `shown` has: plan (its painter), floor, scene, trail, path (a dry run's), layers. */
export function paintLive(context, {camera, palette}, shown) {
  const pen = new Pen(context, camera);
  const {scene, layers} = shown;
  context.clearRect(0, 0, camera.width, camera.height);
  if (layers.paths) paintTrail(pen, palette, shown.trail, scene);
  if (shown.path) paintDryRun(pen, palette, shown.path);
  if (scene && layers.paths) paintWay(pen, palette, scene);
  const taken = layers.names ? shown.plan.paintNames(context, {camera, palette}) : [];
  if (!scene) return;
  if (layers.lidar) paintLidar(pen, palette, scene);
  if (layers.things) paintThings(pen, palette, shown.floor.thingsIn(scene));
  if (layers.people) paintPeople(pen, palette, shown, taken);
  if (scene.x !== null) {
    paintRobot(pen, palette, [scene.x, scene.y, scene.theta], shown.floor.robot.radius);
    if (scene.holding.length && layers.names) paintHeld(pen, palette, scene, shown.floor);
  }
}

/** The robot: a disc with a nose that shows which way it faces. */
export function paintRobot(pen, palette, pose, radius, ghost = false) {
  const {context} = pen;
  const [u, v] = pen.spot(pose);
  const size = robotSize(pen.scale, radius);
  context.save();
  if (ghost) context.globalAlpha = 0.6;
  else {
    context.shadowColor = palette.get('shadow');
    context.shadowBlur = 6;
    context.shadowOffsetY = 1;
  }
  pen.disc(pose, size, palette.get('robot'), palette.get('robot-rim'), 2);
  context.shadowColor = 'transparent';
  const angle = radians(pose[2]);
  const ahead = [Math.cos(angle), -Math.sin(angle)];
  const aside = [Math.sin(angle), Math.cos(angle)];
  const nose = [
    [0.74, 0],
    [-0.42, 0.54],
    [-0.18, 0],
    [-0.42, -0.54],
  ].map(([a, b]) => [
    u + size * (a * ahead[0] + b * aside[0]),
    v + size * (a * ahead[1] + b * aside[1]),
  ]);
  pen.pixels(nose, palette.get('nose'));
  context.restore();
}

/** The radius of the robot's disc in pixels: large enough to be found. */
export const robotSize = (scale, radius) => Math.max(radius * scale, 9);

/** The radius of a person's head in pixels. */
export const headSize = (scale) => Math.min(Math.max(0.24 * scale, 6.5), 13);

function paintTrail(pen, palette, trail, scene) {
  const {context} = pen;
  const points = scene && scene.x !== null ? [...trail, [scene.x, scene.y]] : trail;
  if (points.length < 2) return;
  context.save();
  context.lineCap = context.lineJoin = 'round';
  context.setLineDash([0.1, 6]);
  pen.line(points, palette.get('trail'), 2.6);
  context.restore();
}

function paintWay(pen, palette, scene) {
  if (!scene.way.length || scene.x === null) return;
  const {context} = pen;
  const points = [[scene.x, scene.y], ...scene.way];
  context.save();
  context.lineCap = context.lineJoin = 'round';
  pen.line(points, palette.get('way-halo'), 7);
  pen.line(points, palette.get('way'), 3);
  context.restore();
  pen.disc(points.at(-1), 6, palette.get('way-halo'), palette.get('way'), 2.5);
  pen.disc(points.at(-1), 2, palette.get('way'));
}

/** The way of a dry run: dashed from a ring to a flag. */
function paintDryRun(pen, palette, points) {
  if (!points.length) return;
  const {context} = pen;
  const colour = palette.get('dry-run');
  context.save();
  context.lineCap = context.lineJoin = 'round';
  pen.line(points, palette.get('way-halo'), 6);
  context.setLineDash([7, 7]);
  pen.line(points, colour, 2.6);
  context.restore();
  pen.disc(points[0], 5.5, palette.get('way-halo'), colour, 2.5);
  paintFlag(pen, points.at(-1), colour);
}

/** A flag whose foot is at a spot. */
export function paintFlag(pen, spot, colour) {
  const [u, v] = pen.spot(spot);
  const {context} = pen;
  pen.disc(spot, 3, colour);
  context.beginPath();
  context.moveTo(u, v);
  context.lineTo(u, v - 20);
  context.strokeStyle = colour;
  context.lineWidth = 2;
  context.stroke();
  pen.pixels(
    [
      [u, v - 21],
      [u + 14, v - 16],
      [u, v - 11],
    ],
    colour,
  );
}

function paintLidar(pen, palette, scene) {
  const {lidar, seenFrom = scene} = scene;
  const {context} = pen;
  const size = Math.min(Math.max(0.08 * pen.scale, 1.3), 2.2);
  context.fillStyle = palette.get('lidar');
  context.beginPath();
  lidar.forEach((centimetres, number) => {
    if (centimetres > REACH) return;
    const heading = seenFrom.theta + (360 / lidar.length) * number;
    const [u, v] = pen.spot(along([seenFrom.x, seenFrom.y, heading], centimetres / 100));
    context.moveTo(u + size, v);
    context.arc(u, v, size, 0, 2 * Math.PI);
  });
  context.fill();
}

function paintThings(pen, palette, things) {
  const size = Math.min(Math.max(0.12 * pen.scale, 3), 6);
  for (const thing of things) {
    const [u, v] = pen.spot([thing.x, thing.y]);
    const word = thing.is.find((each) => each in COLOURS);
    const diamond = [
      [u, v - size],
      [u + size, v],
      [u, v + size],
      [u - size, v],
    ];
    pen.pixels(diamond, word ? COLOURS[word] : palette.get('thing'), palette.get('ink'), 1);
  }
}

function paintPeople(pen, palette, {floor, scene, layers}, taken) {
  const {context} = pen;
  const size = headSize(pen.scale);
  const boxes = [...taken];
  if (scene.x !== null) {
    const robot = 2 * robotSize(pen.scale, floor.robot.radius);
    boxes.push(boxAt(...pen.spot([scene.x, scene.y]), robot, robot));
  }
  for (const [, , x, y] of scene.people) boxes.push(boxAt(...pen.spot([x, y]), size, size));
  const lines = floor.walls.map(([x1, y1, x2, y2]) =>
    boxAbout([pen.spot([x1, y1]), pen.spot([x2, y2])]),
  );
  for (const [name, kind, x, y, theta, posture] of scene.people) {
    const colour = palette.person(kind);
    // Shoulders show which way somebody faces; who lies in bed shows a head alone.
    if (posture !== 'lying' && pen.scale > 16) shoulders(pen, [x, y, theta], size, colour);
    pen.disc([x, y], size, colour, palette.get('head-rim'), 1.5);
    const [u, v] = pen.spot([x, y]);
    const called = floor.personName(name);
    context.font = `600 ${size * 1.2}px ${FONT}`;
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillStyle = palette.get('initial');
    context.fillText(called.slice(0, 1).toUpperCase(), u, v + size * 0.08);
    if (!layers.names || pen.scale < NAMES_FROM) continue;
    const free = (box) => !boxes.some((other) => overlap(other, box));
    const offWalls = (box) => free(box) && !lines.some((line) => touches(line, box));
    const box = beside(context, called, u, v, size + 1, 11, offWalls, free);
    if (!box) continue;
    boxes.push(box);
    const label = {lines: [called], size: 11, box};
    writeLabel(context, label, palette.get('ink'), palette.get('name-halo'));
  }
}

function shoulders(pen, pose, size, colour) {
  const {context} = pen;
  const [u, v] = pen.spot(pose);
  context.save();
  context.translate(u, v);
  context.rotate(-radians(pose[2]));
  context.beginPath();
  context.ellipse(-size * 0.25, 0, size * 0.75, size * 1.5, 0, 0, 2 * Math.PI);
  context.globalAlpha = 0.45;
  context.fillStyle = colour;
  context.fill();
  context.restore();
}

/** What the robot holds, written above it. */
function paintHeld(pen, palette, scene, floor) {
  const [u, v] = pen.spot([scene.x, scene.y]);
  const text = scene.holding.map((name) => floor.thingName(name)).join(', ');
  const box = boxAt(u, v - robotSize(pen.scale, floor.robot.radius) - 9, 0, 0);
  const label = {lines: [text], size: 11, box};
  writeLabel(pen.context, label, palette.get('ink'), palette.get('name-halo'));
}
