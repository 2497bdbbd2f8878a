/** Who uses the keyboard, or hears the page, is never thrown back to its beginning.
 *
 * What has the focus may go: a button with the program that it approves, a suggestion with the
 * conversation that is drawn anew. Then the focus goes to what is there in its place under the same
 * id, else to where one goes on from: the line to type in, or the page's content.
 */

const NEXT = ['#words', '#conversation', '#main'];
const FINE = matchMedia('(pointer: fine)');

let held = null;

function lost(element) {
  return !element.isConnected || element.disabled || !element.checkVisibility({visibilityProperty: true});
}

/** Where the focus goes instead. A line to type in would open the keyboard of a screen. */
function next(id) {
  const places = FINE.matches ? NEXT : NEXT.slice(1);
  const same = id && document.getElementById(id);
  return [same, ...places.map((place) => document.querySelector(place))].find((each) => each && !lost(each));
}

function restore() {
  if (document.activeElement !== document.body || !held || !lost(held)) return;
  const {id} = held;
  held = null;
  next(id)?.focus({preventScroll: true});
}

let waiting = 0;

/** What is hidden loses the focus when the page is drawn, after it was changed. */
function changed() {
  restore();
  waiting ||= requestAnimationFrame(() => {
    waiting = 0;
    setTimeout(restore);
  });
}

document.addEventListener('focusin', ({target}) => (held = target));
new MutationObserver(changed).observe(document.documentElement, {
  childList: true,
  subtree: true,
  attributeFilter: ['hidden', 'disabled', 'class', 'open'],
});
