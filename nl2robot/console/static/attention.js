/**
 * Hands free: a switch that lets the page listen for the hot word, beside a microphone's button.
 *
 *   const attention = mountAttention(switchButton, {wire, words, language, microphone});
 *
 * While it is on (`aria-checked`), sound goes to the robot's computer, which tells of "hey robot" and of
 * "stop" and keeps nothing. After the hot word the microphone listens as if it had been tapped. It
 * rests while the page is hidden or the connection is lost, and goes on by itself.
 */

import {base64, joined} from '/static/microphone.js';

const KEPT = 'hands-free';
const RATE = 16_000; // samples a second that most browsers give
const REMEMBERED = 100; // blocks, of a tenth of a second, that may be on the way when the word is noticed

class Attention {
  constructor(button, {wire, words, language, microphone}) {
    Object.assign(this, {button, wire, words, language, microphone});
    this._number = null;
    this._blocks = []; // still to be sent
    this._sent = []; // the newest that were, each with its first sample's number
    this._samples = 0; // sent in all
    this._pushing = false;
    button.setAttribute('role', 'switch');
    button.addEventListener('click', () => this._switch(!this.on));
    document.addEventListener('visibilitychange', () => this._follow());
    wire.onChange(() => this._follow());
    this._switch(sessionStorage.getItem(KEPT) === 'on');
  }

  _switch(on) {
    this.on = on;
    sessionStorage.setItem(KEPT, on ? 'on' : 'off');
    this._follow();
  }

  /** Listen if it is wanted and can be; else let go. */
  _follow() {
    const listen = this.on && this.wire.connected && !document.hidden;
    this.button.setAttribute('aria-checked', String(this.on));
    this.button.title = this.words[this.on ? 'hands_free_on' : 'hands_free_off'];
    if (listen === Boolean(this._turn)) return;
    if (listen) this._begin();
    else this._end();
  }

  async _begin() {
    const turn = (this._turn = {});
    const {wire} = this;
    const language = this.language();
    const attend = (rate) => wire.request('voice.attend', {rate, language});
    this.button.dataset.state = 'opening';
    try {
      // What hears is loaded before the microphone is opened: its light is on only while it is heard.
      await wire.request('voice.ready', {language});
      let number = await attend(RATE);
      const rate = this._turn === turn ? await this.microphone.attend((block) => this._take(block)) : RATE;
      if (rate !== RATE) {
        this._ignore(number);
        number = await attend(rate);
      }
      if (this._turn !== turn) return this._ignore(number);
      this._number = number;
      this._rate = rate;
      this._sent = [];
      this._samples = 0;
      this.button.dataset.state = 'listening';
    } catch (error) {
      if (this._turn === turn) this._fail(error);
    }
  }

  _ignore(attention) {
    if (this.wire.connected) this.wire.request('voice.ignore', {attention}).catch(() => {});
  }

  _end() {
    this._turn = null;
    this._blocks = [];
    delete this.button.dataset.state;
    this.microphone.attend(null);
    if (this._number !== null) this._ignore(this._number);
    this._number = null;
  }

  _fail(error) {
    this._switch(false);
    this.microphone.fail(error);
  }

  /** What is said while the button hears is the button's. */
  _take({samples}) {
    if (this._number === null || this.microphone.busy) return;
    this._blocks.push(samples);
    if (!this._pushing) this._push();
  }

  async _push() {
    this._pushing = true;
    try {
      while (this._blocks.length && this._number !== null) {
        const blocks = this._blocks.splice(0);
        for (const block of blocks) {
          this._sent.push({from: this._samples, block});
          this._samples += block.length;
        }
        this._sent.splice(0, this._sent.length - REMEMBERED);
        const request = {attention: this._number, sound: base64(joined(blocks))};
        const heard = await this.wire.request('voice.notice', request);
        if (heard.some(({what}) => what === 'stop')) this.microphone.cryStop();
        else if (heard.length && !this.microphone.busy) this._answer(heard.at(-1).time);
      }
    } catch (error) {
      if (error.kind !== 'LostConnection') this._fail(error);
    } finally {
      this._pushing = false;
    }
  }

  /** The hot word was heard; what was said since then, while that was on its way, belongs to the command. */
  _answer(seconds) {
    const since = this._sent.filter(({from}) => from >= seconds * this._rate).map(({block}) => block);
    this.microphone.tap([...since, ...this._blocks.splice(0)]);
  }
}

/** Make a button the switch; see above. */
export function mountAttention(button, options) {
  return new Attention(button, options);
}
