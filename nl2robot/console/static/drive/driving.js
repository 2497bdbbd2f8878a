/** Who drives, how the robot is, the joystick, and where to go. */

import {element, pageData} from '/static/page.js';
import {wire} from '/static/wire.js';
import {helm} from './helm.js';
import {Joystick, SPEEDS} from './joystick.js';
import {button, controls, doing, labelled, newId, panel} from './panel.js';
import {robot} from './robot.js';
import {clock, say, spoken} from './texts.js';

const SPEED_KEPT = 'drive-speed';

// --- who drives, and how the robot is

/** With `more` buttons beside those of the helm. */
export function helmBar(body, operates, ...more) {
  const who = element('p', {class: 'who', role: 'status'});
  const take = button(say('take'), () => helm.take(), {class: 'primary'});
  const give = button(say('let_go'), () => helm.give());
  const asking = element('div', {class: 'asking', role: 'alert'});
  const tools = element('div', {class: 'row'}, take, give, ...more.filter(Boolean));
  const program = element('a', {class: 'chip warn', href: '/'}, say('program_runs'));
  const bar = element('section', {class: 'card helm', 'aria-label': say('helm_title')});
  bar.append(element('div', {class: 'helm-who'}, element('span', {class: 'lamp'}), who));
  if (operates) bar.append(tools);
  const chips = vitals(body);
  chips.prepend(program);
  bar.append(chips, asking);
  helm.onChange(() => {
    const {state, mine} = helm;
    bar.dataset.helm = mine ? 'mine' : state.driver ? 'taken' : 'free';
    who.textContent = whoDrives(state, mine);
    take.hidden = mine;
    take.disabled = helm.me === null;
    take.textContent = say(helm.asked ? 'ask_again' : state.driver ? 'ask' : 'take');
    give.hidden = !mine;
    program.hidden = !helm.program;
    asking.replaceChildren(...(mine ? state.asking.map(request) : []));
  });
  return bar;
}

function whoDrives(state, mine) {
  if (mine) return say('you_drive');
  if (state.driver === null) return say('nobody_drives');
  const told = say('somebody_drives', {who: state.who, time: clock(state.since)});
  return helm.asked ? `${told} ${say('asked')}` : told;
}

function request(asking) {
  return element(
    'div',
    {class: 'row request'},
    element('p', {}, say('wants', {who: asking.who})),
    button(say('hand_over'), () => helm.give(asking.connection), {class: 'primary small'}),
    button(say('keep'), () => helm.keep(), {class: 'small'}),
  );
}

function vitals(body) {
  const place = element('span', {class: 'chip', 'data-vital': 'place'});
  const speed = element('span', {class: 'chip', 'data-vital': 'speed'});
  const battery = element('span', {class: 'chip', 'data-vital': 'battery'});
  const names = new Map(body.places.map((each) => [each.name, spoken(each)]));
  const showPose = (pose) => {
    if (!pose) return;
    const at = `${pose.x.toFixed(1)}, ${pose.y.toFixed(1)} · ${Math.round(pose.theta)}°`;
    place.textContent = `${names.get(pose.place) ?? pose.place ?? say('nowhere')} (${at})`;
    speed.textContent = `${Math.abs(pose.speed ?? 0).toFixed(2)} m/s`;
    speed.dataset.speed = pose.speed ?? 0;
  };
  const showBattery = (state) => {
    if (!state) return;
    battery.textContent = `${say('battery')} ${state.percent} %${state.charging ? ' ⚡' : ''}`;
    battery.classList.toggle('bad', state.percent < 15);
    battery.classList.toggle('warn', state.percent >= 15 && state.percent < 30);
  };
  robot.follow('pose', showPose);
  robot.follow('battery', showBattery);
  return element('div', {class: 'row vitals'}, place, speed, battery);
}

// --- the joystick

/** `grasped` is called when somebody takes hold of it. */
export function joystickPanel(body, grasped) {
  const {speed = Infinity, turn_rate: turnRate = Infinity} = body.limits;
  const speeds = SPEEDS.map(({linear, angular}) => ({
    linear: Math.min(linear, speed),
    angular: Math.min(angular, turnRate),
  }));
  const knob = element('div', {class: 'knob'});
  const stick = element(
    'div',
    {class: 'stick', tabindex: 0, role: 'application', 'aria-label': say('stick')},
    ...['up', 'right', 'down', 'left'].map((way) => element('span', {class: `tick ${way}`})),
    knob,
  );
  const hint = element('p', {class: 'stick-hint', role: 'status'});
  const range = element('input', {type: 'range', min: 0, max: speeds.length - 1, step: 1});
  range.value = localStorage.getItem(SPEED_KEPT) ?? 1;
  const shown = element('output', {class: 'value'});
  const showSpeed = () => {
    const {linear} = speeds[range.value];
    const name = say(`speed_${range.value}`);
    shown.textContent = `${name} · ${linear} m/s`;
    range.setAttribute('aria-valuetext', name);
    range.style.setProperty('--part', `${(range.value / (speeds.length - 1)) * 100}%`);
    localStorage.setItem(SPEED_KEPT, range.value);
  };
  range.addEventListener('input', showSpeed);
  // The arrow keys go back to the joystick.
  range.addEventListener('pointerup', () => stick.focus({preventScroll: true}));
  showSpeed();
  let trouble = '';
  const show = () => {
    const waiting = say(helm.mine ? 'program_drives' : 'stick_no_helm');
    hint.textContent = helm.moves ? trouble || say('stick_hint') : waiting;
    hint.classList.toggle('trouble', Boolean(helm.moves && trouble));
  };
  new Joystick(stick, knob, () => speeds[range.value], (told) => {
    if (told.moving) grasped();
    if (told.moving || told.obeyed) trouble = '';
    if (told.slow) trouble = say('slow_connection');
    if (told.error) trouble = told.error.message;
    show();
  });
  helm.onChange(() => {
    stick.classList.toggle('off', !helm.moves);
    stick.setAttribute('aria-disabled', String(!helm.moves));
    show();
  });
  const slider = element('div', {class: 'slider'});
  range.id = newId('slider');
  slider.append(element('label', {for: range.id}, say('speed')), shown, range);
  return panel('stick', element('div', {class: 'controls stick-place'}, stick, hint, slider));
}

// --- where to go

/** The panel, and `run(method, given)` for other movements that take their time. */
export function goPanel(body) {
  const has = (method) => body.methods.includes(method);
  const list = element('div', {class: 'choices places', role: 'radiogroup'});
  list.setAttribute('aria-label', say('places'));
  const filter = element('input', {class: 'field', type: 'search', placeholder: say('filter')});
  const group = newId('place');
  const rows = body.places.map((place) => {
    const input = element('input', {type: 'radio', name: group, value: place.name});
    const row = element('label', {class: 'choice'}, input, element('span', {}, spoken(place)));
    const known = [place.name, place.kind, ...Object.values(place.aliases).flat()];
    row.dataset.known = known.join(' ').toLowerCase();
    return row;
  });
  list.append(...rows);
  filter.addEventListener('input', () => {
    const wanted = filter.value.trim().toLowerCase();
    for (const row of rows) row.hidden = !row.dataset.known.includes(wanted);
  });
  const chosen = () => list.querySelector('input:checked')?.value;
  const errand = errandLine();
  const go = button(say('go'), () => errand.run('goto', {place: chosen()}), {class: 'primary'});
  const here = button(say('here'), () => helm.call('localize', {place: chosen()}));
  here.title = say('here_hint');
  const dock = button(say('dock'), () => errand.run('dock'));
  const enable = () => (go.disabled = here.disabled = chosen() === undefined);
  list.addEventListener('change', enable);
  enable();
  const offered = [has('goto') && go, has('localize') && here, has('dock') && dock].filter(Boolean);
  const tools = element('div', {class: 'row'}, ...offered);
  const search = labelled(say('find_place'), filter);
  // Who does not drive may look through the places as well.
  const places = element('div', {class: 'controls'}, search, list);
  const section = panel('go', errand.line, places, controls(tools));
  return {section, run: errand.run, cancel: errand.cancel};
}

/** A movement that takes its time: it says so, can be cancelled, and makes way for another. */
function errandLine() {
  let running = null;
  const cancel = async () => {
    const broken = running;
    await broken?.cancel();
    await broken?.answer.catch(() => {});
  };
  const away = button(say('cancel'), cancel, {class: 'small'});
  const text = element('span', {}, say('on_the_way'));
  const line = element('p', {class: 'row errand', role: 'status', hidden: true}, text, away);
  const run = async (method, given = {}) => {
    await cancel();
    const mine = (running = helm.errand(method, given));
    line.hidden = false;
    try {
      await mine.answer;
    } finally {
      if (running === mine) {
        running = null;
        line.hidden = true;
      }
    }
  };
  return {line, run, cancel};
}

/** The floor plan; with `run`, a click sends the robot and a drag says where it is. */
export async function mountMap(place, language, run) {
  const {mountFloorMap} = await import('/static/floor/floor_map.js');
  const {proposeClicks} = await import('/static/floor/sending.js');
  const modes = ['look', 'send', 'localise'];
  const map = await mountFloorMap(place, {
    ...{wire, language, modes, who: pageData.who, operator: Boolean(run), places: false},
    localise: (pose) => doing(helm.call('localize', pose)),
  });
  proposeClicks(map, {
    wire,
    language,
    propose: ({place: name, x, y, note}) => {
      map.showNote(note);
      doing(run('goto', name ? {place: name} : {x, y}));
    },
  });
}
