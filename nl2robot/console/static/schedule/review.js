/** The program of an appointment with a review made now, and its approval anew. As at the desk, it
 * can be approved only when all of it has been on the screen. */

import {element} from '/static/page.js';
import {dayAfter, endOf} from '/static/schedule/days.js';

const HOLDS = 30; // days
const BAR = 76; // pixels of the header, which lies over the page

/** `approve(sha256, until, insists)`; null for who only looks on. It is reviewed as it would go when it is `due` (seconds since the epoch). */
export async function reviewPanel(panel, {wire, words, language, appointment, due, approve, today, zone}) {
  const program = element('ol', {class: 'code'}, ...appointment.program.trimEnd().split('\n').map((line) => element('li', {}, element('code', {}, line || ' '))));
  const heading = element('h4', {}, words.program);
  if (!approve) return panel.replaceChildren(heading, program);
  const status = element('p', {role: 'status', class: 'muted'}, words.checking);
  panel.replaceChildren(status, heading, program);
  let found;
  try {
    found = await wire.request('desk.check', {program: appointment.program, language, ...(due && {at: new Date(1000 * due).toISOString()})});
  } catch (error) {
    return (status.textContent = error.message);
  }
  const told = element('div', {class: 'found'}, ...outcome(found, words));
  panel.replaceChildren(told, heading, program, ...decision(panel, {found, words, approve, today, zone}));
  return undefined;
}

function outcome({outcome: sentence, good, facts, marks, reading}, words) {
  const shown = [element('p', {class: good ? 'outlook' : 'outlook bad'}, sentence)];
  if (facts.length) {
    const list = element('dl', {class: 'facts'});
    for (const [heading, items] of facts) {
      list.append(element('dt', {}, heading), element('dd', {}, ...items.map((item) => element('span', {}, item))));
    }
    shown.push(list);
  }
  if (marks.length) {
    shown.push(element('ul', {class: 'marks'}, ...marks.map(({weight, text}) => element('li', {class: `mark ${weight}`}, text))));
  }
  if (reading.length) {
    const lines = reading.map(([line, depth, text]) => {
      const told = element('li', {}, element('span', {class: 'number', 'aria-label': `${words.line} ${line}`}, String(line)), element('span', {}, text));
      told.style.setProperty('--depth', depth);
      return told;
    });
    shown.push(element('h4', {}, words.in_words), element('ol', {class: 'reading'}, ...lines));
  }
  return shown;
}

function decision(panel, {found, words, approve, today, zone}) {
  if (!found.acceptable) return [element('p', {class: 'outlook bad'}, words.cannot)];
  const field = element('input', {type: 'date', class: 'field', value: dayAfter(today, HOLDS), min: today, max: dayAfter(today, 365), required: true});
  const button = element(
    'button', {type: 'submit', class: `button ${found.came_through ? 'primary' : 'warning'}`, disabled: true},
    found.came_through ? words.approve : words.approve_open,
  );
  const hint = element('p', {class: 'muted', role: 'status'}, words.read_first);
  const form = element('form', {class: 'row approve'}, element('label', {}, words.form_until, field), button);
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    button.disabled = true;
    await approve(found.sha256, endOf(field.value, zone), !found.came_through);
    button.disabled = false;
  });
  onceSeen(panel, () => {
    button.disabled = false;
    hint.textContent = '';
  });
  return [hint, form];
}

/** Call back once every part has been on the screen, below the bar; of one that is higher than the
 * screen, most of what fits. */
function onceSeen(panel, done) {
  requestAnimationFrame(() => {
    const left = new Set(panel.querySelectorAll('.outlook, .facts dd, .mark, .code li'));
    const watcher = new IntersectionObserver(
      (changes) => {
        for (const {target, isIntersecting, intersectionRatio, intersectionRect, rootBounds} of changes) {
          const whole = intersectionRatio > 0.95 || intersectionRect.height > 0.6 * (rootBounds?.height ?? innerHeight);
          if (!isIntersecting || !whole || !left.delete(target)) continue;
          watcher.unobserve(target);
        }
        if (left.size) return;
        watcher.disconnect();
        done();
      },
      {rootMargin: `-${BAR}px 0px 0px 0px`, threshold: [0.1, 0.25, 0.5, 0.75, 0.96, 1]},
    );
    for (const each of left) watcher.observe(each);
  });
}
