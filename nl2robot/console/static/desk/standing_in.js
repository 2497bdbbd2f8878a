/** What somebody is asked by the robot just now, for the desk to answer where they are silent or not there. */

import {element, filled} from '/static/page.js';

const AFTER = 700; // milliseconds: who answers at once needs nobody's help

/** Show the open question in an element, as long as it is open. */
export function standIn(root, {wire, words, language, who}) {
  let shown = null;
  let waiting = 0;

  const show = (asking) => {
    clearTimeout(waiting);
    if (asking?.number === shown) return;
    shown = asking?.number ?? null;
    root.replaceChildren();
    if (asking) waiting = setTimeout(() => root.replaceChildren(form(asking)), AFTER);
  };

  const answer = async (number, said, controls) => {
    for (const each of controls) each.disabled = true;
    const given = await wire
      .request('face.stand_in', {number, answer: said, who, language})
      .catch(() => false);
    if (!given) for (const each of controls) each.disabled = false;
  };

  const form = ({number, question, options, person}) => {
    const named = person && person !== 'person' ? filled(words.asks_now, {person}) : words.asks_anybody;
    const box = element('form', {class: 'said by-robot question standing-in', 'aria-label': words.answer_for});
    const field = element('input', {
      class: 'field', type: 'text', maxlength: 2000, autocomplete: 'off', 'aria-label': words.answer_for,
      placeholder: words.answer_for,
    });
    const row = element('p', {class: 'row'});
    if (options) {
      row.append(element('span', {class: 'muted'}, words.answer_for));
      for (const option of options) {
        const button = element('button', {type: 'button', class: 'suggestion'}, option);
        button.addEventListener('click', () => answer(number, option, row.querySelectorAll('button')));
        row.append(button);
      }
    } else {
      row.append(field, element('button', {class: 'button'}, words.send));
    }
    box.addEventListener('submit', (event) => {
      event.preventDefault();
      const said = field.value.trim();
      if (said && !options) answer(number, said, row.querySelectorAll('button, input'));
    });
    box.append(element('p', {}, question ? `${named} ${question}` : words.listens), row);
    return box;
  };

  wire.subscribe('face', (change) => 'asking' in change && show(change.asking));
  wire.onChange((connected) => {
    if (connected) wire.request('face.state').then((state) => show(state.asking), () => {});
  });
}
