/** What somebody is asked by the robot just now, for the desk to answer where they are silent or not there. */

import {element, filled} from '/static/page.js';

const AFTER = 700; // milliseconds: who answers at once needs nobody's help
const AGAIN = 400; // in which a question that was not understood is asked again

/** Show the open question in an element, as long as it is open; what is typed stays when it is asked again. */
export function standIn(root, {wire, words, language, who}) {
  let asked = null;
  let drawn; // the question that can be seen
  let waiting = 0;

  const show = (asking) => {
    clearTimeout(waiting);
    asked = asking;
    if (asked && drawn === asked.question) enable(true);
    else waiting = setTimeout(draw, asked ? AFTER : AGAIN);
  };

  const draw = () => {
    drawn = asked ? asked.question : undefined;
    root.replaceChildren(...(asked ? [form(asked)] : []));
  };

  const enable = (able) => {
    for (const each of root.querySelectorAll('button, input')) each.disabled = !able;
  };

  const answer = async (said) => {
    if (!asked) return;
    enable(false);
    const given = {number: asked.number, answer: said, who, language};
    if (!(await wire.request('face.stand_in', given).catch(() => false))) enable(true);
  };

  const form = ({question, options, called, person}) => {
    const named = person && person !== 'person' ? filled(words.asks_now, {person}) : words.asks_anybody;
    const box = element('form', {class: 'said by-robot question standing-in', 'aria-label': words.answer_for});
    const field = element('input', {
      class: 'field', type: 'text', maxlength: 2000, autocomplete: 'off', 'aria-label': words.answer_for,
      placeholder: words.answer_for,
    });
    const row = element('p', {class: 'row'});
    if (options) {
      row.append(element('span', {class: 'muted'}, words.answer_for));
      for (const [index, option] of options.entries()) {
        const name = called?.[language]?.[index] ?? option;
        const button = element('button', {type: 'button', class: 'suggestion'}, name);
        button.addEventListener('click', () => answer(option));
        row.append(button);
      }
    } else {
      row.append(field, element('button', {class: 'button'}, words.send));
    }
    box.addEventListener('submit', (event) => {
      event.preventDefault();
      const said = field.value.trim();
      if (said && !options) answer(said);
    });
    box.append(element('p', {}, question ? `${named} ${question}` : words.listens), row);
    return box;
  };

  wire.subscribe('face', (change) => 'asking' in change && show(change.asking));
  wire.onChange((connected) => {
    if (connected) wire.request('face.state').then((state) => show(state.asking), () => {});
  });
}
