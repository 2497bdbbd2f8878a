/** The form in which somebody says what a routine does, in words or as a program, checked meanwhile. */

import {element} from '/static/page.js';

const TYPED = 400; // milliseconds without a key after which it is checked
const ROWS = 8;

let forms = 0;

/**
 * `ask(method, params, trouble)` asks the server; `of` {language, reader} and the name of one that is
 * changed. `naming`: it gets a name, and a language of `languages`. `onSave(body, trouble)`.
 */
export function bodyForm({words, reader, ask, of, sentence, program, naming = false, languages = {}, onSave, onCancel}) {
  const group = `body-${(forms += 1)}`;
  const name = element('input', {
    class: 'field', maxlength: 200, required: true, autocomplete: 'off', 'aria-describedby': `${group}-hint ${group}-name`,
  });
  const nameTrouble = element('p', {class: 'routine-wrong', role: 'status', id: `${group}-name`});
  const language = element(
    'select', {class: 'field'},
    ...Object.entries(languages).map(([code, own]) => element('option', {value: code, selected: code === of.language}, own)),
  );
  const said = element('textarea', {class: 'field', rows: 2, maxlength: 2000, placeholder: words.sentence_example});
  said.value = sentence;
  const written = element('textarea', {
    class: 'field mono', rows: ROWS, maxlength: 64000, spellcheck: 'false', autocapitalize: 'off', wrap: 'off',
  });
  written.value = program;
  const kinds = ['words', 'program'].map((kind) => {
    const radio = element('input', {type: 'radio', name: group, value: kind, checked: (kind === 'program') === Boolean(program), 'aria-describedby': `${group}-${kind}`});
    return element('div', {}, element('label', {class: 'routine-kind'}, radio, element('span', {}, words[`as_${kind}`])),
      element('small', {class: 'muted', id: `${group}-${kind}`}, words[`as_${kind}_hint`]));
  });
  const saidLabel = element('label', {}, words.sentence, said);
  const writtenLabel = element('label', {}, words.program, written);
  const checked = element('div', {class: 'routine-check', role: 'status'});
  const trouble = element('p', {class: 'routine-wrong', role: 'alert', hidden: true});
  const save = element('button', {class: 'button primary', disabled: true}, words.save);
  const cancel = element('button', {type: 'button', class: 'button quiet'}, words.cancel);
  const form = element('form', {class: 'routine-body', autocomplete: 'off'});
  if (naming) {
    form.append(
      element('div', {class: 'routine-naming'},
        element('div', {}, element('label', {}, words.name, name), element('small', {class: 'muted', id: `${group}-hint`}, words.name_hint)),
        element('label', {}, words.in_language, language)),
      nameTrouble,
    );
  }
  form.append(
    element('fieldset', {}, element('legend', {}, words.how), ...kinds),
    saidLabel, writtenLabel, checked, trouble,
    element('div', {class: 'row'}, save, cancel),
  );

  const kind = () => form.querySelector(`input[name="${group}"]:checked`).value;
  const body = () => ({
    ...(naming ? {name: name.value, language: language.value} : {}),
    ...(kind() === 'program' ? {program: written.value} : {sentence: said.value}),
  });
  let does = null; // what was found last
  let number = 0;
  let typing = 0;

  function show() {
    const asProgram = kind() === 'program';
    saidLabel.hidden = asProgram;
    writtenLabel.hidden = !asProgram;
  }

  async function check() {
    const mine = (number += 1);
    const now = body();
    if (!(now.program ?? now.sentence).trim()) {
      checked.replaceChildren();
      nameTrouble.textContent = '';
      return;
    }
    const found = await ask('check', {...of, ...now}, (why) => mine === number && checked.replaceChildren(element('p', {class: 'outlook bad'}, why)));
    if (!found || mine !== number) return;
    does = found;
    nameTrouble.textContent = found.name && naming ? found.name : '';
    const told = [element('p', {class: found.works ? 'outlook' : 'outlook bad'}, found.does)];
    if (found.works) {
      told.unshift(element('h3', {}, words.would_do));
      if (found.steps.length > 1) {
        told.push(element('details', {}, element('summary', {}, words.steps),
          element('ol', {class: 'routine-reading'}, ...found.steps.map(([depth, text]) => element('li', {style: `--depth: ${depth}`}, text)))));
      }
    }
    checked.replaceChildren(...told);
    save.disabled = !found.works || (naming && (!name.value.trim() || Boolean(found.name)));
  }

  /** Who goes on as a program begins with what the words would do, also before that was found. */
  async function beginWritten() {
    const wanted = () => kind() === 'program' && !written.value.trim();
    if (!wanted() || !said.value.trim()) return;
    const found = does?.written ? does : await ask('check', {...of, ...(naming ? {name: name.value, language: language.value} : {}), sentence: said.value}, () => {});
    if (!found?.written || !wanted()) return;
    written.value = found.written;
    check();
  }

  function changed(event) {
    trouble.hidden = true;
    save.disabled = true; // until this text is checked
    number += 1;
    if (event.target.name === group) {
      beginWritten();
      show();
    }
    clearTimeout(typing);
    typing = setTimeout(check, TYPED);
  }
  form.addEventListener('input', changed);
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    if (save.disabled) return;
    onSave(body(), (why) => {
      trouble.textContent = why;
      trouble.hidden = false;
    });
  });
  cancel.addEventListener('click', onCancel);
  show();
  check();
  return {
    element: form,
    focus: () => (naming ? name : kind() === 'program' ? written : said).focus(),
  };
}
