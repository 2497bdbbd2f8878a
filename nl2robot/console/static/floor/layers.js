/** Which layers of the map are shown, as this browser remembers them. */

const LAYERS = ['names', 'people', 'things', 'furniture', 'lidar', 'paths', 'zones'];
const KEPT = 'floor-layers';

export function rememberedLayers() {
  const layers = Object.fromEntries(LAYERS.map((name) => [name, true]));
  try {
    const kept = JSON.parse(localStorage.getItem(KEPT) ?? '{}');
    for (const name of LAYERS) if (kept[name] === false) layers[name] = false;
  } catch {
    // What was kept is no JSON, or nothing may be kept: all layers are shown.
  }
  return layers;
}

export function rememberLayers(layers) {
  try {
    localStorage.setItem(KEPT, JSON.stringify(layers));
  } catch {
    // Nothing may be kept in this browser; it holds for this page.
  }
}
