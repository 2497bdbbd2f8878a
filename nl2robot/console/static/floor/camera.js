/** Where the eye is over the floor: metres to pixels and back. y points up on the floor. */

const CLOSEST = 220; // pixels a metre

export class Camera {
  constructor() {
    this.scale = 30;
    /** The spot of the floor in the middle of the picture, in metres. */
    this.x = 0;
    this.y = 0;
    this.width = 1;
    this.height = 1;
    this.bounds = [0, 0, 1, 1];
    /** Whether the whole floor is in the picture and stays so when the picture's size changes. */
    this.fitted = true;
  }

  /** What there is to see, with some metres around it. */
  setBounds([x1, y1, x2, y2], around = 0.4) {
    this.bounds = [x1 - around, y1 - around, x2 + around, y2 + around];
    this.fit();
  }

  /** Of all there is to see: its width by its height. */
  get proportion() {
    const [x1, y1, x2, y2] = this.bounds;
    return (x2 - x1) / (y2 - y1);
  }

  setSize(width, height) {
    this.width = Math.max(width, 1);
    this.height = Math.max(height, 1);
    if (this.fitted) this.fit();
    else this.#keepInSight();
  }

  fit() {
    const [x1, y1, x2, y2] = this.bounds;
    this.scale = this.#fitScale();
    this.x = (x1 + x2) / 2;
    this.y = (y1 + y2) / 2;
    this.fitted = true;
  }

  #fitScale() {
    const [x1, y1, x2, y2] = this.bounds;
    return Math.min(this.width / Math.max(x2 - x1, 4), this.height / Math.max(y2 - y1, 4), 90);
  }

  /** @returns {[number, number]} pixels of a spot in metres */
  toScreen(x, y) {
    return [
      this.width / 2 + (x - this.x) * this.scale,
      this.height / 2 - (y - this.y) * this.scale,
    ];
  }

  /** @returns {[number, number]} metres of a pixel */
  toFloor(u, v) {
    return [
      this.x + (u - this.width / 2) / this.scale,
      this.y - (v - this.height / 2) / this.scale,
    ];
  }

  pan(du, dv) {
    this.x -= du / this.scale;
    this.y += dv / this.scale;
    this.fitted = false;
    this.#keepInSight();
  }

  /** Zoom by a factor; what is under the pixel stays there. */
  zoom(factor, u = this.width / 2, v = this.height / 2) {
    const [x, y] = this.toFloor(u, v);
    const least = this.#fitScale() * 0.8;
    this.scale = Math.min(Math.max(this.scale * factor, least), CLOSEST);
    this.x = x - (u - this.width / 2) / this.scale;
    this.y = y + (v - this.height / 2) / this.scale;
    this.fitted = false;
    this.#keepInSight();
  }

  centre(x, y) {
    this.x = x;
    this.y = y;
    this.fitted = false;
  }

  /** The middle of the picture stays over the floor. */
  #keepInSight() {
    const [x1, y1, x2, y2] = this.bounds;
    this.x = Math.min(Math.max(this.x, x1), x2);
    this.y = Math.min(Math.max(this.y, y1), y2);
  }
}
