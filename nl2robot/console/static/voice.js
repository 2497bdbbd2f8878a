/**
 * The robot's voice on a page, for a robot that speaks in browsers (`nl2robot serve --speak browser`).
 *
 *   import {playSpeech} from '/static/voice.js';
 *   const voice = playSpeech(wire, {onLevel: moveMouth, onBlocked: showHint});
 *   voice.hush();                    // somebody speaks to it: not a sound more of what it says now
 *   voice.close();
 *
 * The pieces of sound come as events; each is played exactly where the one before it ends. Browsers
 * play nothing before somebody has touched the page or pressed a key: `onBlocked(true)` says that the
 * robot speaks and is not heard for that, and `onBlocked(false)` that they have. What was said until
 * then is not made up for. A robot that speaks elsewhere sends no sound, and nobody is told anything.
 */

const SOON = 0.03; // seconds that the first piece is put ahead, so that its beginning is heard
const LOUD = 0.25; // the level, root mean square, of a voice at its loudest

/**
 * Play what the robot says from now on. `onLevel(level)` is told, at each picture that the browser
 * draws while it speaks, how loud it is (0 to 1), and 0 at its end; `onBlocked(blocked)` as above.
 */
export function playSpeech(wire, {onLevel = () => {}, onBlocked = () => {}} = {}) {
  const context = new AudioContext();
  const ear = new AnalyserNode(context, {fftSize: 512});
  ear.connect(context.destination);
  const wave = new Float32Array(ear.fftSize);
  const playing = new Set();
  let end = 0; // when, by the clock of the sound, what was heard of so far has been played
  let turn = 0; // what was decoded for an earlier one is not to be heard any more
  let decoded = Promise.resolve(); // one piece after the other
  let watching = false;
  let unheard = false;

  function play(sound) {
    const source = new AudioBufferSourceNode(context, {buffer: sound});
    source.connect(ear);
    source.onended = () => playing.delete(source);
    playing.add(source);
    const start = Math.max(end, context.currentTime + SOON);
    source.start(start);
    end = start + sound.duration;
    if (!watching) watch();
  }

  function watch() {
    watching = playing.size > 0;
    if (watching) requestAnimationFrame(watch);
    onLevel(watching ? level() : 0);
  }

  function level() {
    ear.getFloatTimeDomainData(wave);
    const power = wave.reduce((sum, value) => sum + value * value, 0) / wave.length;
    return Math.min(1, Math.sqrt(power) / LOUD);
  }

  function take({audio}) {
    blocked(context.state !== 'running');
    if (unheard) return;
    const mine = turn;
    const sound = context.decodeAudioData(bytes(audio));
    decoded = decoded
      .then(() => sound)
      .then((piece) => mine === turn && play(piece))
      .catch((error) => console.warn(`A piece of speech cannot be played: ${error.message}`));
  }

  function hush() {
    turn += 1;
    end = 0;
    for (const source of playing) source.stop();
    playing.clear();
  }

  function blocked(now) {
    if (now === unheard) return;
    unheard = now;
    onBlocked(now);
  }

  const unlock = () => context.resume();
  context.addEventListener('statechange', () => context.state === 'running' && blocked(false));
  for (const touch of ['pointerdown', 'keydown']) addEventListener(touch, unlock);
  const unsubscribe = [wire.subscribe('sound', take), wire.subscribe('silence', hush)];
  // A connection that is lost takes the rest of the sentence along.
  unsubscribe.push(wire.onChange((connected) => connected || hush()));

  return {
    hush,
    /** Whether anything is heard or about to be. */
    get speaking() {
      return playing.size > 0;
    },
    close() {
      hush();
      unsubscribe.forEach((each) => each());
      for (const touch of ['pointerdown', 'keydown']) removeEventListener(touch, unlock);
      context.close();
    },
  };
}

/** What is written in base64, as a buffer. */
function bytes(text) {
  return Uint8Array.from(atob(text), (character) => character.charCodeAt(0)).buffer;
}
