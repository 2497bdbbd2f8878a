/** The page `/map`. */

import {appears, pageData} from '/static/page.js';
import {wire} from '/static/wire.js';
import {mountFloorMap} from './floor_map.js';

const {language, role} = pageData;
const root = await appears('#map');
const map = await mountFloorMap(root, {
  wire,
  language,
  operator: role === 'operator',
  places: true,
});

root.addEventListener('go', ({detail: {x, y, place}}) => {
  // The desk reviews it like any other program.
  const goal = place === null ? `${x}, ${y}` : JSON.stringify(place);
  location.href = `/?program=${encodeURIComponent(`robot.goto(${goal})`)}`;
});

root.addEventListener('localise', async ({detail}) => {
  try {
    await wire.request('robot.localize', detail);
    map.showError('');
  } catch (error) {
    map.showError(error.message);
  }
});
