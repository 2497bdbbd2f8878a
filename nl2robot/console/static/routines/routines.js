/** The page of the routines: cards that are run, tested, changed and handed on. */

import {appears, element, filled, pageData} from '/static/page.js';
import {wire} from '/static/wire.js';
import {bodyForm} from '/static/routines/body_form.js';
import {importPanel, linkOf, textOfLink} from '/static/routines/exchange.js';

const {words, language: reader, role, who} = pageData;

const root = await appears('[data-routines]');
const part = (name) => root.querySelector(`[data-part=${name}]`);
const panel = part('panel');
let openedBy = null; // the button whose panel is open at the top

// --- telling

/** Say what came of something; `undo` {text, act}: a button beside it. */
function tell(sentence, {undo = null, bad = false} = {}) {
  const told = element('p', {class: `card routines-notice${bad ? ' bad' : ''}`}, sentence);
  if (undo) {
    const button = element('button', {type: 'button', class: 'button small'}, undo.text);
    button.addEventListener('click', undo.act);
    told.append(' ', button);
  }
  part('told').replaceChildren(told);
}

/** Ask the robot's server; what it refuses is told where somebody looks. */
async function ask(method, params, trouble = null) {
  try {
    return await wire.request(`routines.${method}`, params);
  } catch (error) {
    if (trouble) trouble(error.message);
    else tell(error.message, {bad: true});
    return null;
  }
}

// --- the cards

const keyOf = (card) => JSON.stringify([card.dataset.language, card.dataset.name]);
const cardOf = (name, language) =>
  [...root.querySelectorAll('.routine')].find((each) => keyOf(each) === JSON.stringify([language, name]));
const of = (card) => ({name: card.dataset.name, language: card.dataset.language, reader});
const panelOf = (card) => card.querySelector('.routine-panel');

let looking = 0;

/** Fetch the cards anew. One in which somebody is at work stays as it is, if it is still there. */
async function refresh() {
  const number = (looking += 1);
  const response = await fetch('/routines/cards').catch(() => null);
  if (!response?.ok || number !== looking) return;
  const fresh = document.createElement('div');
  fresh.innerHTML = await response.text();
  const focused = document.activeElement?.closest?.('.routine');
  for (const card of fresh.querySelectorAll('.routine')) {
    const old = cardOf(card.dataset.name, card.dataset.language);
    if (old && panelOf(old) && !panelOf(old).hidden) card.replaceWith(old);
    else if (old?.querySelector('details')?.open && card.querySelector('details')) card.querySelector('details').open = true;
  }
  const key = focused ? keyOf(focused) : null;
  part('cards').replaceChildren(...fresh.childNodes);
  const cards = root.querySelectorAll('.routine').length;
  root.querySelector('[data-way=export]').hidden = cards === 0;
  root.querySelector('.routines-filter').hidden = cards < 2;
  sift();
  if (key && !document.activeElement?.closest('.routine')) {
    const again = [...root.querySelectorAll('.routine')].find((card) => keyOf(card) === key);
    again?.querySelector('h2').focus();
  }
}

/** Hide what does not go by what is looked for. */
function sift() {
  const wanted = root.querySelector('.routines-filter input').value.trim().toLowerCase();
  let shown = 0;
  for (const card of root.querySelectorAll('.routine')) {
    card.hidden = wanted !== '' && !card.textContent.toLowerCase().includes(wanted);
    shown += card.hidden ? 0 : 1;
  }
  part('cards').querySelector('.none-fits')?.remove();
  if (wanted && !shown) part('cards').append(element('p', {class: 'card routines-none none-fits', role: 'status'}, words.none_fits));
}

/** Show something in a card, in the place of what was there; the button that did it says so. */
function open(card, button, ...shown) {
  const at = panelOf(card);
  for (const other of card.querySelectorAll('[data-act][aria-expanded]')) other.setAttribute('aria-expanded', 'false');
  if (button?.hasAttribute('aria-expanded')) button.setAttribute('aria-expanded', 'true');
  at.dataset.act = button?.dataset.act ?? '';
  at.replaceChildren(...shown);
  at.hidden = false;
}

function shut(card) {
  const at = panelOf(card);
  const act = at.dataset.act;
  at.hidden = true;
  at.replaceChildren();
  const button = card.querySelector(`[data-act="${act}"]`);
  for (const other of card.querySelectorAll('[data-act][aria-expanded]')) other.setAttribute('aria-expanded', 'false');
  button?.focus();
}

function closer(card, text = words.close) {
  const button = element('button', {type: 'button', class: 'button quiet'}, text);
  button.addEventListener('click', () => shut(card));
  return button;
}

// --- what is done with one

/** What the dry run said. */
function outcome(tested) {
  const shown = [element('p', {class: tested.good ? 'outlook' : 'outlook bad'}, tested.outcome)];
  if (tested.facts.length) {
    const facts = element('dl', {class: 'routine-tested-facts'});
    for (const [heading, items] of tested.facts) {
      facts.append(element('dt', {}, heading), element('dd', {}, ...items.map((item) => element('span', {}, item))));
    }
    shown.push(facts);
  }
  if (tested.marks.length) {
    shown.push(
      element('ul', {class: 'routine-marks'}, ...tested.marks.map(({weight, text}) => element('li', {class: `mark ${weight}`}, text))),
    );
  }
  if (tested.picture) {
    // As a picture of its own: nothing in it is carried out, and its names stay its own.
    const source = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(tested.picture)}`;
    shown.push(element('img', {class: 'routine-picture', src: source, alt: words.picture_of}));
  }
  return shown;
}

async function test(card, button) {
  if (button.getAttribute('aria-disabled') === 'true') return null;
  const status = element('p', {role: 'status', class: 'muted'}, words.testing);
  const inside = element('div', {'aria-live': 'polite', class: 'routine-test'}, status);
  open(card, button, inside, closer(card));
  button.setAttribute('aria-disabled', 'true'); // not "disabled": the focus would be lost
  const tested = await ask('test', of(card), (why) => inside.replaceChildren(element('p', {class: 'outlook bad'}, why)));
  button.removeAttribute('aria-disabled');
  if (tested) inside.replaceChildren(...outcome(tested), element('p', {class: 'muted'}, words.tested));
  return tested;
}

async function review(card, button) {
  const accept = element('button', {type: 'button', class: 'button primary', disabled: true}, words.accept);
  const inside = element('div', {'aria-live': 'polite'}, element('p', {class: 'muted'}, words.testing));
  open(card, button, element('p', {}, words.review_it), inside, element('div', {class: 'row'}, accept, closer(card)));
  const steps = card.querySelector('details');
  if (steps) steps.open = true;
  const seen = card.dataset.sha256;
  const tested = await ask('test', of(card), (why) => inside.replaceChildren(element('p', {class: 'outlook bad'}, why)));
  if (tested) inside.replaceChildren(...outcome(tested));
  accept.disabled = !tested;
  accept.addEventListener('click', async () => {
    const done = await ask('accept', {...of(card), sha256: seen, by: who});
    if (!done) return;
    shut(card);
    tell(filled(words.accepted, {name: done.name}));
    await refresh();
    cardOf(done.name, done.language)?.querySelector('h2').focus();
  });
}

function edit(card, button) {
  const form = bodyForm({
    words, reader, ask,
    of: of(card),
    sentence: card.dataset.sentence,
    program: card.dataset.program,
    onCancel: () => shut(card),
    async onSave(body, trouble) {
      const done = await ask('change', {...of(card), ...body, by: who}, trouble);
      if (!done) return;
      shut(card);
      tell(filled(words.saved, {name: done.name}));
      await refresh();
      cardOf(done.name, done.language)?.querySelector('h2').focus();
    },
  });
  open(card, button, form.element);
  form.focus();
}

function rename(card, button) {
  const field = element('input', {class: 'field', maxlength: 200, value: card.dataset.name, required: true, autocomplete: 'off', lang: card.dataset.language});
  const trouble = element('p', {role: 'alert', class: 'routine-wrong', hidden: true});
  const form = element('form', {}, element('label', {}, words.new_name, field), trouble,
    element('div', {class: 'row'}, element('button', {class: 'button primary'}, words.rename), closer(card, words.cancel)));
  form.addEventListener('submit', async (event) => {
    event.preventDefault();
    const done = await ask('rename', {...of(card), new: field.value}, (why) => {
      trouble.textContent = why;
      trouble.hidden = false;
      field.focus();
    });
    if (!done) return;
    shut(card);
    const more = done.used_by ? ` ${filled(words.used_by, {names: done.used_by})}` : '';
    tell(filled(words.renamed, {name: done.name}) + more);
    await refresh();
    cardOf(done.name, card.dataset.language)?.querySelector('h2').focus();
  });
  open(card, button, form);
  field.focus();
  field.select();
}

async function share(card, button) {
  const which = [of(card)].map(({name, language}) => ({name, language}));
  const file = await ask('export', {which});
  if (!file) return;
  const address = `/routines/export.yaml?${new URLSearchParams({name: card.dataset.name, in: card.dataset.language})}`;
  const shown = [element('p', {class: 'muted'}, words.share_hint)];
  const row = element('div', {class: 'row'}, element('a', {class: 'button', href: address, download: file.file}, words.file));
  const link = linkOf(file.text);
  if (link) {
    const field = element('input', {class: 'field', readonly: true, value: link});
    const copy = element('button', {type: 'button', class: 'button'}, words.copy);
    const copied = element('span', {role: 'status'});
    copy.addEventListener('click', async () => {
      field.select();
      try {
        await navigator.clipboard.writeText(link);
        copied.textContent = words.copied;
      } catch {
        field.focus();
        copied.textContent = words.copy_yourself;
      }
    });
    shown.push(element('label', {}, words.link, field));
    row.append(copy, copied);
  } else {
    shown.push(element('p', {class: 'muted'}, words.link_long));
  }
  row.append(closer(card));
  open(card, button, ...shown, row);
  row.querySelector('a').focus();
}

async function remove(card) {
  const done = await ask('remove', of(card));
  if (!done) return;
  const {name, language} = of(card);
  const more = done.used_by ? ` ${filled(words.used_by, {names: done.used_by})}` : '';
  const undo = async () => {
    if ((await ask('restore', {number: done.number})) === null && cardOf(name, language)) return;
    await refresh();
    if (!cardOf(name, language)) return; // it was refused, and that was told
    tell(filled(words.restored, {name}));
    cardOf(name, language).querySelector('h2').focus();
  };
  shut(card);
  tell(filled(words.removed, {name}) + more, {undo: {text: words.undo, act: undo}});
  part('told').querySelector('button').focus();
  await refresh();
}

const ACTS = {test, review, edit, rename, share, remove};

// --- at the top: a new one, a file

function openTop(button, heading, ...shown) {
  shutTop();
  openedBy = button;
  button?.setAttribute('aria-expanded', 'true');
  panel.setAttribute('aria-label', heading);
  panel.replaceChildren(element('h2', {}, heading), ...shown);
  panel.hidden = false;
  panel.scrollIntoView({block: 'nearest'});
}

function shutTop({focus = false} = {}) {
  openedBy?.setAttribute('aria-expanded', 'false');
  if (focus) (openedBy ?? root.querySelector('[data-way=new]'))?.focus();
  openedBy = null;
  panel.hidden = true;
  panel.replaceChildren();
}

/** A new routine; with a program, one that was run or lay for review. */
function make(button, {sentence = '', program = '', heading = words.new} = {}) {
  const form = bodyForm({
    words, reader, ask, sentence, program,
    naming: true,
    languages: pageData.languages,
    of: {language: reader, reader},
    onCancel: () => shutTop({focus: true}),
    async onSave(body, trouble) {
      const done = await ask('keep', {reader, ...body, by: who}, trouble);
      if (!done) return;
      shutTop();
      tell(filled(words.kept, {name: done.name}));
      await refresh();
      cardOf(done.name, done.language)?.querySelector('h2').focus();
    },
  });
  openTop(button, heading, form.element);
  form.focus();
}

function take(button, given = null) {
  const made = importPanel({
    words, reader, ask, given,
    languages: pageData.languages,
    onCancel: () => shutTop({focus: true}),
    async onKept(kept) {
      shutTop();
      tell(kept.length === 1 ? words.imported_one : filled(words.imported_many, {number: kept.length}));
      await refresh();
      cardOf(kept[0].name, kept[0].language)?.querySelector('h2').focus();
    },
  });
  openTop(button, given ? words.from_link : words.import, made.element);
  made.focus();
}

async function keepAsked(asked) {
  const number = Number(asked.get('keep'));
  let program = asked.get('program') ?? '';
  let sentence = asked.get('sentence') ?? '';
  if (number) {
    try {
      const run = await wire.request('runs.show', {run: number});
      [program, sentence] = [run.program, ''];
    } catch {
      return tell(words.no_such_run, {bad: true});
    }
  }
  if (program || sentence) make(null, {program, sentence, heading: words.keep_title});
}

function shareAsked() {
  if (!location.hash.startsWith('#import=')) return;
  const text = textOfLink(location.hash.slice('#import='.length));
  history.replaceState(null, '', '/routines'); // loaded anew, it is not asked again
  if (text === null) tell(words.bad_link, {bad: true});
  else take(null, text);
}

// --- from here on somebody acts

root.addEventListener('click', (event) => {
  const button = event.target.closest('button');
  const card = button?.closest('.routine');
  const act = ACTS[button?.dataset.act];
  if (card && act) {
    if (button.getAttribute('aria-expanded') === 'true') shut(card);
    else act(card, button);
  }
  const way = {new: make, import: take}[button?.dataset.way];
  if (way) {
    if (button.getAttribute('aria-expanded') === 'true') shutTop({focus: true});
    else way(button);
  }
});
root.querySelector('.routines-filter input').addEventListener('input', sift);
wire.subscribe('routines', refresh);
if (role === 'operator') {
  addEventListener('hashchange', shareAsked);
  const asked = new URLSearchParams(location.search);
  if (asked.size) {
    history.replaceState(null, '', `/routines${location.hash}`);
    keepAsked(asked);
  }
  shareAsked();
}
root.dataset.ready = 'yes';
