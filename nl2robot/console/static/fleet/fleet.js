/** The page of the fleet: one map, a card for each robot, what they were given, a stop for all. */

import {appears, element, filled, pageData} from '/static/page.js';
import {notice} from '/static/console.js';
import {wire} from '/static/wire.js';
import {FleetMap} from './map.js';
import {planCards} from './plans.js';
import {mountSending} from './sending.js';

const {words, language, role, unknownAfter} = pageData;
const LOOKS_EVERY = 1000;
const ASKS_EVERY = 5000;

const root = await appears('#fleet');
const stopAll = element('button', {type: 'button', class: 'button danger stop-all', title: words.stop_all_hint}, words.stop_all);
const told = element('ul', {class: 'fleet-told', role: 'status'});
const cards = element('ul', {class: 'robots'});
const given = element('ul', {class: 'errands'});
const planned = element('ul', {class: 'plans'});
const trouble = element('p', {class: 'card warn fleet-trouble', role: 'status', hidden: true});
const drawn = element('div', {class: 'fleet-map'});
root.append(
  element('div', {class: 'row fleet-stop'}, stopAll, told),
  trouble,
  element('section', {class: 'card', 'aria-labelledby': 'fleet-map-title'}, element('h2', {id: 'fleet-map-title'}, words.map), drawn),
  element('section', {'aria-labelledby': 'robots-title'}, element('h2', {id: 'robots-title'}, words.robots), cards),
  element('section', {class: 'card', 'aria-labelledby': 'errands-title'}, element('h2', {id: 'errands-title'}, words.errands), given),
  element('section', {class: 'card', 'aria-labelledby': 'plans-title'}, element('h2', {id: 'plans-title'}, words.plans), planned),
);
const map = new FleetMap(drawn, words);
let members = [];
let errands = [];
let at = 0; // when that was told, by the clock of this browser
const here = () => members.find((member) => member.here)?.name ?? '';
if (role === 'operator') mountSending(root, {wire, words, language, who: pageData.who, here});

/** Seconds since a robot was heard of; the server's count goes on here. */
const age = (member) => (member.here && wire.connected ? 0 : member.heard + (performance.now() - at) / 1000);
const isKnown = (member) => Boolean(member.about && member.standing) && !member.left && age(member) < unknownAfter;

function inWords(seconds) {
  return seconds < 120
    ? filled(words.seconds, {count: Math.round(seconds)})
    : filled(words.minutes, {count: Math.round(seconds / 60)});
}

function card(member) {
  const {name, standing, about} = member;
  const known = isKnown(member);
  const state = known ? words[`state_${standing.state}`] : words.unknown;
  const tone = !known ? 'warn' : {running: 'accent', idle: 'good', charging: 'good', stopped: 'bad', lost: 'bad', stopping: 'bad'}[standing.state];
  const made = element('li', {class: `card robot ${known ? '' : 'unknown'}`, id: `robot-${member.id}`});
  const head = element('header', {class: 'row'}, element('h3', {}, name), element('span', {class: `chip ${tone ?? ''}`}, state));
  if (member.here) head.append(element('span', {class: 'chip'}, words.here));
  made.append(head);
  if (member.twin) made.append(element('p', {class: 'warn'}, filled(words.twin, {id: member.id})));
  if (!known) {
    const silent = about && standing ? filled(words.not_heard, {age: inWords(age(member))}) : words.never_heard;
    made.append(element('p', {class: 'warn'}, silent));
  } else {
    const place = member.same_map ? standing.place || words.no_place : filled(words.other_map, {world: about.world});
    made.append(element('p', {}, `${words.place}: ${place}`));
    if (standing.battery != null) made.append(element('p', {}, `${words.battery}: ${Math.round(standing.battery)} %`));
    if (standing.driven_by) made.append(element('p', {}, filled(words.driven_by, {who: standing.driven_by})));
    if (standing.because) made.append(element('p', {class: 'muted'}, standing.because));
  }
  const stop = element('button', {type: 'button', class: 'button small danger'}, filled(words.stop_one, {name}));
  stop.addEventListener('click', () => stopThem({robot: member.id}));
  made.append(stop);
  return made;
}

function errand(each) {
  const values = {robot: each.robot_name ?? '', who: each.by};
  const made = element(
    'li',
    {class: 'errand', id: `errand-${each.id}`, 'data-state': each.state},
    element('strong', {}, each.sentence || each.program.split('\n')[0]),
    element('span', {class: 'chip'}, filled(words[`errand_${each.state}`] ?? each.state, values)),
    element('span', {class: 'muted'}, filled(words.errand_by, values)),
  );
  if (each.message) made.append(element('span', {}, each.message));
  for (const [name, why] of Object.entries(each.refused)) {
    if (['looking', 'nobody'].includes(each.state)) made.append(element('span', {class: 'muted'}, `${name}: ${why}`));
  }
  if (each.state === 'looking' && role === 'operator') {
    const off = element('button', {type: 'button', class: 'button small'}, words.call_off);
    off.addEventListener('click', () => wire.request('fleet.call_off', {errand: each.id}).catch((error) => notice(error.message)));
    made.append(off);
  }
  return made;
}

let before = '';

/** What has changed is drawn anew; a button that somebody is about to press stays where it is. */
function show() {
  const now = JSON.stringify([members.map((each) => ({...each, heard: isKnown(each) ? 0 : Math.round(age(each))})), errands]);
  map.show(members.filter((each) => each.same_map && each.standing?.x != null).map((each) => ({...each, known: isKnown(each)})));
  if (now === before) return;
  before = now;
  cards.replaceChildren(...members.map(card));
  given.replaceChildren(...(errands.length ? errands.map(errand) : [element('li', {class: 'muted'}, words.no_errands)]));
}

function take(found) {
  ({members, errands} = found);
  trouble.textContent = found.trouble?.[language] ?? '';
  trouble.hidden = !found.trouble;
  at = performance.now();
  show();
  root.dataset.ready = 'yes';
}

/** Also when nothing was said: whether a keeper is heard of is told by its silence. */
async function takePlans() {
  const kept = await wire.request('fleet.plans', {language}).catch(() => null);
  if (!kept) return;
  const cards = planCards(kept, {words, language});
  planned.replaceChildren(...(cards.length ? cards : [element('li', {class: 'muted'}, words.no_plans)]));
}

async function stopThem(whom) {
  told.replaceChildren(element('li', {}, words.stopping_all));
  try {
    const answers = await wire.request('fleet.stop', whom);
    told.replaceChildren(
      ...answers.map(({name, confirmed, answered}) => {
        const how = confirmed ? 'stands' : answered ? 'moves' : 'silent';
        return element('li', {class: confirmed ? 'good' : 'bad'}, filled(words[how], {name}));
      }),
    );
  } catch (error) {
    told.replaceChildren(element('li', {class: 'bad'}, error.message));
  }
}

stopAll.addEventListener('click', () => stopThem({}));
wire.subscribe('fleet', take);
wire.subscribe('fleet.plans', takePlans);
wire.onChange(async (connected) => {
  if (!connected) return;
  const [floor, found] = await Promise.all([wire.request('scene.floor', {language}).catch(() => null), wire.request('fleet.list')]);
  if (floor) map.draw(floor, language);
  take(found);
  takePlans();
});
setInterval(show, LOOKS_EVERY);
setInterval(() => document.hidden || takePlans(), ASKS_EVERY);
