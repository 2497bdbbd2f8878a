/** The operator's page in the browser: what is typed, spoken and clicked, the run, the map. */

import {appears, pageData} from '/static/page.js';
import {present} from '/static/state.js';
import {wire} from '/static/wire.js';
import {beginInView} from '/static/desk/review_begins.js';
import {ReviewSeen} from '/static/desk/review_seen.js';
import {RunPanel} from '/static/desk/run_panel.js';
import {standIn} from '/static/desk/standing_in.js';

const {words, role, language, who} = pageData;
const LONGEST_PROGRAM = 64_000; // as the sandbox has it
const OPTIONS = {harmless: 'option-harmless', at_once: 'option-at-once'};
const CHOSEN = {harmless: 'yes', at_once: 'no'}; // where nobody has chosen

/** Tell the server's side of this page. */
const tell = (name, data = {}) => window.emitEvent(name, data);

function options() {
  return Object.fromEntries(
    Object.entries(OPTIONS).map(([name, id]) => [name, document.getElementById(id)?.checked ?? false]),
  );
}

/** The line to type in, with what was typed before on the arrow keys. */
function openComposer(form) {
  const line = form.querySelector('#words');
  const history = [...pageData.history];
  let at = history.length;
  let unsent = sessionStorage.getItem('unsent') ?? '';
  let sent = null; // from here, the last of all
  const spoken = openMicrophone(form, (text) => (sent = text));
  const write = (text) => {
    line.value = text;
    grow(line);
  };
  write(unsent);

  const say = (text) => {
    const said = text.trim();
    if (!said) return;
    if (history.at(-1) !== said) history.push(said);
    at = history.length;
    sent = said;
    spoken.then((microphone) => microphone.giveUp());
    tell('desk-say', {text: said, harmless: options().harmless});
  };
  form.addEventListener('submit', (event) => {
    event.preventDefault();
    say(line.value);
    write((unsent = ''));
    sessionStorage.removeItem('unsent');
  });
  line.addEventListener('input', () => {
    unsent = line.value;
    grow(line);
    sessionStorage.setItem('unsent', unsent);
  });
  line.addEventListener('keydown', (event) => {
    if (event.key === 'Enter' && !event.shiftKey && !event.isComposing) {
      event.preventDefault();
      form.requestSubmit();
      return;
    }
    const by = {ArrowUp: -1, ArrowDown: 1}[event.key];
    if (!by || at + by < 0 || at + by > history.length) return;
    // Within a text of several lines the arrow keys go from line to line.
    const beyond = by < 0 ? line.value.slice(0, line.selectionStart) : line.value.slice(line.selectionEnd);
    if (beyond.includes('\n')) return;
    event.preventDefault();
    at += by;
    write(at === history.length ? unsent : history[at]);
    line.setSelectionRange(line.value.length, line.value.length);
  });
  document.addEventListener('click', (event) => {
    const button = event.target.closest('[data-say]');
    if (button) say(button.dataset.say);
    if (event.target.closest('#cancel')) {
      tell('desk-cancel');
      spoken.then((microphone) => microphone.giveUp());
    }
  });
  // Who cancels wants to say it otherwise; what they have typed since then is theirs.
  document.addEventListener('thought-dropped', ({detail: words}) => {
    if (words !== sent || line.value) return;
    write((unsent = words));
    sent = null;
    sessionStorage.setItem('unsent', unsent);
    if (matchMedia('(pointer: fine)').matches) line.focus({preventScroll: true});
  });
  for (const [name, id] of Object.entries(OPTIONS)) {
    const box = document.getElementById(id);
    box.checked = (localStorage.getItem(name) ?? CHOSEN[name]) === 'yes';
    box.addEventListener('change', () => localStorage.setItem(name, box.checked ? 'yes' : 'no'));
  }
  const heard = sessionStorage.getItem('say'); // on another page
  sessionStorage.removeItem('say');
  if (heard) say(heard);
  if (matchMedia('(pointer: fine)').matches) line.focus({preventScroll: true});
}

/** A field is as high as what is in it, as far as its style lets it. */
function grow(field) {
  field.style.height = 'auto';
  field.style.height = `${field.scrollHeight + field.offsetHeight - field.clientHeight}px`;
}

/** `think` is told what was said, if it takes thinking. */
async function openMicrophone(form, think) {
  const [{mountMicrophone}, {mountAttention}] = await Promise.all(
    ['microphone', 'attention'].map((name) => import(`/static/${name}.js`)),
  );
  const partial = form.querySelector('#partial');
  const microphone = mountMicrophone(form.querySelector('#microphone'), {
    wire,
    words: pageData.microphone,
    language: () => language,
    talk: pageData.desk,
    onPartial: (text) => (partial.textContent = text),
    onHeard: ({text, translation}) => {
      partial.textContent = '';
      tell('desk-hear', {text, translation, harmless: options().harmless});
    },
    onThinking: ({microphone, text, program}) => {
      partial.textContent = '';
      think(text);
      tell('desk-ponder', {microphone, text, program});
    },
    onGivenUp: () => tell('desk-given-up'),
    onTrouble: (sentence) => (partial.textContent = sentence),
  });
  mountAttention(form.querySelector('#hands-free'), {
    wire,
    words: pageData.microphone,
    language: () => language,
    microphone,
  });
  return microphone;
}

/** The editor, which is NiceGUI's; undefined until it stands there. */
function editorView() {
  const editor = document.querySelector('.desk-editor .nicegui-codemirror');
  return editor && window.getElement?.(Number(editor.id.slice(1)))?.editor;
}

/** The editor has no name of its own for who does not see it. In it, Tab leads on to the decision, as everywhere: it would indent, and hold who has no
 * mouse. What is too long to be sent is not taken. */
function openEditor(editor) {
  appears('.desk-editor .cm-content').then((text) => text.setAttribute('aria-label', words.program));
  editor.addEventListener('keydown', (event) => event.key === 'Tab' && event.stopPropagation(), {capture: true});
  editor.addEventListener(
    'paste',
    (event) => {
      if (event.clipboardData.getData('text').length <= LONGEST_PROGRAM) return;
      event.preventDefault();
      event.stopPropagation();
      alertOf(Error(words.too_long));
    },
    {capture: true},
  );
}

/** Back to the words, to say it otherwise; to the program, if it has none that it is made of. */
function changeIt(said) {
  const line = document.getElementById('words');
  if (!said) return editorView().focus();
  line.value = said;
  line.dispatchEvent(new Event('input'));
  line.focus();
}

/** Why somebody rejects a proposal: what they have typed is there still when the review is drawn anew. */
function keepReason() {
  const typed = new Map();
  document.addEventListener('input', ({target}) => {
    if (target.id === 'why-not') typed.set(target.dataset.proposal, target.value);
  });
  const putBack = () => {
    const field = document.getElementById('why-not');
    const kept = typed.get(field?.dataset.proposal);
    if (kept && !field.value) field.value = kept;
  };
  new MutationObserver(putBack).observe(document.querySelector('.desk-review'), {childList: true, subtree: true});
}

function openDecisions() {
  const approve = (allTheSame) => {
    if (present.now.run !== null) return alertOf(Error(words.busy));
    // What is approved is what stands before one's eyes, whatever of it has reached the server.
    tell('desk-approve', {
      program: editorView().state.doc.toString(),
      sha256: document.getElementById('decide').dataset.review,
      all_the_same: allTheSame,
    });
  };
  document.addEventListener('click', (event) => {
    if (event.target.closest('#approve')) approve(false);
    if (event.target.closest('#run-anyway')) approve(true);
    const atTimes = event.target.closest('#at-times');
    if (atTimes) plan(atTimes);
    if (event.target.closest('#reject')) {
      tell('desk-reject', {reason: document.getElementById('why-not')?.value ?? ''});
    }
    const change = event.target.closest('#change');
    if (change) changeIt(change.dataset.words);
  });
  const asked = new URLSearchParams(location.search);
  if (asked.has('program') || asked.has('go_on')) history.replaceState(null, '', '/');
}

/** Approve what stands before one's eyes for set times. */
async function plan(button) {
  const {sentence, times, insists} = button.dataset;
  const program = editorView().state.doc.toString();
  const sha256 = document.getElementById('decide').dataset.review;
  const {askForTimes} = await import('/static/schedule/form.js');
  const planned = await askForTimes({
    wire, language, who, words: pageData.times,
    what: {program, sha256, sentence, times: times && JSON.parse(times), insists: insists === 'yes'},
  });
  if (planned) tell('desk-planned', planned);
}

/** The newest words are in view; whoever reads further up is left there. */
function keepNewestInView(conversation) {
  let atEnd = true;
  conversation.addEventListener('scroll', () => {
    const {scrollTop, scrollHeight, clientHeight} = conversation;
    atEnd = scrollHeight - scrollTop - clientHeight < 60;
  });
  const follow = () => atEnd && conversation.scrollTo({top: conversation.scrollHeight});
  new MutationObserver(follow).observe(conversation, {childList: true, subtree: true, attributeFilter: ['class']});
  follow();
}

async function openMap(element) {
  const {mountFloorMap} = await import('/static/floor/floor_map.js');
  const operator = role === 'operator';
  const places = matchMedia('(min-width: 1280px)').matches; // below it, there is room for its list
  const map = await mountFloorMap(element, {wire, language, who, operator, places});
  document.addEventListener('dry-run', (event) => map.showPath(event.detail));
  if (waitingPath) map.showPath(waitingPath);
  const {proposeClicks} = await import('/static/floor/sending.js');
  proposeClicks(map, {
    wire,
    language,
    propose: ({program, said, note}) =>
      tell('desk-propose', {program, said, note, at_once: options().at_once}),
  });
}

const alertOf = async (error) => (await import('/static/console.js')).notice(error.message, {alarm: true});

// The server may say before the map is there what path it is to show.
let waitingPath = null;
document.addEventListener('dry-run', (event) => (waitingPath = event.detail));

document.cookie = `desk=${pageData.desk}; path=/; max-age=2592000; SameSite=Lax`;
appears('#conversation').then(keepNewestInView);
appears('#run-panel').then((element) => {
  const panel = new RunPanel(element, {wire, words, language, operator: role === 'operator'});
  const review = document.querySelector('.desk-review');
  new MutationObserver(() => panel.fold()).observe(review, {childList: true, subtree: true});
});
appears('#desk-map').then(openMap);
if (role === 'operator') {
  appears('#composer').then(openComposer);
  appears('#standing-in').then((element) => standIn(element, {wire, words, language, who: pageData.who}));
  openDecisions();
  appears('.desk-review').then(keepReason);
  const tellShade = () => tell('desk-shade', {dark: document.documentElement.dataset.look === 'dark'});
  appears('.desk-editor').then((editor) => {
    const review = editor.closest('.desk-review');
    openEditor(editor);
    new ReviewSeen(review, {words, view: editorView});
    beginInView(review);
    tellShade();
    new MutationObserver(tellShade).observe(document.documentElement, {attributeFilter: ['data-look']});
  });
}
