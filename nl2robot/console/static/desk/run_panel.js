/** The run that goes on: its lines with the current one lit, its calls as they tick by. */

import {element, filled} from '/static/page.js';
import {present} from '/static/state.js';

const CALLS_SHOWN = 100;
const LONGEST = 80;
const STATES = {stopped: 'was_stopped'};
const GOING = ['running', 'pausing', 'paused'];
const TONES = {running: 'good', pausing: 'warn', paused: 'warn', stopping: 'bad', lost: 'bad', done: 'good', failed: 'bad', stopped: 'warn', limit: 'bad'};

function short(value) {
  if (value && typeof value === 'object' && 'x' in value && 'y' in value) {
    return value.place ?? `(${value.x.toFixed(2)}, ${value.y.toFixed(2)})`;
  }
  const text = JSON.stringify(value) ?? '';
  return text.length > LONGEST ? `${text.slice(0, LONGEST - 1)}…` : text;
}

function written({method, arguments: given}) {
  const named = Object.entries(given).filter(([, value]) => value != null);
  return `${method}(${named.map(([name, value]) => `${name}=${short(value)}`).join(', ')})`;
}

/** Shows the present run in an element; hides it where there is none. */
export class RunPanel {
  constructor(root, {wire, words, language, operator}) {
    Object.assign(this, {root, wire, words, language, operator});
    root.classList.add('card', 'run-panel');
    this.run = null;
    this.dismissed = Number(sessionStorage.getItem('dismissed') ?? 0);
    this._early = [];
    wire.subscribe('program', (event) => this._onEvent(event));
    wire.onChange((connected) => connected && this._load());
    present.onChange(({run}) => {
      if (this.run !== null && run === this.run) this._showState();
    });
  }

  /** Ask how the run stands: at the start, after a break, and when another begins, by its first event. */
  async _load(first) {
    this._early = first ? [first] : [];
    const loading = (this._loading = this.wire.request('desk.run', {language: this.language}));
    const view = await loading.catch(() => null);
    if (this._loading !== loading) return;
    this._loading = null;
    if (!view || view.run === this.dismissed) return;
    const early = this._early.splice(0).filter(({run}) => run === view.run);
    // A run that was over before anybody looked is none to watch; one may be over before the answer comes.
    const over = !GOING.includes(view.state);
    if (over && this.run !== view.run && early.length === 0) return;
    this._build(view);
    for (const event of early) if (!over || event.what === 'print') this._show(event);
  }

  _onEvent(event) {
    if (this._loading) this._early.push(event);
    else if (event.run !== this.run) this._load(event);
    else this._show(event);
  }

  _build(view) {
    const {words} = this;
    this.run = view.run;
    this.rows = new Map();
    this.chip = element('span', {class: 'chip', role: 'status'});
    this.message = element('p', {class: 'run-message', hidden: true});
    this.finishing = element('p', {class: 'muted', role: 'status', hidden: true}, words.finishing);
    this.pause = this._button(words.pause, () =>
      this._control(['paused', 'pausing'].includes(present.now.state) ? 'resume' : 'pause'),
    );
    this.step = this._button(words.step, () => this._control('step'));
    this.close = this._button(words.dismiss, () => this._dismiss());
    this.goOn = this._button(words.go_on_from, () => window.emitEvent('desk-go-on', {run: this.run}));
    this.goOn.hidden = true;
    this.see = element('a', {class: 'button small', href: `/runs/${view.run}`}, filled(words.see_run, view));
    this.lines = view.lines.map(({code, reading}, index) => {
      const source = element('code');
      source.innerHTML = code || ' ';
      return element(
        'li', {'data-line': index + 1}, source, element('span', {class: 'line-reading'}, reading),
      );
    });
    this.list = element('ol', {class: 'code', tabindex: 0, 'aria-label': words.program}, ...this.lines);
    this.calls = element('ol', {class: 'calls', tabindex: 0, 'aria-label': words.calls});
    this.root.replaceChildren(
      element(
        'header', {},
        element('h2', {}, view.utterance ?? words.program), this.chip,
        element('span', {class: 'muted'}, filled(words.approved_by, {who: view.by ?? '?'})),
      ),
      this.finishing, this.message, this.list, this.calls,
      element('div', {class: 'row'}, ...(this.operator ? [this.pause, this.step, this.goOn] : []), this.see, this.close),
    );
    for (const call of view.calls) {
      this._call(call);
      if (call.seconds != null) this._result(call);
    }
    this.root.hidden = false;
    this._state(view.state, view.message);
    this._line(view.line);
  }

  /** A run that is over makes room for what is to be decided now; its page has all of it. */
  fold() {
    const over = this.run != null && !GOING.includes(this.state);
    this.root.classList.toggle('folded', over && document.getElementById('decide') != null);
  }

  _button(text, act) {
    const made = element('button', {type: 'button', class: 'button small'}, text);
    made.addEventListener('click', act);
    return made;
  }

  _control(what) {
    this.wire.request(`program.${what}`).catch((error) => this._tell(error.message));
  }

  _dismiss() {
    this.dismissed = this.run;
    sessionStorage.setItem('dismissed', this.run);
    this.run = null;
    this.root.hidden = true;
  }

  _show(event) {
    switch (event.what) {
      case 'line': return this._line(event.line);
      case 'call': return this._call(event);
      case 'result': return this._result(event);
      case 'print': return this._row(null, event.text.trimEnd(), 'print');
      default:
        this._state(event.state, event.message);
        if (event.message && this.language !== 'en') this._explain();
    }
  }

  /** Events have their sentences in English. */
  async _explain() {
    const view = await this.wire.request('desk.run', {language: this.language}).catch(() => null);
    if (view?.run === this.run) this._tell(view.message);
  }

  _line(number) {
    for (const line of this.lines) {
      const current = Number(line.dataset.line) === number;
      line.classList.toggle('current', current);
      if (current) {
        line.setAttribute('aria-current', 'step');
        // Only the list scrolls, never the page under somebody's hands.
        const {top, bottom} = line.getBoundingClientRect();
        const seen = this.list.getBoundingClientRect();
        if (top < seen.top || bottom > seen.bottom) this.list.scrollTop += top - seen.top - 40;
      } else {
        line.removeAttribute('aria-current');
      }
    }
  }

  _row(line, text, kind) {
    const row = element(
      'li', {class: kind}, element('span', {class: 'number'}, line == null ? '' : String(line)),
      element('code', {}, text), element('span', {class: 'result'}),
    );
    this.calls.append(row);
    while (this.calls.children.length > CALLS_SHOWN) this.calls.firstElementChild.remove();
    this.calls.scrollTop = this.calls.scrollHeight;
    return row;
  }

  _call(call) {
    if (this.rows.has(call.number)) return; // told while it was being asked about
    const row = this._row(call.line, written(call), 'going');
    this.rows.set(call.number, row);
    this.rows.delete(call.number - CALLS_SHOWN);
  }

  _result(call) {
    const row = this.rows.get(call.number);
    if (!row) return;
    const halted = call.error?.startsWith('Paused:'); // what is left of it comes later
    row.className = halted ? 'halted' : call.error ? 'went-wrong' : 'went-well';
    this._showFinishing();
    const told = (halted ? this.words.halted : call.error) ?? (call.result == null ? '' : `→ ${short(call.result)}`);
    row.querySelector('.result').textContent = `${told} ${call.seconds.toFixed(1)} s`.trim();
  }

  /** How the run itself stands: it goes on, or how it ended. */
  _state(state, message) {
    this.going = GOING.includes(state);
    this.state = state;
    this.see.hidden = this.close.hidden = this.going;
    this.goOn.hidden = true;
    if (this.operator && !this.going && state !== 'done') this._offerToGoOn();
    if (!this.going) this._line(state === 'done' ? null : Number(this.list.querySelector('.current')?.dataset.line));
    this._showState();
    this._tell(message);
    this.fold();
  }

  /** After a stop one can go on from there, if something is left. */
  async _offerToGoOn() {
    const {run} = this;
    const rest = await this.wire.request('program.unfinished', {run}).catch(() => null);
    if (rest && run === this.run && !this.going) this.goOn.hidden = false;
  }

  /** While it goes on, what is shown is the one state of the robot. */
  _showState() {
    const {words} = this;
    const now = this.going && present.goesOn(this.run) ? present.now.state : this.state;
    const [paused, held] = [now === 'paused', ['pausing', 'paused'].includes(now)];
    this.root.dataset.state = now;
    this.chip.className = `chip ${TONES[now] ?? ''}`;
    const text = words[STATES[now] ?? now] ?? now;
    if (this.chip.textContent !== text) this.chip.textContent = text;
    this.pause.textContent = held ? words.resume : words.pause;
    this.pause.hidden = !this.going || !GOING.includes(now);
    this.step.hidden = !this.going || !paused;
    this._showFinishing();
  }

  /** A sentence may end while the robot already stands. */
  _showFinishing() {
    const going = this.calls.lastElementChild?.classList.contains('going') ?? false;
    this.finishing.hidden = !(this.root.dataset.state === 'paused' && going);
  }

  _tell(message) {
    this.message.textContent = message ?? '';
    this.message.hidden = !message;
  }
}
