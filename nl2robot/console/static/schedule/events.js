/** What begins when something happens, above the week: it has no place in a table of days and hours. */

import {element, filled} from '/static/page.js';

/**
 * `events`: those of schedule.list that an event begins. `moment` writes a time; `act` does with an
 * appointment what the buttons of its card do, for whoever `operates`.
 */
export function showEvents(root, events, {words, moment, operates, act}) {
  const focused = document.activeElement?.closest?.('.event');
  const [id, again] = [focused?.dataset.id, document.activeElement?.dataset?.act];
  const button = (name, number) => {
    const made = element('button', {type: 'button', class: 'button small', 'data-act': name}, words[name]);
    made.addEventListener('click', () => act(number, name));
    return made;
  };
  const rows = events.map((listed) => {
    const {appointment: kept, when} = listed;
    const chips = [];
    if (kept.asked) chips.push(element('span', {class: 'chip warn'}, words.waits_for_approval));
    if (kept.paused) chips.push(element('span', {class: 'chip'}, words.paused));
    const acts = operates ? [button(kept.paused ? 'resume' : 'pause', kept.id), button('remove', kept.id)] : [];
    return element(
      'li', {class: `event${kept.asked || kept.paused ? ' rests' : ''}`, 'data-id': kept.id},
      element('div', {class: 'about'},
        element('a', {href: `#appointment-${kept.id}`, lang: kept.language}, kept.sentence), ...chips,
        element('p', {}, when),
        element('p', {class: 'muted'}, `${words.last}: ${howOften(listed, words, moment)}`)),
      element('div', {class: 'row'}, ...acts),
    );
  });
  root.hidden = !rows.length;
  root.replaceChildren(element('h2', {id: 'events-title'}, words.events), element('ul', {}, ...rows));
  if (!id) return;
  const row = root.querySelector(`.event[data-id="${id}"]`);
  const swapped = {pause: 'resume', resume: 'pause'}[again] ?? again;
  (row?.querySelector(`[data-act=${again}]`) ?? row?.querySelector(`[data-act=${swapped}]`))?.focus({preventScroll: true});
}

/** When it came last, and how many times in all. */
export function howOften({last, came}, words, moment) {
  if (last === null) return words.never;
  return filled(came === 1 ? words.so_often_once : words.so_often, {when: moment(last), count: came});
}
