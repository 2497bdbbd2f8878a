/** What every page of the console starts from. */

/** Resolves to the first element of the selector, also if it is only built later. */
export function appears(selector) {
  const there = document.querySelector(selector);
  if (there) return Promise.resolve(there);
  return new Promise((resolve) => {
    const watcher = new MutationObserver(() => {
      const found = document.querySelector(selector);
      if (!found) return;
      watcher.disconnect();
      resolve(found);
    });
    watcher.observe(document.documentElement, {childList: true, subtree: true});
  });
}

/** What the server handed over to the scripts of this page: its texts in `words`, and more. */
export const pageData = JSON.parse(document.getElementById('page-data')?.textContent ?? '{}');

/** Keep a setting of this browser: language, look, name. */
export function keep(name, value) {
  const year = 365 * 24 * 3600;
  document.cookie = `${name}=${encodeURIComponent(value)}; path=/; max-age=${year}; SameSite=Lax`;
}

/** Fill the {gaps} of a text. */
export function filled(text, values) {
  return text.replace(/\{(\w+)\}/g, (gap, name) => values[name] ?? gap);
}

/** A time of day, of seconds since the epoch. */
export function timeOfDay(seconds, language) {
  const format = {hour: '2-digit', minute: '2-digit'};
  return new Date(seconds * 1000).toLocaleTimeString(language, format);
}

/** A new element: element('button', {type: 'button', class: 'button'}, 'Go'). */
export function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (value === false || value == null) continue;
    made.setAttribute(name, value === true ? '' : value);
  }
  made.append(...children);
  return made;
}
