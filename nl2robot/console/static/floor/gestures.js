/** Mouse, wheel, fingers and keys on the map, told as what they mean. */

const CLICK = 5; // pixels that a click may wander

const KEYS = {
  '+': (hand) => hand.zoom(1.3),
  '=': (hand) => hand.zoom(1.3),
  '-': (hand) => hand.zoom(1 / 1.3),
  0: (hand) => hand.fit(),
  ArrowLeft: (hand) => hand.pan(60, 0),
  ArrowRight: (hand) => hand.pan(-60, 0),
  ArrowUp: (hand) => hand.pan(0, 60),
  ArrowDown: (hand) => hand.pan(0, -60),
};

/**
 * Listen on a stage that can have the focus and the canvas in it.
 * `hand` has press(u, v) -> whether the drag is its own, drag(u, v), release(u, v, clicked),
 * hover(u, v), leave(), pan(du, dv), zoom(factor, u, v), fit().
 */
export function listen(stage, canvas, hand) {
  const fingers = new Map();
  let grip = null; // {u, v, last: [u, v], own, wandered}
  let pinch = null; // {apart, middle}

  const place = (event) => {
    const {left, top} = canvas.getBoundingClientRect();
    return [event.clientX - left, event.clientY - top];
  };

  const pinched = () => {
    const [[u1, v1], [u2, v2]] = fingers.values();
    return {apart: Math.hypot(u2 - u1, v2 - v1), middle: [(u1 + u2) / 2, (v1 + v2) / 2]};
  };

  canvas.addEventListener('pointerdown', (event) => {
    if (event.button) return;
    const [u, v] = place(event);
    canvas.setPointerCapture(event.pointerId);
    stage.focus({preventScroll: true});
    fingers.set(event.pointerId, [u, v]);
    if (fingers.size === 2) {
      if (grip?.own) hand.release(...grip.last, false);
      grip = null;
      pinch = pinched();
    } else if (fingers.size === 1) {
      grip = {u, v, last: [u, v], own: hand.press(u, v), wandered: false};
    }
  });

  canvas.addEventListener('pointermove', (event) => {
    const [u, v] = place(event);
    if (!fingers.has(event.pointerId)) {
      hand.hover(u, v);
      return;
    }
    fingers.set(event.pointerId, [u, v]);
    if (pinch && fingers.size === 2) {
      const now = pinched();
      hand.pan(now.middle[0] - pinch.middle[0], now.middle[1] - pinch.middle[1]);
      hand.zoom(now.apart / Math.max(pinch.apart, 1), ...now.middle);
      pinch = now;
    } else if (grip) {
      grip.wandered ||= Math.hypot(u - grip.u, v - grip.v) > CLICK;
      if (grip.own) hand.drag(u, v);
      else if (grip.wandered) hand.pan(u - grip.last[0], v - grip.last[1]);
      grip.last = [u, v];
    }
  });

  const lift = (event) => {
    if (!fingers.delete(event.pointerId)) return;
    if (grip) hand.release(...grip.last, !grip.wandered && event.type === 'pointerup');
    grip = null;
    if (fingers.size < 2) pinch = null;
  };
  canvas.addEventListener('pointerup', lift);
  canvas.addEventListener('pointercancel', lift);
  canvas.addEventListener('pointerleave', () => hand.leave());

  canvas.addEventListener(
    'wheel',
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
      const factor = Math.exp(-Math.max(-120, Math.min(120, event.deltaY * lines)) * 0.0022);
      hand.zoom(factor, ...place(event));
    },
    {passive: false},
  );

  stage.addEventListener('keydown', (event) => {
    if (event.target !== stage || event.ctrlKey || event.altKey || event.metaKey) return;
    const action = KEYS[event.key];
    if (!action) return;
    action(hand);
    event.preventDefault();
    event.stopPropagation();
  });
}
