/** The buttons and lists around the map's canvas. */

import {element} from '/static/page.js';

const ICONS = {
  in: 'M12 5v14M5 12h14',
  out: 'M5 12h14',
  fit: 'M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5',
  follow: 'M12 2v5M12 17v5M2 12h5M17 12h5M12 8a4 4 0 1 0 0 8a4 4 0 1 0 0-8',
  layers: 'M12 3l9 5-9 5-9-5zM3 12l9 5 9-5M3 16l9 5 9-5',
  look: 'M2 12s4-7 10-7 10 7 10 7-4 7-10 7S2 12 2 12zM12 9a3 3 0 1 0 0 6a3 3 0 1 0 0-6',
  send: 'M6 21V4M6 4l12 4-12 5',
  localise:
    'M12 3v18M3 12h18M12 3l-3 3M12 3l3 3M12 21l-3-3M12 21l3-3' +
    'M3 12l3-3M3 12l3 3M21 12l-3-3M21 12l-3 3',
  zone: 'M4 4h16v16H4zM4 14L14 4M8 20L20 8M4 20L20 4',
  place: 'M12 21s-7-6-7-11a7 7 0 0 1 14 0c0 5-7 11-7 11zM12 7.5a2.5 2.5 0 1 0 0 5a2.5 2.5 0 1 0 0-5',
};

/** The element, which from now on listens. */
export const listening = (target, kind, listener) => {
  target.addEventListener(kind, listener);
  return target;
};

export const button = (attributes, press, ...inside) =>
  listening(element('button', {type: 'button', ...attributes}, ...inside), 'click', press);

export function icon(name) {
  const space = 'http://www.w3.org/2000/svg';
  const drawing = document.createElementNS(space, 'svg');
  drawing.setAttribute('viewBox', '0 0 24 24');
  drawing.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS(space, 'path');
  path.setAttribute('d', ICONS[name]);
  drawing.append(path);
  return drawing;
}

const iconButton = (name, label, press) =>
  button({class: 'floor-icon', title: label, 'aria-label': label}, press, icon(name));

let made = 0; // groups of radio buttons need names of their own

/** The choice of what a click does. */
export function modeChoice(modes, words, choose) {
  const group = `floor-mode-${++made}`;
  const choices = modes.map((mode) =>
    element(
      'label',
      {class: 'floor-mode'},
      listening(
        element('input', {type: 'radio', name: group, value: mode, checked: mode === modes[0]}),
        'change',
        () => choose(mode),
      ),
      element('span', {}, icon(mode), element('b', {}, words[`mode_${mode}`])),
    ),
  );
  return element(
    'div',
    {class: 'floor-modes', role: 'radiogroup', 'aria-label': words.modes},
    ...choices,
  );
}

/** The menu of what to show. */
export function layerMenu(layers, words, changed) {
  const boxes = Object.keys(layers).map((name) =>
    element(
      'label',
      {},
      listening(element('input', {type: 'checkbox', checked: layers[name]}), 'change', (event) =>
        changed(name, event.target.checked),
      ),
      words[`layer_${name}`],
    ),
  );
  const menu = element(
    'details',
    {class: 'floor-layers'},
    element('summary', {title: words.layers, 'aria-label': words.layers}, icon('layers')),
    element('div', {class: 'floor-menu'}, ...boxes),
  );
  menu.addEventListener('focusout', (event) => {
    if (!menu.contains(event.relatedTarget)) menu.open = false;
  });
  return menu;
}

/** The buttons that move the view; `follow` is the one that stays pressed. */
export function zoomButtons(words, map) {
  const follow = iconButton('follow', words.follow, () => map.follow(!map.following));
  follow.setAttribute('aria-pressed', 'false');
  const buttons = element(
    'div',
    {class: 'floor-zoom', role: 'group', 'aria-label': words.view},
    iconButton('in', words.zoom_in, () => map.zoom(1.4)),
    iconButton('out', words.zoom_out, () => map.zoom(1 / 1.4)),
    iconButton('fit', words.fit, () => map.fit()),
    follow,
  );
  return {buttons, follow};
}

/** The places that are somewhere, as buttons: the way without a mouse. */
export function placeList(places, nameOf, choose) {
  const sorted = places
    .filter(({pose, area}) => pose || area.length)
    .sort((one, two) => nameOf(one).localeCompare(nameOf(two)));
  return sorted.map((place) =>
    button({class: 'chip'}, () => choose(place), nameOf(place)),
  );
}
