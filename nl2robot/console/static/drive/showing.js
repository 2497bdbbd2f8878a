/** What the robot shows, scans, and whom it calls. */

import {notice} from '/static/console.js';
import {element} from '/static/page.js';
import {helm} from './helm.js';
import {button, controls, doing, labelled, newId, panel} from './panel.js';
import {robot} from './robot.js';
import {say} from './texts.js';

/** The longest page of HTML that a robot takes, with room for what stands around a picture. */
const LONGEST_PICTURE = 95_000;
const WIDTHS = [1024, 800, 640, 480, 320];

// --- the screen

export function screenPanel(body) {
  const kinds = ['text', 'url', 'picture'];
  const group = newId('show');
  const fields = {
    text: labelled(say('show_text'), element('textarea', {class: 'field', rows: 2, maxlength: 2000})),
    url: labelled(
      say('show_url'),
      element('input', {class: 'field', type: 'url', placeholder: 'https://'}),
    ),
    picture: labelled(
      say('show_picture'),
      element('input', {class: 'field', type: 'file', accept: 'image/*'}),
    ),
  };
  const choice = element('div', {class: 'segments', role: 'radiogroup', 'aria-label': say('show')});
  let kind = 'text';
  const choose = (chosen) => {
    kind = chosen;
    for (const each of kinds) fields[each].hidden = each !== kind;
  };
  for (const each of kinds) {
    const input = element('input', {type: 'radio', name: group, checked: each === kind});
    input.addEventListener('change', () => choose(each));
    choice.append(element('label', {}, input, element('span', {}, say(`show_${each}`))));
  }
  choose(kind);
  const valueOf = () => fields[kind].lastElementChild;
  const show = async () => {
    const given = await content(kind, valueOf());
    if (given) await helm.call('show', given);
  };
  const tools = element(
    'div',
    {class: 'row'},
    button(say('show'), show, {class: 'primary'}),
    button(say('clear'), () => helm.call('show', {text: ' '})),
  );
  return panel('screen', controls(choice, ...Object.values(fields), tools), preview());
}

async function content(kind, field) {
  if (kind === 'picture') {
    const file = field.files[0];
    if (!file) return null;
    const picture = await asData(file);
    const style = 'margin:0;height:100vh;display:grid;place-items:center;background:#000';
    const inside = `<img src="${picture}" alt="" style="max-width:100%;max-height:100vh">`;
    return {html: `<!doctype html><title>picture</title><body style="${style}">${inside}</body>`};
  }
  const given = field.value.trim();
  return given ? {[kind]: given} : null;
}

/** A picture as a data URL, made small enough for the robot's wire. */
async function asData(file) {
  let bitmap;
  try {
    bitmap = await createImageBitmap(file);
  } catch {
    throw new Error(say('no_picture'));
  }
  const canvas = document.createElement('canvas');
  for (const width of WIDTHS) {
    const part = Math.min(1, width / bitmap.width, width / bitmap.height);
    canvas.width = Math.round(bitmap.width * part);
    canvas.height = Math.round(bitmap.height * part);
    canvas.getContext('2d').drawImage(bitmap, 0, 0, canvas.width, canvas.height);
    const made = canvas.toDataURL('image/jpeg', 0.8);
    if (made.length <= LONGEST_PICTURE) return made;
  }
  throw new Error(say('no_picture'));
}

/** What the screen shows now. */
function preview() {
  const frame = element('iframe', {sandbox: '', title: say('screen_now'), tabindex: -1});
  const words = element('p');
  const box = element('div', {class: 'screen-now', role: 'status'}, words, frame);
  const show = (content) => {
    frame.hidden = !content.html;
    frame.srcdoc = content.html ?? '';
    words.hidden = Boolean(content.html);
    const options = content.options ? `: ${content.options.join(' · ')}` : '';
    const text = `${content.url ?? content.text ?? ''}${options}`.trim();
    words.textContent = text || say('screen_empty');
    words.classList.toggle('muted', !text);
  };
  robot.follow('screen', (content) => show(content ?? {}));
  return box;
}

// --- codes

const FRAME_EVERY = 300;
const FRAME_WIDTH = 800;

export function codePanel(body) {
  const found = element('ul', {class: 'codes', 'aria-live': 'polite'});
  const add = ({text, format}) => {
    if (found.firstElementChild?.dataset.code === text) return;
    const copy = button(say('copy'), () => copied(text), {class: 'small'});
    const item = element('li', {}, element('code', {}, text), element('small', {}, format), copy);
    item.dataset.code = text;
    found.prepend(item);
    while (found.children.length > 10) found.lastElementChild.remove();
  };
  const told = element('p', {class: 'muted', role: 'status'});
  const file = element('input', {type: 'file', accept: 'image/*', class: 'sr'});
  file.addEventListener('change', async () => {
    const picture = file.files[0];
    file.value = '';
    if (!picture) return;
    const codes = await doing(read(picture));
    if (!codes) return;
    told.textContent = codes.length ? '' : say('no_code');
    codes.forEach(add);
  });
  const pick = button(say('code_picture'), async () => file.click());
  file.tabIndex = -1;
  file.setAttribute('aria-label', say('code_picture'));
  const tools = element('div', {class: 'row'}, pick, file);
  const camera = liveCamera(add, told);
  if (navigator.mediaDevices) tools.append(camera.button);
  const inside = [tools, camera.video];
  if (body.methods.includes('scan')) {
    const scan = async () => {
      told.textContent = say('code_hold_up');
      try {
        add({text: await helm.call('scan'), format: say('code_by_robot')});
      } finally {
        told.textContent = '';
      }
    };
    inside.push(controls(button(say('code_robot'), scan)));
  }
  return panel('code', ...inside, told, found);
}

/** The camera of this device, until a code is in its picture. */
function liveCamera(add, told) {
  const video = element('video', {class: 'camera', playsinline: true, hidden: true});
  video.muted = true;
  let stream = null;
  const stop = () => {
    stream?.getTracks().forEach((track) => track.stop());
    stream = null;
    video.hidden = true;
    video.srcObject = null;
    toggle.textContent = say('code_camera');
    told.textContent = '';
  };
  const start = async () => {
    try {
      const wanted = {video: {facingMode: 'environment'}};
      stream = await navigator.mediaDevices.getUserMedia(wanted);
    } catch {
      throw new Error(say('no_camera'));
    }
    video.srcObject = stream;
    video.hidden = false;
    toggle.textContent = say('code_camera_off');
    told.textContent = say('code_hold_up');
    await video.play();
    const look = await reader(video);
    while (stream) {
      const codes = await look();
      if (codes.length && stream) {
        codes.forEach(add);
        stop();
      }
      await new Promise((resume) => setTimeout(resume, FRAME_EVERY));
    }
  };
  const toggle = button(say('code_camera'), () => (stream ? stop() : start()));
  window.addEventListener('pagehide', stop);
  return {button: toggle, video};
}

/** What reads the codes in the picture of a video: the browser itself, or the server. */
async function reader(video) {
  if ('BarcodeDetector' in window && (await BarcodeDetector.getSupportedFormats()).length) {
    const detector = new BarcodeDetector();
    return async () =>
      (await detector.detect(video)).map(({rawValue, format}) => ({text: rawValue, format}));
  }
  const canvas = document.createElement('canvas');
  return async () => {
    canvas.width = FRAME_WIDTH;
    canvas.height = Math.round((FRAME_WIDTH * video.videoHeight) / video.videoWidth) || 1;
    canvas.getContext('2d').drawImage(video, 0, 0, canvas.width, canvas.height);
    const frame = await new Promise((made) => canvas.toBlob(made, 'image/jpeg', 0.85));
    return read(frame).catch(() => []);
  };
}

/** The codes in a picture; the server reads them. */
async function read(picture) {
  const answer = await fetch('/codes', {method: 'POST', body: picture});
  const {codes, trouble} = await answer.json();
  if (trouble) throw new Error(say(trouble === 'too large' ? 'too_large' : 'no_picture'));
  return codes;
}

async function copied(text) {
  await navigator.clipboard.writeText(text);
  notice(say('copied'));
}

// --- telepresence

export function callPanel(body) {
  const state = element('p', {class: 'call-state', role: 'status'});
  const whom = element('select', {class: 'field'});
  whom.append(...body.contacts.map((name) => element('option', {value: name}, name)));
  const ring = button(say('robot_call'), () => helm.call('call', {contact: whom.value}));
  const hangUp = button(say('hang_up'), () => helm.call('hang_up'), {class: 'danger'});
  const show = (call) => {
    state.textContent = call ? say(`call_${call.state}`, {who: call.contact}) : '';
    hangUp.disabled = !call || call.state === 'ended';
  };
  robot.follow('call', show);
  const byRobot = controls(
    labelled(say('contact'), whom),
    element('div', {class: 'row'}, ring, hangUp),
  );
  // With whoever stands before the robot; every page can make such calls (`console.js`).
  const startCall = async () => document.dispatchEvent(new CustomEvent('call-robot'));
  const byPage = button(say('call_robot'), startCall, {class: 'primary'});
  return panel('call', byPage, byRobot, state);
}
