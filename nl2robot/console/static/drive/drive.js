/** The page for direct control. */

import {appears, element, pageData} from '/static/page.js';
import {facePanel, gesturePanel, jointPanel, sayPanel} from './body.js';
import {cameraPanel} from './camera.js';
import {goPanel, helmBar, joystickPanel, mountMap} from './driving.js';
import {helm} from './helm.js';
import {logPanel} from './log.js';
import {panel} from './panel.js';
import {presence} from './presence.js';
import {robot} from './robot.js';
import {callPanel, codePanel, screenPanel} from './showing.js';

const root = await appears('#drive');
const body = await robot.start();
const operates = pageData.role === 'operator';
const has = (method) => body.methods.includes(method);

helm.start(pageData.who, operates);
root.classList.toggle('looks-on', !operates);

const go = has('goto') && operates ? goPanel(body) : null;
const map = element('div', {id: 'drive-map', class: 'floor-hugging'});
const there = operates && has('drive') ? presence(root) : null;
const columns = [
  [there?.pane, panel('map', map), body.camera && operates && cameraPanel(), go?.section, logPanel()],
  [
    has('drive') && operates && joystickPanel(body, () => go?.cancel()),
    has('say') && sayPanel(body, pageData.language),
    has('show') && screenPanel(body),
  ],
  [
    has('emotion') && facePanel(body),
    has('gesture') && operates && gesturePanel(body),
    has('joint') && operates && jointPanel(body),
    has('call') && operates && callPanel(body),
    operates && codePanel(body),
  ],
].map((panels) => element('div', {class: 'column'}, ...panels.filter(Boolean)));

root.append(helmBar(body, operates, there?.toggle), element('div', {class: 'columns'}, ...columns));
mountMap(map, pageData.language, go?.run).catch((error) => {
  console.warn(error);
  map.closest('.panel').hidden = true;
});
