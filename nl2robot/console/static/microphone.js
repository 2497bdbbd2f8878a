/**
 * Hold or tap to talk: a button that hears.
 *
 *   import {mountMicrophone} from '/static/microphone.js';
 *   const microphone = mountMicrophone(button, {
 *     wire, words: pageData.microphone, language: () => 'en', talk: 'a name for this conversation',
 *     onPartial(text) {...},       // the words so far, while they are said
 *     onHeard({text, doubtful, perhaps, translation}) {...}, // not told of a mere "stop"
 *     onThinking({microphone, text, program}) {...}, // a language model is at it; the program so far
 *     onGivenUp() {...},           // nothing comes of that
 *     onTrouble(sentence) {...},   // why nothing was heard, and what to do
 *     interrupts: false,           // true where this page plays the robot's voice: who speaks makes it silent
 *   });
 *
 * It is held with the mouse, a finger, or the space or enter key; or it is tapped: then it hears until
 * the next tap, or until nothing more is said. So it is with a click of a screen reader's, where nothing
 * can be held. What is said from press to release, or from tap to tap, is one command. Somebody who says "stop" meanwhile stops the robot at once. Its state is
 * the button's `data-state`: off, opening, listening, thinking, ready (open, but not listening).
 * `giveUp()` ends what is being thought about.
 */

import {filled} from '/static/page.js';
import {NoSound, Sound} from '/static/microphone_sound.js';

const TAIL = 300; // milliseconds for which is listened after the release: people let go early
const LONGEST = 60_000; // milliseconds; something lies on the key
const TAP = 250; // milliseconds; who holds it no longer has tapped it
const BEGINS = 10_000; // milliseconds after a tap in which something is said
const QUIET = 1_800; // milliseconds without another word after which who tapped has finished
const CLICK_AFTER = 500; // milliseconds in which a browser makes a click of a press
const AT_ONCE = 16_000; // samples in a push, at most
const BEGUN = 100; // milliseconds after which the server is at what it was asked
const SILENT = 0.002; // loudest sample of a microphone that is off or muted
const METER = 5; // how the level of a voice fills the meter

const ICON =
  '<svg viewBox="0 0 24 24" width="22" height="22" fill="none" stroke="currentColor" stroke-width="1.8"' +
  ' stroke-linecap="round" aria-hidden="true"><rect x="9" y="3" width="6" height="11" rx="3"/>' +
  '<path d="M5.5 11.5a6.5 6.5 0 0 0 13 0M12 18v3"/></svg>';

/** Samples as the wire has them. */
export function base64(samples) {
  const bytes = new Uint8Array(samples.buffer, samples.byteOffset, samples.byteLength);
  let text = '';
  for (let at = 0; at < bytes.length; at += 0x8000) {
    text += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
  }
  return btoa(text);
}

/** Blocks of samples as one. */
export function joined(blocks) {
  const all = new Int16Array(blocks.reduce((length, block) => length + block.length, 0));
  let at = 0;
  for (const block of blocks) {
    all.set(block, at);
    at += block.length;
  }
  return all;
}

/** What is heard from a press to its release, on its way to the recogniser. */
class Utterance {
  /** `tell(event)` is told what the recogniser says, `fail(error)` that it cannot be reached. */
  constructor(wire, {tell, fail}) {
    this.peak = 0;
    this.heard = false;
    this.stopped = false;
    this.text = ''; // so far
    this.early = false;
    this.pondered = false; // a language model thinks about it
    this._over = false;
    this._closing = null;
    this._wire = wire;
    this._tell = tell;
    this._fail = fail;
    this._waiting = [];
    this._number = null;
    this._sending = null;
  }

  /** Whether sound comes. */
  get opened() {
    return this._number !== null;
  }

  /** Open the recogniser; sound that comes before it is open waits. */
  open(about) {
    let number = null;
    this._deaf = this._wire.subscribe('translation', (event) => event.microphone === number && this._told([event]));
    this._number = this._wire.request('voice.open', {...about, channels: 1, held: true});
    this._number.then((opened) => (number = opened)).catch(() => {}); // it is told where it is sent
    this._send().catch(this._fail);
  }

  add({samples, peak}) {
    this.peak = Math.max(this.peak, peak);
    this._waiting.push(samples);
    if (this.opened) this._send().catch(this._fail);
  }

  /** It was all said; resolves when everything that was heard is told. */
  async finish() {
    await this._send();
    const microphone = await this._number;
    if (this._over) return;
    this._closing = this._wire.call('voice.close', {microphone});
    this._told(await this._closing.answer);
    this._over = true;
    this._deaf();
  }

  /** Nothing of it counts. */
  drop() {
    this._over = true;
    this._waiting = [];
    this._deaf?.();
    if (this._closing) {
      this._closing.cancel();
      return;
    }
    const close = async () => {
      const {answer, cancel} = this._wire.call('voice.close', {microphone: await this._number});
      // What is thought about is waited for, unless that is cancelled once it has begun.
      if (this.pondered) setTimeout(cancel, BEGUN);
      await answer;
    };
    if (this.opened) close().catch(() => {}); // the server forgets it by itself
  }

  /** Send what waits, a push after the other: blocks must come in their order. */
  _send() {
    this._sending ??= this._pushes().finally(() => (this._sending = null));
    return this._sending;
  }

  async _pushes() {
    const microphone = await this._number;
    while (this._waiting.length && !this._over) {
      let length = 0;
      let count = 0;
      do {
        length += this._waiting[count].length;
        count += 1;
      } while (count < this._waiting.length && length + this._waiting[count].length <= AT_ONCE);
      const sound = base64(joined(this._waiting.splice(0, count)));
      this._told(await this._wire.request('voice.push', {microphone, sound}));
    }
  }

  _told(events) {
    for (const event of events) if (!this._over) this._tell(event);
  }
}

class Microphone {
  constructor(button, options) {
    this.button = button;
    this.options = options;
    this.words = options.words;
    this.held = false;
    this._tapped = false; // held by a tap
    this._sound = new Sound({
      warm: options.warm,
      onEnded: () => this._abort('unplugged'),
      onLetGo: () => this._utterance || this._show(),
    });
    this._ends = [];
    this._utterance = null;
    this._dress();
    this._listen();
    this._show('off');
  }

  /** Begin to listen; `before` are blocks of what is said that were heard already. */
  async press(before = []) {
    if (this.held) return;
    this.held = true;
    this._pressedAt = performance.now();
    if (this._tail) {
      // They had let go for a moment only: it is the same sentence.
      clearTimeout(this._tail);
      this._tail = null;
      this._show('listening');
      return;
    }
    this.giveUp(); // who speaks anew has done with what they said before
    this.held = true;
    if (!this.options.wire.connected) return this._abort('lost');
    const utterance = new Utterance(this.options.wire, {
      tell: (event) => this._on(event, utterance),
      fail: (error) => this._utterance === utterance && this.fail(error),
    });
    this._utterance = utterance;
    for (const samples of before) utterance.add({samples, peak: 0});
    this._longest = setTimeout(() => this.release('too_long'), this.options.longest ?? LONGEST);
    this._show('opening');
    try {
      await this._sound.hear((block) => this._take(block, utterance));
    } catch (error) {
      // Who had let go while the browser asked them is told as well.
      if (this._utterance === utterance || !this._utterance) this.fail(error);
      return;
    }
    if (this._utterance !== utterance) {
      if (!this._utterance && utterance.early) this._trouble('now_ready');
      return;
    }
    this._show('listening');
    const {language, talk = null, interrupts = false} = this.options;
    utterance.open({rate: this._sound.rate, language: language(), talk, interrupts});
  }

  /** The button is pressed, by whatever: it begins to listen, or ends what a tap has begun. */
  _down() {
    if (this._tapped) this.release();
    else this.press();
  }

  /** It is let go: that was all, or a tap. */
  _up() {
    if (!this.held || this._tapped) return;
    if (performance.now() - this._pressedAt >= TAP) return this.release();
    this._tapped = true;
    this._listenOn(BEGINS);
    if (this.button.dataset.state === 'listening') this._show('listening');
  }

  /** Who tapped has so many milliseconds for the next word. */
  _listenOn(milliseconds) {
    clearTimeout(this._quiet);
    if (this._tapped) this._quiet = setTimeout(() => this.release(), milliseconds);
  }

  /** End to listen, a moment later; what was said is told when it is understood. */
  release(why = null) {
    if (!this.held) return;
    this.held = this._tapped = false;
    clearTimeout(this._longest);
    clearTimeout(this._quiet);
    const utterance = this._utterance;
    if (!utterance.opened) {
      utterance.early = true; // before there was any sound, as while the browser asks
      this._drop();
      return;
    }
    this._show('thinking');
    this._tail = setTimeout(() => this._finish(utterance, why), TAIL);
  }

  /** Nothing is to come of what was said and is still thought about. */
  giveUp() {
    if (this._utterance?.pondered) this._drop();
  }

  /** Whether it hears, or is at what it heard. */
  get busy() {
    return this.held || this._utterance !== null;
  }

  /** Let `listener` have all sound as well, null: no more; resolves to how many samples a second. */
  async attend(listener) {
    await this._sound.attend(listener);
    this._show();
    return this._sound.rate;
  }

  /** Listen as if it had been tapped; blocks of samples that came `before` belong to what is said. */
  tap(before = []) {
    this._sound.forget();
    this.press(before);
    this._up();
  }

  /** Somebody said "stop" while nobody held the button. */
  cryStop() {
    this._stop({stopped: false});
  }

  /** Let go of the microphone and the button. */
  close() {
    this._drop();
    for (const end of this._ends) end();
    this._status.remove();
  }

  async _finish(utterance, why) {
    this._tail = null;
    this._sound.rest();
    try {
      await utterance.finish();
    } catch (error) {
      if (this._utterance === utterance) this.fail(error);
      return;
    }
    if (this._utterance !== utterance) return;
    this._utterance = null;
    this._show();
    if (why) this._trouble(why);
    else if (!utterance.heard && !utterance.stopped) this._trouble(utterance.peak < SILENT ? 'silent' : 'nothing');
  }

  _take(block, utterance) {
    if (this.held) this.button.style.setProperty('--level', Math.min(1, block.level * METER).toFixed(2));
    utterance.add(block);
  }

  _on(event, utterance) {
    if (event.what === 'stop' || event.stop) this._stop(utterance);
    if (event.what === 'partial') {
      if (event.text !== utterance.text) this._listenOn(QUIET);
      utterance.text = event.text;
      this.options.onPartial?.(event.text);
    } else if (event.what === 'heard' && event.text) {
      utterance.heard = true;
      if (event.stop) return; // that was all
      const {text, doubtful, perhaps, translation} = event;
      this.options.onHeard({text, doubtful, perhaps, translation});
    } else if (event.microphone !== undefined) {
      // Told by the wire while an answer is waited for.
      utterance.pondered = true;
      const program = event.what === 'writing' ? event.text : '';
      this.options.onThinking?.({microphone: event.microphone, text: event.utterance, program});
    } else if (event.what === 'given up') {
      utterance.heard = true;
      this.options.onGivenUp?.();
    } else if (event.what === 'too long') {
      this._abort('too_long');
    }
  }

  async _stop(utterance) {
    if (utterance.stopped) return;
    utterance.stopped = true;
    try {
      await this.options.wire.request('robot.stop');
      this._trouble('stopped');
    } catch (error) {
      this._trouble(error.kind === 'StopNotConfirmed' ? 'unconfirmed' : 'not_stopped');
    }
  }

  /** End at once; what was said does not count. */
  _abort(why) {
    if (!this._utterance && !this.held) return;
    this._drop();
    this._trouble(why);
  }

  _drop() {
    this.held = this._tapped = false;
    clearTimeout(this._longest);
    clearTimeout(this._quiet);
    clearTimeout(this._tail);
    this._tail = null;
    const utterance = this._utterance;
    this._utterance = null;
    utterance?.drop();
    if (utterance?.pondered) this.options.onGivenUp?.();
    if (this._sound.open) this._sound.rest();
    this._show();
  }

  /** Drop what was begun, and tell why. */
  fail(error) {
    this._drop();
    const model = /models get (\w+)/.exec(error.message);
    if (error instanceof NoSound) this._trouble(error.reason, {why: error.message});
    else if (error.kind === 'LostConnection') this._trouble('lost');
    else if (model) this._trouble('no_model', {code: model[1]});
    else this._trouble('failed', {why: error.message});
  }

  _trouble(key, values = {}) {
    this.options.onTrouble(filled(this.words[key], values));
  }

  /** Who comes near the button is about to speak: what hears them is loaded, nothing is heard yet. */
  _getReady() {
    const language = this.options.language();
    if (this._ready === language || !this.options.wire.connected) return;
    this._ready = language;
    this.options.wire.request('voice.ready', {language}).catch(() => {}); // it is told at the press
  }

  // --- the button

  _dress() {
    if (!document.querySelector('link[data-microphone]')) {
      const style = document.createElement('link');
      style.rel = 'stylesheet';
      style.dataset.microphone = '';
      style.href = new URL('microphone.css', import.meta.url);
      document.head.append(style);
    }
    this.button.type = 'button';
    this.button.classList.add('microphone');
    if (!this.button.childElementCount) this.button.innerHTML = ICON;
    this._status = document.createElement('span');
    this._status.className = 'sr';
    this._status.setAttribute('role', 'status');
    this.button.after(this._status);
  }

  _show(state = this._sound.open ? 'ready' : 'off') {
    const {button, words} = this;
    const said = words[`state_${this._tapped && state === 'listening' ? 'tapped' : state}`];
    button.dataset.state = state;
    button.setAttribute('aria-pressed', String(state === 'opening' || state === 'listening'));
    button.setAttribute('aria-label', words.hold);
    button.title = said;
    if (state !== 'listening') button.style.removeProperty('--level');
    this._status.textContent = state === 'off' || state === 'ready' ? '' : said;
  }

  _listen() {
    const on = (target, kind, listener, how) => {
      target.addEventListener(kind, listener, how);
      this._ends.push(() => target.removeEventListener(kind, listener, how));
    };
    const {button} = this;
    let pointedAt = -Infinity; // a click right after that is not one of its own
    const key = (event) => event.key === ' ' || event.key === 'Enter';

    on(button, 'pointerdown', (event) => {
      if (event.button !== 0) return;
      button.setPointerCapture?.(event.pointerId);
      this._down();
    });
    for (const kind of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      on(button, kind, () => {
        pointedAt = performance.now();
        this._up();
      });
    }
    for (const kind of ['pointerenter', 'focus']) on(button, kind, () => this._getReady());
    on(button, 'contextmenu', (event) => event.preventDefault()); // a long touch
    on(button, 'keydown', (event) => {
      if (event.key === 'Escape') this._abort('cancelled');
      if (!key(event)) return;
      event.preventDefault(); // no click of its own
      if (!event.repeat) this._down();
    });
    on(button, 'keyup', (event) => {
      if (!key(event)) return;
      event.preventDefault();
      this._up();
    });
    on(button, 'click', () => {
      if (performance.now() - pointedAt < CLICK_AFTER) return;
      this._down();
      this._up();
    });
    on(button, 'blur', () => this.release());
    on(window, 'blur', () => this.release());
    on(document, 'visibilitychange', () => {
      if (!document.hidden) return;
      if (!this._utterance?.pondered) this._abort('left');
      this._sound.letGo();
    });
    this._ends.push(
      this.options.wire.onChange((connected) => {
        if (!connected) this._abort('lost');
      }),
      () => this._sound.letGo(),
    );
  }
}

/** Make a button a microphone; see above. */
export function mountMicrophone(button, options) {
  return new Microphone(button, options);
}
