/** The page `/map`. Review and run beside the map are the desk's own. */

import {appears, pageData} from '/static/page.js';
import {wire} from '/static/wire.js';
import {mountFloorMap} from './floor_map.js';
import {proposeClicks} from './sending.js';

const {language, role, who} = pageData;

// The server may say before the map is there what path it is to show.
let path = null;
let map = null;
document.addEventListener('dry-run', ({detail}) => {
  path = detail;
  map?.showPath(path);
});

const root = await appears('#map');
map = await mountFloorMap(root, {wire, language, who, operator: role === 'operator', places: true});
if (path) map.showPath(path);

proposeClicks(map, {
  wire,
  language,
  propose: ({program, said, note}) => {
    const at_once = localStorage.getItem('at_once') === 'yes'; // as chosen at the desk
    window.emitEvent('desk-propose', {program, said, note, at_once});
  },
});
