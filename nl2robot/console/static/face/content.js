/**
 * What the robot's screen shows beside the face: a text, a page, a picture, a web page, or a question
 * with its answers.
 *
 * A page of the robot's stands in a frame that may run scripts but is of no origin: it reaches neither
 * the console nor anything else. A script of ours in it (`agent`) does there what the program asks
 * for, and tells what people do.
 */

import {element} from '/static/page.js';

const AGENT_ANSWERS_WITHIN = 1500;
const LONGEST_PAGE = 100_000;
const MANY = 6; // options from which on their buttons are smaller
const LONG_WORD = 12; // letters
const PICTURE = /\.(png|jpe?g|gif|webp|svg|avif|bmp)$/i;
const RULES =
  "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline' http: https:;" +
  ' img-src data: blob: http: https:; font-src data: http: https:; media-src data: blob: http: https:';

/** How a page looks that says nothing about it: large enough for a tablet. Its own styles win. */
const LOOKS =
  'html{font:clamp(18px,3.2vmin,30px)/1.45 system-ui,sans-serif;color:#06202e;background:#fff}' +
  'body{margin:1em}img,video{max-width:100%;height:auto}' +
  'button,input,select,textarea{font:inherit;padding:.4em .7em;border:2px solid #7d98a8;border-radius:.5em}' +
  'input:is([type=checkbox],[type=radio]){width:1.4em;height:1.4em;vertical-align:-.25em}' +
  'button,[type=submit],[type=button]{background:#0b6f86;border-color:#0b6f86;color:#fff;font-weight:600}';

/** Runs inside the page that is shown. It is written out there, so it can use nothing of here. */
function agent() {
  const FIELDS = 'input, textarea, select, option';
  let telling = 0;

  /** The page as it is, with what is in its fields. */
  function written() {
    const copy = document.documentElement.cloneNode(true);
    const [fields, copies] = [document.documentElement, copy].map((r) => r.querySelectorAll(FIELDS));
    fields.forEach((field, index) => {
      const its = copies[index];
      if (field.tagName === 'TEXTAREA') its.textContent = field.value;
      else if (field.tagName === 'OPTION') its.toggleAttribute('selected', field.selected);
      else if (['checkbox', 'radio'].includes(field.type)) its.toggleAttribute('checked', field.checked);
      else if (field.tagName === 'INPUT' && field.type !== 'file') its.setAttribute('value', field.value);
    });
    copy.querySelectorAll('[data-face-agent]').forEach((mine) => mine.remove());
    return `<!doctype html>${copy.outerHTML}`;
  }

  function tell(message) {
    parent.postMessage({face: 'page', ...message}, '*');
  }

  function changed(after = 60) {
    clearTimeout(telling);
    telling = setTimeout(() => tell({html: written()}), after);
  }

  function mark(target) {
    document.querySelectorAll('[data-touched]').forEach((other) => other.removeAttribute('data-touched'));
    target.closest?.('button, a, input, label, summary, [onclick], [id]')?.setAttribute('data-touched', '');
  }

  const acts = {
    click(found) {
      const choice = found.tagName === 'OPTION' ? found.closest('select') : null;
      if (!choice) return found.click();
      choice.value = found.value;
      choice.dispatchEvent(new Event('change', {bubbles: true}));
    },
    type(found, text) {
      found.focus({preventScroll: true});
      found.value = text;
      found.dispatchEvent(new InputEvent('input', {bubbles: true}));
      found.dispatchEvent(new Event('change', {bubbles: true}));
    },
  };

  addEventListener('message', ({source, data}) => {
    if (source !== parent) return;
    if (data.act) {
      const found = document.querySelector(data.selector);
      if (found) acts[data.act](found, data.text);
      // What the page's own scripts make of it comes a moment later.
      setTimeout(() => tell({number: data.number, html: found ? written() : null}), 0);
    } else if (data.html) {
      const page = new DOMParser().parseFromString(data.html, 'text/html');
      document.body.replaceWith(page.body);
    }
  });
  // Only what a person did is told at once; what scripts change is told when it has settled.
  addEventListener('input', () => changed(), true);
  addEventListener('change', () => changed(), true);
  addEventListener('click', ({target, isTrusted}) => {
    if (isTrusted) mark(target);
    changed();
  }, true);
  addEventListener('submit', (event) => event.preventDefault());
  // Keys pressed in the page never reach the face, whose Escape stops the robot.
  addEventListener('keydown', ({key, repeat, isTrusted}) => {
    if (key === 'Escape' && !repeat && isTrusted) tell({stop: true});
  }, true);
  addEventListener('DOMContentLoaded', () => {
    tell({ready: true});
    new MutationObserver(() => changed(200)).observe(document.documentElement, {
      childList: true, subtree: true, characterData: true,
    });
  });
}

const HEAD =
  `<!doctype html><meta http-equiv="Content-Security-Policy" content="${RULES}" data-face-agent>` +
  '<meta name="viewport" content="width=device-width, initial-scale=1" data-face-agent>' +
  `<style data-face-agent>${LOOKS}</style><script data-face-agent>(${agent})()</script>`;

/**
 * Shows contents in an element. `answered(number, answer)` is called when somebody answers a question,
 * and resolves to what is to be said if that was too late; `paged(page, html)` when they have done
 * something to the page; `site()` resolves to whether the web page lets itself be shown; `stop()` is
 * called when they press Escape in the page.
 */
export class Content {
  constructor(root, {answered, paged, site, stop}) {
    this._root = root;
    this._answered = answered;
    this._paged = paged;
    this._site = site;
    this._stop = stop;
    this._page = null;
    this._orders = new Map();
    addEventListener('message', (event) => this._fromPage(event));
  }

  /** Show what is asked, else what is on the screen; false if there is nothing besides the face. */
  show({screen, asking, words, language, mine}) {
    this._words = words;
    this._language = language;
    const what = JSON.stringify([asking, asking ? null : screen, language]);
    if (what === this._what) return this._something;
    const samePage = !asking && screen.html !== undefined && this._page?.page === screen.page;
    this._what = what;
    if (!asking && screen.html === undefined) this._page = null; // nothing of it is kept
    this._something = true;
    if (asking) this._showAsking(asking, false);
    else if (screen.options) this._showAsking({question: screen.text, options: screen.options}, true);
    else if (samePage && this._page.frame.isConnected) this._redraw(screen, mine);
    else if (screen.html !== undefined) this._showPage(screen);
    else if (screen.url !== undefined) this._showSite(screen.url);
    else if (screen.text?.trim()) this._showText(screen.text);
    else this._something = this._put();
    return this._something;
  }

  /** Do something to the page; resolves to the page as it is then, or null. */
  act({number, act, selector, text}) {
    const page = this._page;
    if (!page) return Promise.resolve(null);
    return new Promise((resolve) => {
      this._orders.set(number, resolve);
      setTimeout(() => this._done(number, null), AGENT_ANSWERS_WITHIN);
      page.ready.then(() => page.frame.contentWindow?.postMessage({number, act, selector, text}, '*'));
    });
  }

  _put(...shown) {
    // A page stays in its frame while something is asked, with all that was done to it.
    for (const old of [...this._root.children]) {
      const kept = old === this._page?.frame && shown[0]?.classList.contains('asking');
      if (kept) old.hidden = true;
      else old.remove();
    }
    this._root.append(...shown);
    return shown.length > 0;
  }

  _showText(text) {
    const length = text.length > 260 ? 'long' : text.length > 60 ? 'medium' : 'short';
    this._put(element('p', {class: 'shown-text', 'data-length': length}, text));
  }

  _showPage({page, html}) {
    const frame = element('iframe', {
      class: 'shown-page', sandbox: 'allow-scripts', title: this._words.page, referrerpolicy: 'no-referrer',
    });
    let tellReady;
    const ready = new Promise((resolve) => (tellReady = resolve));
    this._page = {page, frame, ready, tellReady, html};
    frame.srcdoc = HEAD + html;
    this._put(frame);
  }

  /** The page that is there already, after something was done to it, here or at another face. */
  _redraw({html}, mine) {
    const {frame, ready} = this._page;
    for (const other of [...this._root.children]) if (other !== frame) other.remove();
    frame.hidden = false;
    if (!mine && html !== this._page.html) {
      ready.then(() => frame.contentWindow?.postMessage({html}, '*'));
    }
    this._page.html = html;
  }

  _fromPage({source, data}) {
    const page = this._page;
    if (!page || source !== page.frame.contentWindow || data?.face !== 'page') return;
    if (data.ready) page.tellReady();
    else if (data.stop) this._stop();
    else if (data.number) this._done(data.number, data.html);
    else if (data.html !== page.html && data.html.length <= LONGEST_PAGE) {
      page.html = data.html;
      this._paged(page.page, data.html);
    }
  }

  _done(number, html) {
    if (html && this._page) this._page.html = html;
    this._orders.get(number)?.(html?.length <= LONGEST_PAGE ? html : null);
    this._orders.delete(number);
  }

  _showSite(url) {
    const address = new URL(url);
    if (PICTURE.test(address.pathname)) {
      const picture = element('img', {class: 'shown-picture', src: url, alt: this._words.picture});
      picture.addEventListener('error', () => this._siteNotice(url, 'away'));
      this._put(picture);
      return;
    }
    // A page of another server may use its own cookies; ours would then reach the whole console.
    const other = address.origin !== location.origin ? ' allow-same-origin' : '';
    const frame = element('iframe', {
      class: 'shown-page', src: url, sandbox: `allow-scripts allow-forms${other}`,
      title: url, referrerpolicy: 'no-referrer',
    });
    this._put(element('div', {class: 'site'}, frame));
    this._site().then((answer) => {
      if (answer !== 'yes' && frame.isConnected) this._siteNotice(url, answer);
    }, () => {});
  }

  _siteNotice(url, why) {
    const said = this._words[why === 'refuses' ? 'site_refuses' : 'site_away'];
    this._put(element('p', {class: 'site-notice'}, said, element('output', {}, url)));
  }

  /** A question with its buttons or a field; `inert` if it is not for who stands here. */
  _showAsking({number, question, options, called, language}, inert) {
    const words = this._words;
    const form = element('form', {class: 'asking', lang: this._language});
    const heading = question || (options ? words.touch : words.listening);
    form.append(element('h1', {lang: (question && language) || this._language}, heading));
    const only = question && language && language !== this._language ? words[`only_in_${language}`] : '';
    if (only) form.append(element('p', {class: 'hint'}, only));
    if (options) form.append(this._choices(number, options, called?.[this._language] ?? options, inert));
    else form.append(this._reply(number));
    if (!inert) {
      form.append(element('p', {class: 'hint'}, options ? words.speak_or_touch : words.speak_or_type));
    }
    form.addEventListener('submit', (event) => event.preventDefault());
    this._put(form);
  }

  /** `called`: what stands on the buttons of the options. */
  _choices(number, options, called, inert) {
    const longest = Math.max(...called.join(' ').split(/\s+/).map((word) => word.length));
    const choices = element('div', {
      class: 'choices', 'data-many': options.length > MANY, 'data-long': longest > LONG_WORD,
    });
    for (const [index, option] of options.entries()) {
      const choice = element('button', {type: 'button', class: 'choice', disabled: inert}, called[index]);
      choice.addEventListener('click', () => this._answer(number, option, choice));
      choices.append(choice);
    }
    return choices;
  }

  _reply(number) {
    const field = element('input', {
      type: 'text', maxlength: 2000, autocomplete: 'off', enterkeyhint: 'send', 'data-number': number,
    });
    // Who chooses another language goes on with what they have written.
    field.value = this._root.querySelector(`input[data-number="${number}"]`)?.value ?? '';
    const send = element('button', {}, this._words.send);
    const label = element('label', {}, element('span', {class: 'sr'}, this._words.your_answer), field);
    const reply = element('div', {class: 'reply'}, label, send);
    send.addEventListener('click', () => {
      if (field.value.trim()) this._answer(number, field.value.trim(), send);
      else field.focus();
    });
    return reply;
  }

  async _answer(number, answer, button) {
    const all = [...this._root.querySelectorAll('button')];
    button.classList.add('chosen');
    for (const each of all) each.disabled = true;
    if (await this._answered(number, answer)) return;
    button.classList.remove('chosen');
    for (const each of all) each.disabled = false;
  }
}
