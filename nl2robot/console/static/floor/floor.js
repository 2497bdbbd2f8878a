/** The floor as the server describes it, with the names of one language. */

import {area, contains, distance, rectangle} from './shapes.js';

const WITHIN_REACH = 1; // metres around the pose of a place without an area

export class Floor {
  /** @param {object} plan what `scene.floor` returns */
  constructor(plan, language) {
    Object.assign(this, plan);
    this.language = language;
  }

  /** What a place, a piece of furniture or a thing is called here. */
  nameOf(named) {
    return named.names[this.language] ?? named.name;
  }

  personName(name) {
    return this.people[name]?.[this.language] ?? name;
  }

  thingName(name) {
    const thing = this.things.find((each) => each.name === name);
    return thing ? this.nameOf(thing) : name;
  }

  /** A spot {x, y, place} in few words. */
  spotName({x, y, place}) {
    const named = this.places.find(({name}) => name === place);
    return named ? this.nameOf(named) : (place ?? `${x.toFixed(1)}, ${y.toFixed(1)}`);
  }

  /** The place that a spot is in: of several areas the smallest. */
  placeAt(x, y) {
    let best = null;
    let least = Infinity;
    for (const place of this.places) {
      let size = Infinity;
      if (place.area.length) {
        if (contains(place.area, x, y)) size = area(place.area);
      } else if (place.pose) {
        const far = distance(place.pose[0], place.pose[1], x, y);
        if (far <= WITHIN_REACH) size = Math.PI * far * far;
      }
      if (size < least) [best, least] = [place, size];
    }
    return best;
  }

  /** Where one stands in a place, or its middle. */
  middleOf(place) {
    if (place.pose) return place.pose.slice(0, 2);
    const count = Math.max(place.area.length, 1);
    const sum = place.area.reduce(([a, b], [x, y]) => [a + x, b + y], [0, 0]);
    return [sum[0] / count, sum[1] / count];
  }

  /** The place near whose pose a spot is, within so many metres. */
  placeNear(x, y, metres) {
    const far = ({pose}) => distance(pose[0], pose[1], x, y);
    const near = this.places.filter((place) => place.pose && far(place) < metres);
    return near.sort((one, two) => far(one) - far(two))[0] ?? null;
  }

  /** The things that lie about: where they were at first, but for those that were moved. */
  thingsIn(scene) {
    const moved = new Map(scene.things.map((thing) => [thing[0], thing]));
    return this.things.flatMap((thing) => {
      const [, x, y, holder] = moved.get(thing.number) ?? [0, thing.x, thing.y, null];
      return holder === null ? [{...thing, x, y}] : [];
    });
  }

  furnitureAt(x, y) {
    return this.furniture.find(({pose, size}) => contains(rectangle(pose, size), x, y));
  }
}
