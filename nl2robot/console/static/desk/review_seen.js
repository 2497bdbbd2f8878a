/** What of a review has been before somebody's eyes. Only when all of it has, it can be approved.
 *
 * A line, a mark, the outcome counts as seen once its upper and its lower edge have been on the
 * screen with nothing over them: no edge of a scrolled box, no bar, no dialog. So it is at every
 * size and zoom, and whoever scrolls or presses keys. What is longer than the screen is seen by
 * scrolling through it. `Read on` takes one to what is left; who does not see the screen hears
 * there what was shown.
 */

import {filled} from '/static/page.js';

const PARTS = '.by-model p, .outlook, .facts dd span, .mark';
const [TOP, BOTTOM, BOTH] = [1, 2, 3];
/** Milliseconds without a decision after the last "Read on", so that nobody decides by pressing on. */
const RESTS = 600;
const LOOKS_EVERY = 400;
const AWAY_FROM_EDGE = 12;

export class ReviewSeen {
  /** `panel` holds the review with its editor; `view` gives the editor's CodeMirror view. */
  constructor(panel, {words, view}) {
    Object.assign(this, {panel, words, view});
    this.key = null;
    this.lines = [];
    this.parts = new WeakMap();
    this.rested = 0;
    this.looking = 0;
    const soon = () => (this.looking ||= requestAnimationFrame(() => this.look()));
    addEventListener('scroll', soon, {capture: true, passive: true});
    addEventListener('resize', soon);
    new MutationObserver(soon).observe(panel, {childList: true, subtree: true, characterData: true});
    setInterval(soon, LOOKS_EVERY); // what slides away over it, a dialog that closes
    panel.addEventListener('click', (event) => event.target.closest('#read-on') && this.readOn());
    soon();
  }

  get foot() {
    return this.panel.querySelector('#decide');
  }

  /** Take note of what can be seen now, and show what may be done. */
  look() {
    this.looking = 0;
    const {foot} = this;
    const view = this.view();
    if (!foot || !view) return;
    const key = foot.dataset.review;
    if (key && key !== this.key) {
      this.key = key;
      // Of an empty line there is nothing to be seen.
      this.lines = view.state.doc.toString().split('\n').map((line) => (line.trim() ? 0 : BOTH));
    }
    if (!key || view.state.doc.toString() !== this.program(foot)) return this.show(foot, null);
    if (document.visibilityState === 'visible') {
      for (const part of this.shown()) {
        this.parts.set(part, (this.parts.get(part) ?? 0) | edges(part, part.getBoundingClientRect()));
      }
      this.lookAtLines(view);
    }
    this.show(foot, this.left());
  }

  /** The program that the review is of, as the server has handed it over. */
  program(foot) {
    return JSON.parse(foot.dataset.program).replace(/\r\n?/g, '\n');
  }

  lookAtLines(view) {
    const {left, right} = view.contentDOM.getBoundingClientRect();
    for (let number = 1; number <= this.lines.length; number++) {
      if (this.lines[number - 1] === BOTH) continue;
      const line = view.state.doc.line(number);
      if (line.to < view.viewport.from || line.from > view.viewport.to) continue; // not drawn yet
      const block = view.lineBlockAt(line.from);
      const top = view.documentTop + block.top;
      if (top > innerHeight) break;
      const bottom = top + block.height;
      if (bottom > 0) this.lines[number - 1] |= edges(view.dom, {left, right, top, bottom});
    }
  }

  /** The parts of the review in which something stands. */
  shown() {
    return [...this.panel.querySelectorAll(PARTS)].filter((part) => part.textContent.trim());
  }

  /** What has not been seen: parts of the review, numbers of lines. */
  left() {
    const parts = this.shown().filter((part) => this.parts.get(part) !== BOTH);
    const lines = this.lines.flatMap((seen, index) => (seen === BOTH ? [] : [index + 1]));
    return {parts, lines};
  }

  /** `left` is null while there is no review of what stands there. */
  show(foot, left) {
    const all = left && !left.parts.length && !left.lines.length;
    const rests = performance.now() < this.rested;
    const readOn = foot.querySelector('#read-on');
    const hint = foot.querySelector('#left-to-see');
    if (readOn) {
      const held = document.activeElement === readOn;
      readOn.hidden = !left || all;
      if (held && readOn.hidden) hint.focus({preventScroll: true});
    }
    for (const button of foot.querySelectorAll('[data-decides]')) {
      button.hidden = Boolean(left) && !all;
      button.disabled = !all || rests;
    }
    if (!left) return;
    const said = all ? hint.dataset.seen : this.told(left);
    if (hint.textContent !== said) hint.textContent = said;
  }

  told({parts, lines}) {
    const {words} = this;
    const marks = parts.filter((part) => part.matches('.mark')).length;
    const what = [];
    if (parts.length > marks) what.push(words.left_outcome);
    if (marks) what.push(filled(marks === 1 ? words.left_mark : words.left_marks, {count: marks}));
    if (lines.length) {
      const [first, last] = [lines[0], lines.at(-1)];
      what.push(filled(first === last ? words.left_line : words.left_lines, {first, last}));
    }
    return filled(words.left_to_see, {what: new Intl.ListFormat(document.documentElement.lang || 'en').format(what)});
  }

  /** Go on to the first thing that was not seen. */
  readOn() {
    const {parts, lines} = this.left();
    const view = this.view();
    this.rested = performance.now() + RESTS;
    if (parts.length) {
      const [part] = parts;
      this.bring(part, part.getBoundingClientRect().top, this.parts.get(part) & TOP);
      this.say(part.textContent);
    } else if (lines.length) {
      const line = view.state.doc.line(lines[0]);
      const top = view.documentTop + view.lineBlockAt(line.from).top;
      this.bring(view.dom, top, this.lines[lines[0] - 1] & TOP);
      requestAnimationFrame(() => {
        this.look();
        const left = this.left().lines[0] ?? view.state.doc.lines + 1;
        const until = view.state.doc.line(Math.max(left - 1, lines[0])).to;
        this.say(view.state.sliceDoc(line.from, until));
      });
    }
  }

  /** Scroll what holds an element so that this height of it comes into view below what lies over it.
   * `begun`: it is longer than the screen, and its beginning was seen; then a screen further. */
  bring(element, top, begun) {
    const bar = document.querySelector('header.frame').getBoundingClientRect();
    const box = scroller(element);
    const above = Math.max(bar.top < 10 ? bar.bottom : 0, box?.getBoundingClientRect().top ?? 0);
    const screen = Math.max(60, this.foot.getBoundingClientRect().top - above - 40);
    (box ?? window).scrollBy({top: begun ? screen : top - above - 8, behavior: 'instant'});
  }

  /** For who does not see it. */
  say(text) {
    this.foot.querySelector('#shown-now').textContent = text.trim();
  }
}

/** Which edges of a box of an element are on the screen, with nothing over them. */
function edges(element, {left, right, top, bottom}) {
  const x = Math.min(left + AWAY_FROM_EDGE, (left + right) / 2);
  const inset = Math.min(3, (bottom - top) / 4);
  const free = (y) => y >= 0 && y < innerHeight && element.contains(document.elementFromPoint(x, y));
  return (free(top + inset) ? TOP : 0) | (free(bottom - inset) ? BOTTOM : 0);
}

/** What scrolls an element; null: the page. */
function scroller(element) {
  for (let box = element.parentElement; box && box !== document.body; box = box.parentElement) {
    const scrolls = /auto|scroll/.test(getComputedStyle(box).overflowY);
    if (scrolls && box.scrollHeight > box.clientHeight + 1) return box;
  }
  return null;
}
