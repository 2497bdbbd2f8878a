/**
 * The buttons of the face that begin something: each is wanted by an approved appointment, and gone
 * when that is paused, removed or no longer approved.
 */

import {element} from '/static/page.js';

const RESTS_FOR = 2000; // milliseconds after a press in which the same button takes none
const MANY = 4; // from which on they are smaller

export class Buttons {
  /** `pressed` is told whether a press counted, `failed` why one could not. */
  constructor(root, {wire, pressed, failed}) {
    Object.assign(this, {root, wire, pressed, failed});
    this.names = [];
    wire.subscribe('schedule.buttons', ({buttons}) => this.show(buttons));
  }

  async fetch() {
    this.show(await this.wire.request('schedule.buttons'));
  }

  show(names) {
    if (JSON.stringify(names) === JSON.stringify(this.names)) return;
    this.names = names;
    const kept = new Map([...this.root.children].map((each) => [each.textContent, each]));
    this.root.replaceChildren(...names.map((name) => kept.get(name) ?? this.button(name)));
    this.root.toggleAttribute('data-many', names.length >= MANY);
    this.root.hidden = !names.length;
  }

  button(name) {
    const made = element('button', {type: 'button', class: 'begins'}, name);
    made.addEventListener('click', () => this.press(made, name));
    return made;
  }

  async press(button, name) {
    if (button.getAttribute('aria-disabled') === 'true') return;
    button.setAttribute('aria-disabled', 'true'); // it keeps the focus
    setTimeout(() => button.removeAttribute('aria-disabled'), RESTS_FOR);
    try {
      this.pressed(await this.wire.request('schedule.press', {button: name}));
    } catch (error) {
      this.failed(error.message);
    }
  }
}
