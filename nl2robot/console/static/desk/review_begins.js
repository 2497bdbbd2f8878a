/** A new review begins in view, wherever on the page it stands: nobody is to look for what they are
 * asked. Whoever is writing is left where they are. */

/** The part of the screen, from above, in which it may begin. */
const UPPER = 0.5;

/** Watch the panel in which reviews are drawn. */
export function beginInView(panel) {
  let shown = null;
  const look = () => {
    const foot = panel.querySelector('#decide');
    // First it is there, then it is checked: both make it longer.
    const now = foot ? (foot.dataset.review ?? '') : null;
    if (now === shown) return;
    shown = now;
    if (now !== null && !writing()) bring(panel);
  };
  new MutationObserver(look).observe(panel, {childList: true, subtree: true, attributes: true, attributeFilter: ['data-review']});
  look();
}

/** In the program, or in words that are not sent yet. */
function writing() {
  const at = document.activeElement;
  return at?.closest('.desk-editor') != null || Boolean(at?.matches('textarea, input') && at.value);
}

/** Beside the map, what the robot has to say to it stands above. */
function bring(panel) {
  const begin = panel.closest('.map-desk .desk-program') ?? panel;
  const {top} = begin.getBoundingClientRect();
  const bar = document.querySelector('header.frame').getBoundingClientRect();
  if (top >= bar.bottom && top <= innerHeight * UPPER) return;
  begin.scrollIntoView({block: 'start', behavior: 'instant'});
}
