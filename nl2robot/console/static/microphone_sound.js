/**
 * The sound of the browser's microphone in blocks of 16-bit samples.
 *
 * The microphone is opened when it is first wanted and let go of `WARM` after it was last used, so
 * that the next sentence begins at once; meanwhile, only the last `PRE_ROLL` of sound lies in this
 * page's memory, and nothing is sent anywhere. It is let go of at once when the page is hidden.
 */

const RATE = 16000; // what the recogniser wants; a browser that cannot give it gives its own
const PRE_ROLL = 3; // blocks, of a tenth of a second: the first word may begin before the press
const WARM = 30_000; // milliseconds

const ASKED = {channelCount: 1, echoCancellation: true, autoGainControl: true, noiseSuppression: false};

/** Why there is no sound; `reason` is a key of texts/microphone.yaml. */
export class NoSound extends Error {
  constructor(reason, detail = '') {
    super(detail || reason);
    this.reason = reason;
  }
}

const REASONS = {
  NotAllowedError: 'denied',
  SecurityError: 'denied',
  NotFoundError: 'no_microphone',
  OverconstrainedError: 'no_microphone',
  NotReadableError: 'in_use',
  AbortError: 'in_use',
};

async function microphone() {
  if (!window.isSecureContext || !navigator.mediaDevices?.getUserMedia) throw new NoSound('not_secure');
  try {
    return await navigator.mediaDevices.getUserMedia({audio: ASKED});
  } catch (error) {
    throw new NoSound(REASONS[error.name] ?? 'failed', error.message);
  }
}

export class Sound {
  /** `onEnded()` is told when the microphone goes away by itself, `onLetGo()` when it is closed. */
  constructor({onEnded, onLetGo, warm = WARM}) {
    this.rate = 0;
    this._onEnded = onEnded;
    this._onLetGo = onLetGo;
    this._warm = warm;
    this._opened = null;
    this._before = [];
    this._listener = null;
    this._attentive = null;
  }

  /** Whether the microphone is open. */
  get open() {
    return this._opened !== null;
  }

  /**
   * Hear: `listener({samples, level, peak})` for each block from now, and a little before now.
   * Resolves when the sound comes, `rate` says how many samples a second. Rejects with a NoSound, or whatever else went wrong.
   */
  async hear(listener) {
    this._listener = listener;
    await this._ready();
    if (this._listener === listener) for (const block of this._before.splice(0)) listener(block);
  }

  /**
   * Let `listener` have each block as well, whoever else hears, and keep the microphone open for that; null
   * ends it. Resolves and rejects as `hear` does.
   */
  async attend(listener) {
    this._attentive = listener;
    if (!listener) {
      if (!this._listener && this.open) this.rest();
      return;
    }
    await this._ready();
  }

  /** Until the microphone is open. */
  async _ready() {
    clearTimeout(this._cooling);
    const opening = (this._opened ??= this._start());
    try {
      await opening;
    } catch (error) {
      if (this._opened === opening) this.letGo();
      throw error;
    }
  }

  /** What was heard until now is known already. */
  forget() {
    this._before = [];
  }

  /** Hear no more for now; the microphone stays ready for a while. */
  rest() {
    this._listener = null;
    clearTimeout(this._cooling);
    if (!this._attentive) this._cooling = setTimeout(() => this.letGo(), this._warm);
  }

  /** Let go of the microphone: its light goes out. */
  letGo() {
    clearTimeout(this._cooling);
    const opened = this._opened;
    this._opened = this._listener = this._attentive = null;
    this._before = [];
    if (opened) this._onLetGo();
    opened?.then(({context, stream}) => {
      for (const track of stream.getTracks()) track.stop();
      context.close();
    }, () => {});
  }

  async _start() {
    const stream = await microphone();
    let graph;
    try {
      graph = await this._graph(stream, RATE).catch(() => this._graph(stream));
    } catch (error) {
      for (const track of stream.getTracks()) track.stop();
      throw error;
    }
    const {context, node} = graph;
    this.rate = context.sampleRate;
    node.port.onmessage = ({data}) => this._take(data);
    const [track] = stream.getAudioTracks();
    track.addEventListener('ended', () => {
      this._onEnded();
      this.letGo();
    });
    await context.resume();
    return {context, stream};
  }

  async _graph(stream, sampleRate) {
    const context = new AudioContext(sampleRate ? {sampleRate} : {});
    try {
      await context.audioWorklet.addModule(new URL('microphone_worklet.js', import.meta.url));
      const mono = {numberOfOutputs: 0, channelCount: 1, channelCountMode: 'explicit'};
      const node = new AudioWorkletNode(context, 'blocks', mono);
      context.createMediaStreamSource(stream).connect(node);
      return {context, node};
    } catch (error) {
      context.close();
      throw error;
    }
  }

  _take(block) {
    this._attentive?.(block);
    if (this._listener) {
      this._listener(block);
    } else {
      this._before.push(block);
      this._before.splice(0, this._before.length - PRE_ROLL);
    }
  }
}
