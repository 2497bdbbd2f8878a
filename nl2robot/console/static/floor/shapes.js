/** Geometry on the floor, in metres and degrees. */

export const radians = (degrees) => (degrees * Math.PI) / 180;

/** Whether a spot is in a polygon (crossings of a ray to the right). */
export function contains(polygon, x, y) {
  let inside = false;
  let [x1, y1] = polygon[polygon.length - 1];
  for (const [x2, y2] of polygon) {
    if (y1 > y !== y2 > y && x < x1 + ((y - y1) * (x2 - x1)) / (y2 - y1)) inside = !inside;
    [x1, y1] = [x2, y2];
  }
  return inside;
}

export function area(polygon) {
  let sum = 0;
  let [x1, y1] = polygon[polygon.length - 1];
  for (const [x2, y2] of polygon) {
    sum += x1 * y2 - x2 * y1;
    [x1, y1] = [x2, y2];
  }
  return Math.abs(sum) / 2;
}

/** The corners of a rectangle about a pose [x, y, theta], its length along theta. */
export function rectangle([x, y, theta], [length, width]) {
  const cosine = Math.cos(radians(theta));
  const sine = Math.sin(radians(theta));
  return [
    [-1, -1],
    [1, -1],
    [1, 1],
    [-1, 1],
  ].map(([a, b]) => {
    const u = (a * length) / 2;
    const v = (b * width) / 2;
    return [x + u * cosine - v * sine, y + u * sine + v * cosine];
  });
}

/** A spot so far along a pose's direction. */
export function along([x, y, theta], metres) {
  return [x + metres * Math.cos(radians(theta)), y + metres * Math.sin(radians(theta))];
}

/** The least box around points: {left, top, right, bottom}. */
export function boxAbout(points) {
  const box = {left: Infinity, top: Infinity, right: -Infinity, bottom: -Infinity};
  for (const [x, y] of points) {
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.top = Math.min(box.top, y);
    box.bottom = Math.max(box.bottom, y);
  }
  return box;
}

export function boxAt(x, y, width, height) {
  return {
    left: x - width / 2,
    top: y - height / 2,
    right: x + width / 2,
    bottom: y + height / 2,
  };
}

/** How many square pixels two boxes share. */
export function overlap(a, b) {
  const wide = Math.min(a.right, b.right) - Math.max(a.left, b.left);
  const high = Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top);
  return wide > 0 && high > 0 ? wide * high : 0;
}

/** Whether two boxes have a point in common; a line is a box, too. */
export function touches(a, b) {
  return a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;
}

/** The same direction in (-180, 180]. */
export function wrap(degrees) {
  return degrees - 360 * Math.ceil((degrees - 180) / 360);
}

export const distance = (x1, y1, x2, y2) => Math.hypot(x2 - x1, y2 - y1);
