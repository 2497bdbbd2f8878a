/**
 * The live floor map.
 *
 *   import { mountFloorMap } from "/static/floor/floor_map.js";
 *   const map = await mountFloorMap(element, { wire, language: "en", operator: true });
 *   map.showPath([[1, 2], [3, 4]]);
 *   element.addEventListener("go", ({ detail }) => ... detail.x, detail.y, detail.place);
 *
 * The element hears of "go" {x, y, place}, "zone" {polygon, name} and "zone-remove" {name}. Where the
 * robot is, zones and places are changed by the map itself; where it goes is the page's.
 */

import {element, filled} from '/static/page.js';
import {Camera} from './camera.js';
import {Corrections} from './corrections.js';
import {layerMenu, modeChoice, placeList, zoomButtons} from './controls.js';
import {Floor} from './floor.js';
import {listen} from './gestures.js';
import {rememberedLayers, rememberLayers} from './layers.js';
import {Motion} from './motion.js';
import {headSize, paintLive, robotSize} from './paint_live.js';
import {Pen, PlanPainter} from './paint_plan.js';
import {Palette} from './palette.js';
import {Places} from './places.js';
import {contains, distance} from './shapes.js';
import {inWords, Teller} from './telling.js';
import {Localise, Look, Name, Send, Zone} from './tools.js';
import {Zones} from './zones.js';

const TOOLS = {look: Look, send: Send, localise: Localise, zone: Zone, place: Name};
const NEAR = 0.6; // metres from a place's pose that mean the place
const NEAR_PIXELS = 14;
const CLOSE_UP = 48; // pixels a metre, for a place that is shown
/** Milliseconds from picture to picture of what moves by itself, in which that moves a pixel or two;
 * more pictures only warm the tablet. */
const MOVES_EVERY = 45;

const STYLE = '/static/floor/floor.css';

/** The map's own style sheet, which is loaded with the first map of a page. */
function styled() {
  if (document.querySelector(`link[href="${STYLE}"]`)) return Promise.resolve();
  const link = element('link', {rel: 'stylesheet', href: STYLE});
  return new Promise((resolve) => {
    link.addEventListener('load', resolve);
    link.addEventListener('error', resolve);
    document.head.append(link);
  });
}

/** A map in an element, whose `floorMap` it becomes; it is ready when it is returned. */
export async function mountFloorMap(root, options) {
  await styled();
  const map = new FloorMap(root, options);
  await map.ready;
  root.floorMap = map;
  return map;
}

export class FloorMap {
  #options;
  #replay = null; // the frame that is shown instead of the live one
  #path = null;
  #plan = null;
  #planStale = true;
  #drawing = 0;
  #moving = 0;
  #undo = [];
  #tool = new Look(this);
  #mode = 'look';
  #closed = '';

  /**
   * @param {HTMLElement} root
   * @param {{wire: object, words?: object, language?: string, operator?: boolean,
   *          modes?: string[], places?: boolean, who?: string,
   *          localise?: (pose: {x: number, y: number, theta: number}) => void}} options
   *   `words` replace the texts that the server has in the language; `modes` are those offered to
   *   an operator, the first is the one to begin with; `places`: whether the list is open;
   *   `who` changes things here, for people; `localise` tells the robot where it is, if not the map.
   */
  constructor(root, options) {
    this.root = root;
    this.#options = {language: 'en', operator: false, ...options};
    /** What a click can do here. */
    this.modes = this.#options.operator
      ? (this.#options.modes ?? ['look', 'send', 'localise', 'zone', 'place'])
      : ['look'];
    this.camera = new Camera();
    this.following = false;
    this.layers = rememberedLayers();
    this.motion = new Motion();
    /** Resolved when the floor is drawn. */
    this.ready = this.#open();
  }

  // --- for other code

  /** What a click does now. */
  get mode() {
    return this.#mode;
  }

  set mode(mode) {
    if (!this.modes.includes(mode)) return;
    this.#mode = mode;
    this.#tool = new TOOLS[mode](this);
    this.root.dataset.mode = mode;
    for (const radio of this.root.querySelectorAll('.floor-mode input')) {
      radio.checked = radio.value === mode;
    }
    this.hint.textContent = this.words[`hint_${mode}`] ?? '';
    this.help.hidden = mode === 'look';
    this.tip.hidden = true;
    this.showNote('');
    this.listTitle.textContent = this.words[`places_${mode}`];
    this.zones.panel.hidden = mode !== 'zone';
    this.zones.stage('nothing');
    this.corrections.panel.hidden = mode !== 'localise';
    this.places.panel.hidden = mode !== 'place';
    this.places.discard();
    this.draw();
  }

  /** Show the path of a dry run, [[x, y], ...] in metres; null: none. */
  showPath(points) {
    this.#path = points?.length ? points : null;
    this.draw();
  }

  /** Show this frame, as of the event `scene`, instead of the live scene; for replays.
   * null: the live scene again. */
  showAt(frame) {
    this.#replay = frame;
    this.root.classList.toggle('replaying', frame !== null);
    this.#planStale = true;
    this.#tellInWords();
    this.draw();
  }

  /** Show the whole floor. */
  fit() {
    this.follow(false);
    this.camera.fit();
    this.#repaint();
  }

  zoom(factor, u, v) {
    if (this.following) this.camera.zoom(factor);
    else this.camera.zoom(factor, u, v);
    this.#repaint();
  }

  /** Keep the robot in the middle. */
  follow(following) {
    this.following = following;
    this.followButton?.setAttribute('aria-pressed', `${following}`);
    if (following && this.camera.scale < CLOSE_UP) this.camera.zoom(CLOSE_UP / this.camera.scale);
    this.#repaint();
  }

  /** Bring a place to the middle. */
  showPlace(place) {
    this.follow(false);
    this.camera.zoom(Math.max(CLOSE_UP / this.camera.scale, 1));
    this.camera.centre(...this.floor.middleOf(place));
    this.#repaint();
  }

  /** Draw again with the next picture of the screen. */
  draw() {
    if (this.#drawing || !this.floor) return;
    this.#drawing = requestAnimationFrame((now) => this.#paint(now));
  }

  /** End it, and leave the element empty. */
  close() {
    for (const undo of this.#undo) undo();
    cancelAnimationFrame(this.#drawing);
    clearTimeout(this.#moving);
    this.floor = null;
    this.root.replaceChildren();
  }

  // --- for the tools

  robotPose() {
    const scene = this.#scene();
    return scene && scene.x !== null ? [scene.x, scene.y, scene.theta] : null;
  }

  /** What a click means to drive to: a place by its name or near where one stands in it, else a
   * spot. */
  targetAt([x, y], [u, v]) {
    const near = Math.max(NEAR, NEAR_PIXELS / this.camera.scale);
    const named = this.layers.names && this.#plan.placeNamedAt(this.camera, u, v);
    const place = named || this.floor.placeNear(x, y, near);
    if (!place) return {x: round(x), y: round(y), place: null};
    const [px, py] = this.floor.middleOf(place);
    return {x: px, y: py, place: place.name};
  }

  /** The robot really stands there: {x, y, theta}. */
  localise(pose) {
    if (this.#options.localise) this.#options.localise(pose);
    else this.corrections.set(pose);
  }

  /** Let the page know. */
  tell(kind, detail) {
    this.root.dispatchEvent(new CustomEvent(kind, {detail, bubbles: true}));
  }

  /** The outline of a zone has grown, or is gone. */
  zoneChanged() {
    const count = this.#tool.corners.length;
    if (!count) this.zones.stage('nothing');
    else if (this.zones.form.hidden) this.zones.stage(count > 2 ? 'corners' : 'nothing');
    this.draw();
  }

  /** A zone's outline is complete, that of a place perhaps; now it needs a name. */
  zoneDrawn(place) {
    this.zones.ask(place ? this.floor.nameOf(place) : null);
    this.draw();
  }

  // --- from start to end

  async #open() {
    const {wire} = this.#options;
    let early = null; // a frame that comes before the floor
    this.#undo.push(
      wire.subscribe('scene', (frame) => {
        if (this.floor) this.#show(frame);
        else early = frame;
      }),
    );
    const {language} = this.#options;
    const floor = new Floor(await wire.request('scene.floor', {language}), language);
    this.words = {...floor.words, ...this.#options.words};
    this.floor = floor;
    this.motion.trail = floor.trail;
    this.#plan = new PlanPainter(floor);
    this.#build();
    this.#measure();
    this.camera.setBounds(floor.bounds, floor.walls.length ? 0.5 : 1.5);
    this.stage.style.setProperty('--floor-proportion', this.camera.proportion);
    this.mode = this.modes[0];
    this.motion.set(early ?? floor.now);
    this.#tellInWords();
    await this.#fetch();
    let connected = wire.connected;
    this.#undo.push(
      wire.onChange((now) => {
        if (now && !connected) this.#reconnected();
        connected = now;
      }),
    );
  }

  async #reconnected() {
    const {wire, language} = this.#options;
    const floor = await wire.request('scene.floor', {language}).catch(() => null);
    if (!floor || !this.floor) return;
    this.motion.trail = floor.trail;
    this.motion.set(floor.now);
    await this.#fetch();
    this.draw();
  }

  /** What others may have changed. */
  async #fetch() {
    await Promise.all([this.zones.fetch(), this.places.fetch(), this.corrections.fetch()]);
  }

  #build() {
    const {words, root} = this;
    this.planCanvas = element('canvas', {'aria-hidden': 'true'});
    const named = filled(words.map_label, {floor: this.floor.name});
    this.canvas = element('canvas', {role: 'img', 'aria-label': named});
    const {buttons, follow} = zoomButtons(words, this);
    this.followButton = follow;
    this.hint = element('p', {class: 'floor-hint'});
    this.tip = element('div', {class: 'floor-tip', hidden: true, 'aria-hidden': 'true'});
    this.stage = element(
      'div',
      {
        class: 'floor-stage',
        tabindex: 0,
        role: 'group',
        'aria-label': named,
      },
      this.planCanvas,
      this.canvas,
      this.tip,
    );
    const layers = layerMenu(this.layers, words, (name, on) => this.#setLayer(name, on));
    const bar = element('div', {class: 'floor-bar'});
    const choose = (mode) => (this.mode = mode);
    if (this.modes.length > 1) bar.append(modeChoice(this.modes, words, choose));
    this.told = element('p', {class: 'floor-told', 'aria-live': 'polite'});
    bar.append(this.told, buttons, layers);
    const {wire, language, who = ''} = this.#options;
    this.zones = new Zones(wire, words, {
      language,
      who,
      changed: () => this.#repaint(),
      drawn: () => this.#tool.corners,
      clear: () => this.#tool.clear?.(),
      close: () => this.zoneDrawn(null),
      failed: (sentence) => this.showError(sentence),
      tell: (kind, detail) => this.tell(kind, detail),
    });
    this.#undo.push(() => this.zones.end());
    this.corrections = new Corrections(wire, words, {
      language,
      who,
      nameOf: (spot) => this.floor.spotName(spot),
      failed: (sentence) => this.showError(sentence),
    });
    this.#undo.push(() => this.corrections.end());
    this.places = new Places(wire, words, language, {
      changed: (places) => this.#placesChanged(places),
      clear: () => this.#tool.clear?.(),
      failed: (sentence) => this.showError(sentence),
    });
    this.#undo.push(() => this.places.end());
    this.listTitle = element('summary', {});
    this.placeList = element('div', {class: 'floor-place-list'});
    this.#listPlaces();
    const list = element(
      'details',
      {class: 'floor-places', open: this.#options.places ?? false},
      this.listTitle,
      this.placeList,
    );
    this.error = element('p', {class: 'floor-error', role: 'alert', hidden: true});
    this.note = element('p', {class: 'floor-note', role: 'status', hidden: true});
    root.classList.add('floor');
    this.help = element(
      'div',
      {class: 'floor-help'},
      ...[this.hint, this.corrections.panel, this.zones.panel, this.places.panel],
    );
    root.replaceChildren(bar, this.error, this.note, this.help, this.stage, list);
    this.palette = new Palette(root);
    this.teller = new Teller((text) => this.#say(text));
    this.#undo.push(() => this.teller.close());
    this.#watch();
  }

  #listPlaces() {
    const {floor} = this;
    const choose = (place) => this.#tool.choose(place);
    this.placeList.replaceChildren(
      ...placeList(floor.places, (place) => floor.nameOf(place), choose),
    );
  }

  /** Somebody named a place, moved one or removed one. */
  #placesChanged(places) {
    if (!this.floor) return;
    this.floor.places = places;
    this.#plan = new PlanPainter(this.floor);
    this.#listPlaces();
    this.#tellInWords();
    this.#repaint();
  }

  /** Look after size, look and gestures. */
  #watch() {
    const size = new ResizeObserver(() => {
      this.#measure();
      this.#repaint();
    });
    size.observe(this.stage);
    const look = new MutationObserver(() => {
      this.palette.read();
      this.#repaint();
    });
    look.observe(document.documentElement, {attributeFilter: ['data-look', 'class']});
    this.#undo.push(
      () => size.disconnect(),
      () => look.disconnect(),
    );
    const spot = (u, v) => this.camera.toFloor(u, v);
    listen(this.stage, this.canvas, {
      press: (u, v) => this.#tool.press(spot(u, v), [u, v]),
      drag: (u, v) => this.#tool.drag(spot(u, v), [u, v]),
      release: (u, v, clicked) => {
        this.#tool.release(spot(u, v), [u, v], clicked);
        if (clicked && this.mode === 'look') this.#showTip(u, v);
      },
      hover: (u, v) => {
        this.#tool.hover(spot(u, v), [u, v]);
        this.#showTip(u, v);
      },
      leave: () => {
        this.#tool.leave();
        this.tip.hidden = true;
      },
      pan: (du, dv) => {
        this.follow(false);
        this.camera.pan(du, dv);
        this.tip.hidden = true;
        this.#repaint();
      },
      zoom: (factor, u, v) => this.zoom(factor, u, v),
      fit: () => this.fit(),
    });
  }

  // --- drawing

  #measure() {
    const {clientWidth, clientHeight} = this.stage;
    const dense = window.devicePixelRatio || 1;
    for (const canvas of [this.planCanvas, this.canvas]) {
      canvas.width = Math.round(clientWidth * dense);
      canvas.height = Math.round(clientHeight * dense);
      canvas.getContext('2d').setTransform(dense, 0, 0, dense, 0, 0);
    }
    this.camera.setSize(clientWidth, clientHeight);
  }

  #repaint() {
    this.#planStale = true;
    this.draw();
  }

  #show(frame) {
    this.motion.push(frame, performance.now());
    if (this.#replay) return;
    const closed = `${frame.closed}`;
    if (closed !== this.#closed) {
      this.#closed = closed;
      this.#planStale = true;
    }
    this.#tellInWords();
    this.#drawMoving();
  }

  /** Draw what moves by itself. */
  #drawMoving() {
    this.#moving ||= setTimeout(() => {
      this.#moving = 0;
      this.draw();
    }, MOVES_EVERY);
  }

  #scene(now = performance.now()) {
    return this.#replay ?? this.motion.at(now);
  }

  #paint(now) {
    this.#drawing = 0;
    const scene = this.#scene(now);
    if (this.following && scene && scene.x !== null) {
      this.camera.centre(scene.x, scene.y);
      this.#planStale = true;
    }
    if (this.#planStale) {
      this.#planStale = false;
      this.#plan.paint(this.planCanvas.getContext('2d'), this, {
        closed: scene?.closed,
        layers: this.layers,
        zones: this.zones.list,
      });
    }
    const context = this.canvas.getContext('2d');
    paintLive(context, this, {
      scene,
      layers: this.layers,
      path: this.#path,
      trail: this.#replay ? [] : this.motion.trail,
      plan: this.#plan,
      floor: this.floor,
    });
    this.#tool.paint(new Pen(context, this.camera), this.palette);
    const unsettled = this.layers.names && !this.#plan.settled(this.camera);
    if (unsettled) this.draw();
    else if (!this.#replay && this.motion.moving(now)) this.#drawMoving();
  }

  #setLayer(name, on) {
    this.layers[name] = on;
    rememberLayers(this.layers);
    this.#repaint();
  }

  // --- words

  #tellInWords() {
    if (!this.floor) return;
    const scene = this.#replay ?? this.motion.at(Infinity);
    this.teller.tell(inWords(scene, this.floor, this.words));
  }

  #say(text) {
    if (this.told.textContent === text) return;
    this.told.textContent = text;
    this.canvas.setAttribute('aria-label', text);
  }

  /** What is under the pointer, beside it. */
  #showTip(u, v) {
    if (this.mode !== 'look' && this.mode !== 'send') return;
    const name = this.#whatIsAt(u, v);
    this.tip.hidden = !name;
    if (!name) return;
    this.tip.textContent = name;
    const right = u > this.camera.width / 2;
    const left = right ? `calc(${u - 12}px - 100%)` : `${u + 14}px`;
    this.tip.style.transform = `translate(${left}, ${v + 14}px)`;
  }

  #whatIsAt(u, v) {
    const {floor, layers, camera} = this;
    const scene = this.#scene();
    const far = ([x, y]) => distance(...camera.toScreen(x, y), u, v);
    const robot = robotSize(camera.scale, floor.robot.radius);
    if (scene && scene.x !== null && far([scene.x, scene.y]) < robot) return floor.robot.name;
    const head = headSize(camera.scale) + 3;
    const person = layers.people && scene?.people.find(([, , x, y]) => far([x, y]) < head);
    if (person) return floor.personName(person[0]);
    const things = layers.things && scene ? floor.thingsIn(scene) : [];
    const [x, y] = camera.toFloor(u, v);
    const zones = layers.zones ? this.zones.list : [];
    const zone = zones.find(({polygon}) => contains(polygon, x, y));
    const named =
      things.find((thing) => far([thing.x, thing.y]) < 8) ??
      ((layers.furniture && floor.furnitureAt(x, y)) || null);
    if (named) return floor.nameOf(named);
    const place = floor.placeAt(x, y);
    return zone?.name ?? (place ? floor.nameOf(place) : '');
  }

  /** Show why something did not happen; an empty text: nothing is wrong any more. */
  showError(text) {
    this.error.textContent = text;
    this.error.hidden = !text;
  }

  /** Say something about what was done; an empty text: nothing any more. */
  showNote(text) {
    this.note.textContent = text;
    this.note.hidden = !text;
  }

  /** The robot was sent to a spot {x, y}, beside where somebody clicked perhaps; null: it was not. */
  sentTo(spot) {
    this.#tool.sentTo?.(spot);
  }
}

const round = (metres) => Math.round(metres * 100) / 100;
