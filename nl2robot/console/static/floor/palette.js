/** The colours of the floor, as the style sheet has them for the present look. */

/** Reads `--floor-*` from an element; kinds that the style sheet does not know get a tint of
 * their own, always the same. */
export class Palette {
  constructor(element) {
    this.element = element;
    this.read();
  }

  /** Read the style sheet again, after the look has changed. */
  read() {
    this.style = getComputedStyle(this.element);
    this.known = new Map();
  }

  /** The colour called --floor-NAME. */
  get(name) {
    if (!this.known.has(name)) {
      this.known.set(name, this.style.getPropertyValue(`--floor-${name}`).trim());
    }
    return this.known.get(name);
  }

  room(kind) {
    return this.get(`room-${slug(kind)}`) || `hsl(${hue(kind)} ${this.get('room-tint')})`;
  }

  person(kind) {
    return this.get(`person-${slug(kind)}`) || `hsl(${hue(kind)} ${this.get('person-tint')})`;
  }

  /** Fill and rim of a piece of furniture. */
  furniture(kind) {
    const material = MATERIALS[kind] || 'wood';
    return [this.get(material), this.get(`${material}-rim`)];
  }
}

const MATERIALS = {
  bed: 'linen',
  chair: 'cloth',
  sofa: 'cloth',
  armchair: 'cloth',
  plant: 'leaf',
  ...Object.fromEntries(
    ['fridge', 'machine', 'scanner', 'monitor', 'incubator', 'washbasin', 'trolley'].map(
      (kind) => [kind, 'steel'],
    ),
  ),
};

const slug = (kind) => kind.toLowerCase().replaceAll(/[^a-z]+/g, '-');

function hue(kind) {
  let hash = 5381;
  for (const letter of kind) hash = (hash * 33 + letter.codePointAt(0)) >>> 0;
  return hash % 360;
}
