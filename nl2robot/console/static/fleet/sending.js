/** A sentence for the fleet: it becomes a program, which somebody looks at and approves, for the
 * robot that does it best. */

import {element, filled} from '/static/page.js';

export function mountSending(root, {wire, words, language, who, here}) {
  const line = element('input', {class: 'field', id: 'fleet-sentence', maxlength: 500, placeholder: words.send_hint, 'aria-labelledby': 'send-title'});
  const form = element('form', {class: 'row'}, line, element('button', {class: 'button'}, words.look));
  const shown = element('div', {class: 'fleet-review', role: 'status'});
  root.append(element('section', {class: 'card sending', 'aria-labelledby': 'send-title'}, element('h2', {id: 'send-title'}, words.send), form, shown));
  const say = (text) => shown.replaceChildren(element('p', {class: 'warn'}, text));

  function review(sentence, program, found) {
    const approve = element('button', {type: 'button', class: 'button primary'}, words.approve);
    const reject = element('button', {type: 'button', class: 'button'}, words.reject);
    approve.disabled = !(found.acceptable && found.came_through); // as the fleet would say, too
    approve.addEventListener('click', async () => {
      approve.disabled = true;
      const given = {program, sha256: found.sha256, by: who, sentence, language};
      try {
        await wire.request('fleet.run', given);
        shown.replaceChildren();
        line.value = '';
      } catch (error) {
        say(error.message);
      }
    });
    reject.addEventListener('click', () => shown.replaceChildren());
    shown.replaceChildren(
      element('p', {class: found.good ? 'outlook' : 'outlook bad'}, found.outcome),
      element('p', {class: 'muted', id: 'fleet-rehearsed'}, filled(words.rehearsed, {robot: here()})),
      element('ol', {class: 'reading'}, ...found.reading.map(([, depth, text]) => element('li', {style: `margin-left: ${1.2 * depth}rem`}, text))),
      element('pre', {}, program),
      element('ul', {class: 'risks'}, ...found.marks.map(({text}) => element('li', {class: 'warn'}, text))),
      element('div', {class: 'row'}, approve, reject),
    );
    approve.focus();
  }

  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    const sentence = line.value.trim();
    if (!sentence) return;
    try {
      const {program, message} = await wire.request('program.translate', {utterance: sentence, language});
      if (!program) say(message ?? words.not_understood);
      else review(sentence, program, await wire.request('desk.check', {program, language}));
    } catch (error) {
      say(error.message);
    }
  });
}
