/** Makes blocks of 16-bit samples, a tenth of a second each, of what the microphone hears. */

const BLOCKS_A_SECOND = 10;

class Blocks extends AudioWorkletProcessor {
  constructor() {
    super();
    this.block = new Int16Array(Math.round(sampleRate / BLOCKS_A_SECOND));
    this.filled = 0;
    this.power = 0;
    this.peak = 0;
  }

  process([input]) {
    for (const sample of input[0] ?? []) {
      const level = Math.max(-1, Math.min(1, sample));
      this.block[this.filled] = Math.round(level * 32767);
      this.power += level * level;
      this.peak = Math.max(this.peak, Math.abs(level));
      this.filled += 1;
      if (this.filled === this.block.length) this.hand();
    }
    return true;
  }

  hand() {
    const level = Math.sqrt(this.power / this.block.length);
    const samples = this.block.slice();
    this.port.postMessage({samples, level, peak: this.peak}, [samples.buffer]);
    this.filled = this.power = this.peak = 0;
  }
}

registerProcessor('blocks', Blocks);
