/** Routines from a file or a link: looked at, chosen, and only then taken over. */

import {element, filled} from '/static/page.js';

const LARGEST = 1_000_000;
const LONGEST_LINK = 8_000; // letters; mail programs break longer ones

/** A link that carries this text; null if it would be too long. It never reaches a server's log:
 * what stands behind # stays in the browser. */
export function linkOf(text) {
  const bytes = new TextEncoder().encode(text);
  const packed = btoa(String.fromCharCode(...bytes)).replaceAll('+', '-').replaceAll('/', '_').replace(/=+$/, '');
  return packed.length > LONGEST_LINK ? null : `${location.origin}/routines#import=${packed}`;
}

/** What a link carries; null if it is broken. */
export function textOfLink(packed) {
  try {
    const bytes = Uint8Array.from(atob(packed.replaceAll('-', '+').replaceAll('_', '/')), (c) => c.charCodeAt(0));
    return new TextDecoder('utf-8', {fatal: true}).decode(bytes);
  } catch {
    return null;
  }
}

/** `given`: the text of a link; else a file is asked for. `onKept(kept)` when some were taken over. */
export function importPanel({words, reader, ask, given, languages, onKept, onCancel}) {
  const input = element('input', {type: 'file', class: 'field', accept: '.yaml,.yml,.json,application/yaml,application/json'});
  const found = element('div', {class: 'routine-found', 'aria-live': 'polite'});
  const cancel = element('button', {type: 'button', class: 'button quiet'}, words.cancel);
  const root = element('div', {class: 'routine-import'});
  if (!given) root.append(element('p', {class: 'muted'}, words.import_hint), element('label', {}, words.choose_file, input));
  root.append(found, cancel);
  cancel.addEventListener('click', onCancel);

  function refuse(why) {
    // All that is wrong with a file, each in its line.
    const lines = why.split('\n').map((line) => element('li', {}, line));
    found.replaceChildren(element('ul', {class: 'routine-wrong', role: 'alert'}, ...lines));
  }

  async function look(text, file) {
    const looked = await ask('import', {text, file, reader}, refuse);
    if (looked) offer(looked.found, text, file);
  }

  function offer(routines, text, file) {
    const rows = routines.map((routine, number) => row(routine, number));
    const trouble = element('ul', {class: 'routine-wrong', role: 'alert', hidden: true});
    const go = element('button', {type: 'button', class: 'button primary'}, words.import_chosen);
    const chosen = () => rows.filter((each) => each.take.checked && !each.take.disabled);
    const enable = () => (go.disabled = chosen().length === 0);
    go.addEventListener('click', async () => {
      const keep = chosen().map((each) => ({number: each.number, name: each.name.value, replace: each.replace.checked}));
      const done = await ask('import', {text, file, reader, keep}, (why) => {
        trouble.replaceChildren(element('li', {}, why));
        trouble.hidden = false;
      });
      if (done) onKept(done.kept);
    });
    found.replaceChildren(
      ...(given ? [] : [element('h3', {}, filled(words.found_in, {file}))]),
      element('ul', {class: 'routine-offers'}, ...rows.map((each) => each.element)),
      trouble, go,
    );
    found.addEventListener('input', enable);
    enable();
    (rows.find((each) => !each.take.disabled)?.take ?? cancel).focus();
  }

  /** A routine of the file, with what is to become of it. */
  function row(routine, number) {
    const known = routine.state === 'same';
    const taken = routine.state === 'taken';
    const take = element('input', {type: 'checkbox', checked: routine.state === 'new', disabled: known});
    const name = element('input', {class: 'field', maxlength: 200, value: routine.name, autocomplete: 'off', lang: routine.language});
    const replace = element('input', {type: 'checkbox'});
    const shown = [
      element('label', {class: 'routine-take'}, take,
        element('span', {}, element('strong', {lang: routine.language}, routine.name),
          routine.language === reader ? '' : ` (${languages[routine.language] ?? routine.language})`)),
      element('p', {class: routine.works ? '' : 'bad'}, routine.does),
    ];
    if (routine.sentence) shown.push(element('p', {class: 'routine-said', lang: routine.language}, element('q', {}, routine.sentence)));
    if (routine.written) {
      shown.push(element('details', {}, element('summary', {}, words.steps),
        element('ol', {class: 'routine-reading'}, ...routine.steps.map(([depth, text]) => element('li', {style: `--depth: ${depth}`}, text))),
        element('pre', {class: 'code', tabindex: 0, 'aria-label': words.program}, element('code', {}, routine.written))));
    }
    if (known) shown.push(element('p', {class: 'muted'}, words.same));
    if (taken || routine.state === 'unfit') {
      const naming = element('label', {}, words.name, name);
      shown.push(element('p', {class: 'routine-asks'}, taken ? words.taken : routine.why), naming);
      name.addEventListener('input', () => (take.checked = name.value.trim() !== routine.name || replace.checked));
      if (taken) {
        shown.push(element('label', {class: 'routine-take'}, replace, element('span', {}, words.replace)));
        replace.addEventListener('input', () => {
          take.checked = replace.checked;
          name.disabled = replace.checked;
          if (replace.checked) name.value = routine.name;
        });
      }
    }
    return {number, take, name, replace, element: element('li', {}, ...shown)};
  }

  input.addEventListener('change', async () => {
    const [file] = input.files;
    if (!file) return;
    if (file.size > LARGEST) return refuse(words.file_too_large);
    let text;
    try {
      text = new TextDecoder('utf-8', {fatal: true}).decode(await file.arrayBuffer());
    } catch {
      input.value = '';
      return refuse(words.file_unreadable);
    }
    input.value = ''; // the same file, mended, may be chosen again
    look(text, file.name);
  });
  if (given) look(given, words.link);
  return {element: root, focus: () => (given ? cancel : input).focus()};
}
