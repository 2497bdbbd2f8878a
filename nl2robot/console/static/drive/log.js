/** The robot's log, as it is written: by levels, searched, the newest line at the end. */

import {element} from '/static/page.js';
import {wire} from '/static/wire.js';
import {button, labelled, panel} from './panel.js';
import {say} from './texts.js';

const MOST_LINES = 1000;
const LEVELS = ['info', 'warning', 'error'];

export function logPanel() {
  const list = element('ol', {class: 'log', tabindex: 0, 'aria-label': say('log_title')});
  const level = element('select', {class: 'field'});
  level.append(...LEVELS.map((name) => element('option', {value: name}, say(`level_${name}`))));
  const search = element('input', {class: 'field', type: 'search', placeholder: say('filter')});
  const count = element('p', {class: 'muted', role: 'status'});
  const shows = (line) =>
    LEVELS.indexOf(line.dataset.level) >= LEVELS.indexOf(level.value) &&
    line.textContent.toLowerCase().includes(search.value.trim().toLowerCase());
  const atEnd = () => list.scrollHeight - list.scrollTop - list.clientHeight < 40;
  const toEnd = () => (list.scrollTop = list.scrollHeight);
  const filter = () => {
    let shown = 0;
    for (const line of list.children) {
      line.hidden = !shows(line);
      shown += line.hidden ? 0 : 1;
    }
    const all = list.children.length;
    count.textContent = shown === all ? '' : say('log_found', {shown, all});
    toEnd();
  };
  const add = (entry) => {
    const stays = atEnd();
    if (!again(list.lastElementChild, entry)) {
      const line = lineOf(entry);
      line.hidden = !shows(line);
      list.append(line);
      if (list.children.length > MOST_LINES) list.firstElementChild.remove();
    }
    if (stays) toEnd();
  };
  level.addEventListener('change', filter);
  search.addEventListener('input', filter);
  const clear = button(say('log_clear'), async () => list.replaceChildren(), {class: 'small'});
  wire.subscribe('log', add);
  wire.request('helm.log', {lines: 200}).then((entries) => {
    list.replaceChildren();
    entries.forEach(add);
    toEnd();
  });
  const tools = element(
    'div',
    {class: 'log-tools'},
    labelled(say('log_level'), level),
    labelled(say('log_search'), search),
    clear,
  );
  return panel('log', tools, count, list);
}

/** Whether it is the last line once more, which then only counts up: the joystick writes ten lines
 * a second. */
function again(line, {level, message}) {
  const same = line?.dataset.same === sameness(message) && line.dataset.level === level;
  if (!same) return false;
  const times = Number(line.dataset.times) + 1;
  line.dataset.times = times;
  line.querySelector('.message').textContent = message;
  line.querySelector('.times').textContent = ` × ${times}`;
  return true;
}

function lineOf({level, message, time}) {
  const line = element(
    'li',
    {},
    element('time', {}, time),
    element('span', {class: 'level'}, say(`level_name_${level}`)),
    element('span', {class: 'message'}, message),
    element('span', {class: 'times muted'}),
  );
  Object.assign(line.dataset, {level, same: sameness(message), times: 1});
  return line;
}

/** What two lines have in common that tell the same: movements of the joystick, all they say. */
function sameness(message) {
  return message.replace(/^drive(\(.*\)|: stopped)$/, 'drive');
}
