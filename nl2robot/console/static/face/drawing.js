/**
 * The robot's face, drawn by ourselves: a few numbers say how it looks, and a drawing follows them.
 *
 *   const face = drawFace(element);
 *   face.look({emotion: 'happy', activity: 'listening'});
 *   face.speak(3.5);      // or, where it is heard here: face.sound(0.4), how loud it is just now
 *
 * By itself it blinks, breathes and lets its eyes wander, unless the system asks for less motion.
 */

const EYES = [
  {x: 128, side: 1},
  {x: 272, side: -1},
];
const EYE_Y = 128;
const EYE_WIDE = 47;
const EYE_HIGH = 58;
const MOUTH = {x: 200, y: 238, wide: 56};

/** What a look is made of, as the neutral one has it. */
const NEUTRAL = {
  eye: 1, // the size of the eyes
  lid: 0.08, // how far the upper lids hang
  slant: 0, // which way the upper lids lean: 1 is angry, -1 sad
  low: 0, // how far the lower lids are raised
  squint: 0, // how much more closed the left eye is than the right
  pupil: 1,
  x: 0, // where the eyes look, -1 to 1
  y: 0,
  brow: 0, // how high the brows are
  tilt: 0, // which way the brows lean: 1 is angry, -1 sad
  lift: 0, // how much higher the right brow is than the left
  smile: 0.45,
  open: 0, // how open the mouth is
  wide: 1,
  wave: 0, // a mouth that does not know
  skew: 0,
  nod: 0, // degrees that the head leans
  blush: 0,
};

const LOOKS = {
  neutral: {},
  happy: {lid: -0.04, low: 0.25, smile: 1, open: 0.6, wide: 1.25, brow: 12, pupil: 1.1, blush: 0.75, nod: -2},
  sad: {lid: 0.3, slant: -0.75, smile: -0.85, wide: 0.85, brow: 4, tilt: -1, y: 0.4, pupil: 1.1, nod: 4},
  confused: {squint: 0.36, lid: 0.04, lift: 24, brow: -4, smile: -0.1, wave: 15, wide: 0.9, nod: 8, x: 0.3, y: 0.05},
  angry: {lid: 0.24, slant: 0.9, low: 0.14, smile: -0.7, wide: 0.9, brow: -13, tilt: 1, pupil: 0.85},
  surprised: {eye: 1.14, lid: -0.1, low: 0, pupil: 0.78, brow: 25, open: 0.85, wide: 0.42, smile: 0},
  thinking: {x: -0.75, y: -0.85, lift: 15, brow: 6, smile: 0.12, wide: 0.6, skew: 1, nod: -5, lid: 0.06},
  listening: {eye: 1.06, lid: -0.04, brow: 13, smile: 0.55, wide: 0.85, nod: 6, pupil: 1.12},
};

/** Other names that robots have for these. */
const ALIASES = {
  joy: 'happy', joyful: 'happy', glad: 'happy', smile: 'happy', excited: 'happy', love: 'happy',
  sorrow: 'sad', unhappy: 'sad', tired: 'sad', worried: 'sad', afraid: 'surprised', fear: 'surprised',
  surprise: 'surprised', amazed: 'surprised', puzzled: 'confused', unsure: 'confused',
  rage: 'angry', anger: 'angry', annoyed: 'angry', calm: 'neutral', normal: 'neutral',
};

const SVG = 'http://www.w3.org/2000/svg';
const QUICK = 0.085; // seconds in which a feature covers most of its way to a new look
const SYLLABLE = 0.17;
const SHORTEST_FRAME = 0.025; // seconds: thirty pictures a second on a screen that shows sixty
const SOUND_LASTS = 0.25; // seconds after which a sound that is not told of any more is over

/** The look of that name, or of its alias; neutral for one that nobody knows. */
export function lookNamed(name) {
  const known = ALIASES[name?.toLowerCase()] ?? name?.toLowerCase();
  return known in LOOKS ? known : 'neutral';
}

export function drawFace(element) {
  return new Face(element);
}

class Face {
  constructor(element) {
    this._element = element;
    this._still = matchMedia('(prefers-reduced-motion: reduce)');
    this._now = {...NEUTRAL};
    this._aim = {...NEUTRAL};
    this._gaze = {x: 0, y: 0};
    this._gazeAim = {x: 0, y: 0};
    this._nextGaze = this._nextBlink = 1.5;
    this._blinkAt = -1;
    this._speaksUntil = 0;
    this._loud = 0;
    this._loudUntil = 0;
    this._time = performance.now() / 1000;
    element.innerHTML = PICTURE;
    this._parts = Object.fromEntries(
      [...element.querySelectorAll('[data-part]')].map((part) => [part.dataset.part, part]),
    );
    this.look({});
    Object.assign(this._now, this._aim);
    this._draw(0, 0);
    requestAnimationFrame(() => this._step());
  }

  /** How the robot feels, and whether it is `thinking` or `listening` besides. */
  look({emotion = 'neutral', activity = null}) {
    const feeling = lookNamed(emotion);
    // Who feels something keeps that face while listening; only the signs beside it are added.
    const shown = feeling === 'neutral' && activity ? activity : feeling;
    this._aim = {...NEUTRAL, ...LOOKS[shown]};
    this._element.dataset.look = shown;
    this._element.dataset.activity = activity ?? '';
    this._nextBlink = Math.min(this._nextBlink, this._time + 0.05);
    return shown;
  }

  /** Move the mouth for so many seconds; 0 closes it. */
  speak(seconds) {
    this._speaksUntil = performance.now() / 1000 + seconds;
    this._element.dataset.speaking = seconds > 0 ? 'yes' : '';
  }

  /** Move the mouth as loud as it sounds, 0 to 1; 0 when nothing sounds any more. */
  sound(level) {
    const now = performance.now() / 1000;
    this._loud = level;
    this._loudUntil = now + SOUND_LASTS;
    if (level > 0) this.speak(Math.max(SOUND_LASTS, this._speaksUntil - now));
    else this._speaksUntil = Math.min(this._speaksUntil, now + SOUND_LASTS);
  }

  get speaking() {
    return performance.now() / 1000 < this._speaksUntil;
  }

  _step() {
    const time = performance.now() / 1000;
    const still = this._still.matches;
    // A face that never moves by itself need not be drawn so often, and a tablet has its limits.
    if (still) setTimeout(() => this._step(), 120);
    else requestAnimationFrame(() => this._step());
    if (time - this._time < SHORTEST_FRAME) return;
    const passed = Math.min(0.1, time - this._time);
    this._time = time;
    const part = still ? 1 : 1 - Math.exp(-passed / QUICK);
    for (const name of Object.keys(NEUTRAL)) {
      this._now[name] += (this._aim[name] - this._now[name]) * part;
    }
    if (!still) this._live(time, part);
    if (!this.speaking && this._element.dataset.speaking) this._element.dataset.speaking = '';
    this._draw(still ? 0 : time, still ? 0 : this._blink(time));
  }

  /** The eyes wander, as eyes do. */
  _live(time, part) {
    if (time > this._nextGaze) {
      const away = Math.random() < 0.4;
      this._gazeAim = {
        x: away ? (Math.random() - 0.5) * 1.2 : (Math.random() - 0.5) * 0.2,
        y: away ? (Math.random() - 0.5) * 0.7 : 0,
      };
      this._nextGaze = time + 0.8 + Math.random() * 2.6;
    }
    this._gaze.x += (this._gazeAim.x - this._gaze.x) * part;
    this._gaze.y += (this._gazeAim.y - this._gaze.y) * part;
  }

  /** How closed the eyes are for a blink, 0 to 1. */
  _blink(time) {
    if (time > this._nextBlink) {
      this._blinkAt = time;
      this._nextBlink = time + (Math.random() < 0.18 ? 0.28 : 2 + Math.random() * 3.8);
    }
    const since = time - this._blinkAt;
    return since < 0.16 ? Math.sin((since / 0.16) * Math.PI) : 0;
  }

  _draw(time, blink) {
    const now = this._now;
    const breath = time ? Math.sin((time / 4.2) * 2 * Math.PI) : 0;
    const sway = time ? Math.sin((time / 7.1) * 2 * Math.PI) * 0.8 : 0;
    set(this._parts.head, {
      transform: `translate(0 ${round(breath * 2.6)}) rotate(${round(now.nod + sway)} 200 200)`,
    });
    EYES.forEach((eye, index) => this._drawEye(eye, index, blink));
    this._drawBrows(breath);
    this._drawMouth(time);
    for (const cheek of ['cheek0', 'cheek1']) set(this._parts[cheek], {opacity: round(now.blush)});
  }

  _drawEye({x, side}, index, blink) {
    const now = this._now;
    const [wide, high] = [EYE_WIDE * now.eye, EYE_HIGH * now.eye];
    const shut = Math.max(blink, side > 0 ? now.squint : 0);
    // The lids meet a little below the middle; a lid that is quite open is out of sight.
    const meet = high * 0.35;
    const upper = mix(-high * (1 - 2 * now.lid) - hidden(now.lid), meet, shut);
    const lower = mix(high * (1 - 2 * now.low) + hidden(now.low), meet, blink);
    const lean = now.slant * high * 0.5 * (1 - blink) * side;
    const arch = 10 + now.low * 50 * (1 - blink);
    const edge = wide + 14;
    const left = Math.min(upper - lean, lower);
    const right = Math.min(upper + lean, lower);
    const middle = Math.min((left + right) / 2 - 10 * (1 - 1.6 * shut), lower);
    const line = `M${-edge} ${round(left)}Q0 ${round(middle)} ${edge} ${round(right)}`;
    const below = `M${-edge} ${round(lower + arch * 0.5)}Q0 ${round(lower - arch)} ${edge} ${round(lower + arch * 0.5)}`;
    set(this._parts[`upper${index}`], {d: `${line}V${-high - 30}H${-edge}Z`});
    set(this._parts[`lower${index}`], {d: `${below}V${high + 40}H${-edge}Z`});
    set(this._parts[`lash${index}`], {d: line});
    for (const ball of [`ball${index}`, `rim${index}`]) set(this._parts[ball], {rx: round(wide), ry: round(high)});
    set(this._parts[`eye${index}`], {transform: `translate(${x} ${EYE_Y})`});
    const lookX = clamp(now.x + this._gaze.x, 1) * 15;
    const lookY = clamp(now.y + this._gaze.y, 1) * 20;
    set(this._parts[`iris${index}`], {
      transform: `translate(${round(lookX)} ${round(lookY)}) scale(${round(now.pupil)})`,
    });
  }

  _drawBrows(breath) {
    const now = this._now;
    EYES.forEach(({x, side}, index) => {
      const high = 47 - now.brow * 0.9 - (side < 0 ? now.lift : 0) + breath;
      const lean = now.tilt * 15 * side;
      const [left, right] = [high - lean, high + lean];
      const bow = 12 * (1 - Math.abs(now.tilt) * 0.8);
      set(this._parts[`brow${index}`], {
        d: `M${x - 42} ${round(left)}Q${x} ${round((left + right) / 2 - bow)} ${x + 42} ${round(right)}`,
      });
    });
  }

  _drawMouth(time) {
    const now = this._now;
    let open = now.open;
    let half = MOUTH.wide * now.wide;
    if (this.speaking) {
      const beat = time || 0.1;
      const heard = performance.now() / 1000 < this._loudUntil;
      const babble = Math.sin((beat / SYLLABLE) * Math.PI * 0.5) * Math.sin(beat * 3.7 + 1);
      const talk = heard ? this._loud : Math.abs(babble);
      open = Math.max(open * 0.5, 0.16) + 0.5 * talk;
      half *= 0.82 + 0.16 * Math.cos(beat * 5.3);
    }
    const corner = -now.smile * 17;
    const left = corner + now.skew * 7;
    const right = corner - now.skew * 7;
    const upper = now.smile * 20 - open * 20 - (now.wide < 0.5 ? open * 22 : 0);
    const lower = now.smile * 20 + open * 62;
    const reach = half * (now.wide < 0.5 ? 1.05 : 0.62);
    const d =
      `M${-half} ${round(left)}` +
      `C${-reach} ${round(upper + now.wave * 1.6)} ${reach} ${round(upper - now.wave * 1.6)} ${half} ${round(right)}` +
      `C${reach} ${round(lower - now.wave * 1.6)} ${-reach} ${round(lower + now.wave * 1.6)} ${-half} ${round(left)}Z`;
    for (const part of ['mouth', 'cavity', 'inside']) set(this._parts[part], {d});
    set(this._parts.tongue, {cy: round(lower * 0.75 + 14), rx: round(half * 0.6)});
  }
}

function eyePicture(index) {
  return `
  <g data-part="eye${index}">
    <clipPath id="rim${index}"><ellipse data-part="rim${index}"/></clipPath>
    <ellipse data-part="ball${index}" class="ball"/>
    <g clip-path="url(#rim${index})">
      <g data-part="iris${index}">
        <circle r="31" class="iris"/>
        <circle r="19" class="pupil"/>
        <circle cx="-11" cy="-13" r="9" class="spark"/>
        <circle cx="10" cy="10" r="4.5" class="spark faint"/>
      </g>
      <path data-part="lower${index}" class="eyelid"/>
      <path data-part="upper${index}" class="eyelid"/>
      <path data-part="lash${index}" class="lash"/>
    </g>
  </g>`;
}

const PICTURE = `
<svg viewBox="-4 0 408 306" xmlns="${SVG}" aria-hidden="true" focusable="false">
  <defs>
    <radialGradient id="white" cx=".5" cy=".42" r=".65">
      <stop offset=".55" stop-color="#ffffff"/><stop offset="1" stop-color="#b9dcf2"/>
    </radialGradient>
    <radialGradient id="iris" cx=".5" cy=".55" r=".55">
      <stop offset=".2" stop-color="#36d6d0"/><stop offset="1" stop-color="#0a7f95"/>
    </radialGradient>
    <radialGradient id="cheek"><stop offset="0" stop-color="#ff8f9c" stop-opacity=".75"/>
      <stop offset="1" stop-color="#ff8f9c" stop-opacity="0"/></radialGradient>
    <clipPath id="inside"><path data-part="inside"/></clipPath>
  </defs>
  <g data-part="head">
    <ellipse data-part="cheek0" class="cheek" cx="66" cy="202" rx="42" ry="27"/>
    <ellipse data-part="cheek1" class="cheek" cx="334" cy="202" rx="42" ry="27"/>
    ${eyePicture(0)}${eyePicture(1)}
    <path data-part="brow0" class="brow"/><path data-part="brow1" class="brow"/>
    <g transform="translate(${MOUTH.x} ${MOUTH.y})">
      <path data-part="cavity" class="cavity"/>
      <g clip-path="url(#inside)"><ellipse data-part="tongue" class="tongue" cx="0" ry="24"/></g>
      <path data-part="mouth" class="mouth"/>
    </g>
    <path class="sign tear" d="M92 196c-9 14-13 20-13 27a13 13 0 0 0 26 0c0-7-4-13-13-27z"/>
  </g>
  <g class="sign question"><path d="M352 62a20 20 0 1 1 28 18c-7 4-8 8-8 15"/><circle cx="372" cy="112" r="5"/></g>
  <g class="sign dots"><circle cx="20" cy="66" r="7"/><circle cx="40" cy="46" r="9"/><circle cx="66" cy="22" r="12"/></g>
  <g class="sign waves">
    <path d="M32 112q-15 18 0 36"/><path d="M16 98q-27 32 0 64"/>
    <path d="M368 112q15 18 0 36"/><path d="M384 98q27 32 0 64"/>
  </g>
  <g class="sign cross"><path d="M352 22q4 16 20 16M384 22q-4 16 12 18M352 66q2-16 18-16M380 68q0-16 16-18"/></g>
</svg>`;

function set(part, attributes) {
  // Most of a face is as it was a moment ago, and only what changes has to be drawn.
  for (const [name, value] of Object.entries(attributes)) {
    if (part.getAttribute(name) !== `${value}`) part.setAttribute(name, value);
  }
}

/** How much farther away a lid is that is as good as open. */
const hidden = (lid) => 12 * clamp(Math.max(0, 1 - lid * 14), 1);
const round = (number) => Math.round(number * 100) / 100;
const mix = (from, to, part) => from + (to - from) * part;
const clamp = (number, most) => Math.max(-most, Math.min(most, number));
