/**
 * A video call between the robot's face and an operator's page, from browser to browser.
 *
 *   const calls = mountCall(element, {wire, words, role: 'operator', who: 'Nurse Ann'});
 *   calls.start();
 *
 * It rings, is answered or declined, shows both pictures and ends; whichever way it ends, camera and
 * microphone are let go of. Who goes to another page of the console stays in the call: the new page
 * takes it up, and the two connect anew. The two browsers find each other over the robot's wire and need no other
 * server; so they must be in one network. `words` are the texts of `call.yaml`.
 */

import {element, filled} from '/static/page.js';

const STYLE = '/static/face/call.css';
const MENDS_WITHIN = 5000;
const CONNECTS_WITHIN = 15000;
const RETURNS_WITHIN = 10000;
const NOTICE_FOR = 5000;
const SIDE = 'call-side';
const RINGS_EVERY = 2200;
const RING_GAIN = 0.15;

export function mountCall(root, options) {
  return new CallView(root, options);
}

class CallView {
  constructor(root, {wire, words, role, who = ''}) {
    this._root = root;
    this._wire = wire;
    this._words = words;
    this._side = role === 'face' ? 'face' : 'operator';
    this._who = who;
    this._call = null;
    if (!document.querySelector(`link[href="${STYLE}"]`)) {
      document.head.append(element('link', {rel: 'stylesheet', href: STYLE}));
    }
    root.classList.add('video-call', this._side);
    root.dataset.side = sessionStorage.getItem(SIDE) ?? 'right';
    root.setAttribute('aria-live', 'assertive');
    wire.subscribe('call.state', (told) => this._told(told));
    wire.subscribe('call.signal', ({call, signal}) => {
      if (call === this._call?.number) this._call.link?.hear(signal);
    });
    wire.onChange((connected) => {
      if (connected) this._offerUp();
      else if (this._call) this._interrupted();
    });
    addEventListener('pagehide', () => this._letGo(this._call));
  }

  /** Let this page be rung up. */
  async _offerUp() {
    await this._wire.request('call.ready', {side: this._side}).catch(() => {});
    this._root.dataset.ready = 'yes';
    const kept = this._kept();
    if (!kept) return;
    const {call, key} = kept;
    const goesOn = await this._wire.request('call.resume', {call, key}).catch(() => null);
    if (goesOn !== false) return;
    this._keep(null);
    if (this._call?.number === call) this._over('lost');
  }

  // --- what another page of this tab needs to take the call up

  /** {call, key, off: what is switched off}, or null. */
  _kept() {
    return JSON.parse(sessionStorage.getItem(this._side + '-call'));
  }

  _keep(kept) {
    const name = this._side + '-call';
    if (kept) sessionStorage.setItem(name, JSON.stringify(kept));
    else sessionStorage.removeItem(name);
  }

  /** The connection to the robot is gone, perhaps for a moment only. */
  _interrupted() {
    const call = this._call;
    if (!this._kept()) {
      this._over('lost');
      return;
    }
    this._wait(call, 'connecting');
    call.patience = setTimeout(() => this._call === call && this._over('lost'), RETURNS_WITHIN);
  }

  /** Wait for a call to go on. */
  _wait(call, sentence) {
    this._letGo(call);
    call.link = call.bell = null;
    call.draw = () =>
      this._draw(
        'waiting',
        element('p', {class: 'call-sentence'}, this._words[sentence]),
        this._row([this._button('hang_up', 'bad', () => this._end('hung_up'))]),
      );
    call.draw();
  }

  /** Call the robot; for operators. */
  async start() {
    try {
      await this._wire.request('call.start', {who: this._who || 'nl2robot'});
    } catch (error) {
      this._notice(error.message);
    }
  }

  /** Use other words from now on. */
  speak(words) {
    if (words === this._words) return;
    this._words = words;
    if (this._call?.draw) this._call.draw();
  }

  _told(told) {
    const current = this._call;
    if (told.state === 'ended') {
      if (this._kept()?.call === told.call) this._keep(null);
      if (current?.number === told.call) this._over(told.because);
      return;
    }
    if (told.key) {
      const off = this._kept()?.call === told.call ? this._kept().off : [];
      this._keep({call: told.call, key: told.key, off});
    }
    if (told.state === 'away') {
      if (current?.number === told.call && current.link) this._wait(current, 'away');
      return;
    }
    if (told.state === 'ringing' || told.state === 'calling') {
      this._letGo(current);
      this._call = {number: told.call, who: told.who, caller: told.caller};
      this._call.draw = () => this._drawRinging(told.state === 'ringing');
      this._call.draw();
      const byItself = new URLSearchParams(location.search).get('answer') === 'auto';
      if (told.state === 'ringing' && this._side === 'face' && byItself) this._accept();
    } else if (told.state === 'answered') {
      if (current?.number !== told.call || current.link) {
        this._letGo(current); // it goes on from another page
        this._call = {number: told.call, who: told.who, caller: told.caller};
      }
      this._connect(told.offers);
    }
  }

  get _other() {
    if (this._side === 'operator') return this._words.robot;
    return this._call.who;
  }

  _drawRinging(rings) {
    const words = this._words;
    const {who, caller} = this._call;
    let sentence = filled(words.calling, {who: caller === 'face' ? who : words.robot});
    if (rings) sentence = filled(caller === 'face' ? words.robot_calls : words.somebody_calls, {who});
    const decline = this._button(rings ? 'decline' : 'hang_up', 'bad', () => this._end('hung_up'));
    const buttons = rings ? [this._button('accept', 'good', () => this._accept()), decline] : [decline];
    this._draw('ringing', element('p', {class: 'call-sentence'}, sentence), this._row(buttons));
    if (rings) this._call.bell ??= ringing();
  }

  async _accept() {
    const {number} = this._call;
    try {
      const mine = await this._wire.request('call.answer', {call: number});
      if (!mine && this._call?.number === number) this._over('elsewhere');
    } catch (error) {
      this._notice(error.message);
    }
  }

  _connect(offers) {
    const call = this._call;
    call.bell?.();
    clearTimeout(call.patience);
    const theirs = element('video', {
      class: 'theirs', autoplay: true, playsinline: true, 'aria-label': this._words.their_picture,
    });
    const own = element('video', {
      class: 'own', autoplay: true, playsinline: true, 'aria-label': this._words.own_picture,
    });
    own.muted = true;
    call.link = new Link({
      offers,
      off: this._kept()?.off ?? [],
      send: (signal) => this._wire.request('call.signal', {call: call.number, signal}).catch(() => {}),
      onTheirs: (stream) => {
        theirs.srcObject = stream;
        theirs.play().catch(() => {});
      },
      onOwn: (stream, trouble) => {
        own.srcObject = stream;
        own.hidden = !stream;
        call.trouble = trouble;
        call.draw();
      },
      onConnected: () => {
        call.connected = true;
        call.draw();
      },
      onBroken: (because) => this._end(because),
    });
    call.draw = () => this._drawTalking(theirs, own);
    call.draw();
    call.link.open();
  }

  _drawTalking(theirs, own) {
    const words = this._words;
    const {connected, trouble, link} = this._call;
    const sentence = connected ? filled(words.talking_to, {who: this._other}) : words.connecting;
    const buttons = ['microphone', 'camera'].map((kind) => {
      const button = this._button(kind, 'plain', () => {
        button.setAttribute('aria-pressed', link.toggle(kind));
        const off = ['microphone', 'camera'].filter((each) => link.has(each) && !link.sends(each));
        if (this._kept()) this._keep({...this._kept(), off}); // and stays so on another page
      });
      button.setAttribute('aria-pressed', link.sends(kind));
      button.disabled = !link.has(kind);
      return button;
    });
    if (this._side === 'operator') buttons.push(this._button('aside', 'plain aside', () => this._moveAside()));
    buttons.push(this._button('hang_up', 'bad', () => this._end('hung_up')));
    this._draw(
      'talking',
      element('div', {class: 'call-pictures'}, theirs, own),
      element('p', {class: 'call-sentence'}, sentence),
      ...(trouble ? [element('p', {class: 'call-trouble'}, words[trouble])] : []),
      this._row(buttons),
    );
    // A video that was taken out of the page and put back stands still.
    for (const video of [theirs, own]) if (video.srcObject) video.play().catch(() => {});
  }

  /** To the page's other side, since it lies above the page; it stays there on other pages. */
  _moveAside() {
    sessionStorage.setItem(SIDE, this._root.dataset.side === 'left' ? 'right' : 'left');
    this._root.dataset.side = sessionStorage.getItem(SIDE);
  }

  _end(because) {
    const number = this._call?.number;
    if (number === undefined) return;
    this._over(because);
    this._wire.request('call.end', {call: number, because}).catch(() => {});
  }

  /** The call is over here: camera and microphone go off before anything else. */
  _over(because) {
    const call = this._call;
    this._call = null;
    this._keep(null);
    clearTimeout(call?.patience);
    this._letGo(call);
    this._notice(this._words[`ended_${because}`] ?? this._words.ended_hung_up);
  }

  _letGo(call) {
    call?.link?.close();
    call?.bell?.();
  }

  _notice(sentence) {
    const told = element('p', {class: 'call-sentence'}, sentence);
    this._draw('over', told);
    setTimeout(() => told.isConnected && this._draw(''), NOTICE_FOR);
  }

  _draw(state, ...children) {
    this._root.dataset.state = state;
    this._root.setAttribute('aria-label', this._words.video_call);
    this._root.replaceChildren(...children);
  }

  _row(buttons) {
    return element('div', {class: 'call-buttons'}, ...buttons);
  }

  _button(name, kind, act) {
    const button = element('button', {type: 'button', class: `call-button ${kind}`, 'data-call': name, title: this._words[name]});
    button.append(icon(name), element('span', {}, this._words[name]));
    button.addEventListener('click', act);
    return button;
  }
}

/** The connection to the other browser, with our camera and microphone. */
class Link {
  constructor({offers, off, send, onTheirs, onOwn, onConnected, onBroken}) {
    this._offers = offers;
    this._off = off;
    this._send = send;
    this._on = {theirs: onTheirs, own: onOwn, connected: onConnected, broken: onBroken};
    this._own = null;
    this._closed = false;
    this._early = [];
    this._peer = new RTCPeerConnection({iceServers: []});
    // Signals are acted on one after the other; the first wait until our camera is there.
    this._turn = new Promise((resolve) => (this._ready = resolve));
    this._peer.addEventListener('icecandidate', ({candidate}) => {
      if (candidate) send({candidate: candidate.toJSON()});
    });
    this._peer.addEventListener('track', ({streams, track}) => {
      onTheirs(streams[0] ?? new MediaStream([track]));
    });
    this._peer.addEventListener('connectionstatechange', () => this._changed());
    this._patience = setTimeout(() => this._broken('no_way'), CONNECTS_WITHIN);
  }

  async open() {
    const [stream, trouble] = await ownPicture();
    if (this._closed) {
      stopped(stream);
      return;
    }
    this._own = stream;
    for (const kind of this._off) this._enable(kind, false);
    for (const track of stream?.getTracks() ?? []) this._peer.addTrack(track, stream);
    this._on.own(stream, trouble);
    if (this._offers) {
      // Who has no camera still wants to see the other side.
      for (const kind of ['audio', 'video']) {
        if (!stream?.getTracks().some((track) => track.kind === kind)) {
          this._peer.addTransceiver(kind, {direction: 'recvonly'});
        }
      }
      await this._peer.setLocalDescription();
      this._send({description: this._peer.localDescription.toJSON()});
    }
    this._ready();
  }

  /** What the other side says. */
  hear(signal) {
    this._turn = this._turn.then(async () => {
      if (this._closed) return;
      if (signal.candidate && !this._peer.remoteDescription) {
        this._early.push(signal.candidate); // it has overtaken the description
      } else if (signal.candidate) {
        await this._peer.addIceCandidate(signal.candidate);
      } else if (signal.description) {
        await this._peer.setRemoteDescription(signal.description);
        for (const candidate of this._early.splice(0)) await this._peer.addIceCandidate(candidate);
        if (signal.description.type === 'offer') {
          await this._peer.setLocalDescription();
          this._send({description: this._peer.localDescription.toJSON()});
        }
      }
    }).catch((error) => console.warn(error));
  }

  has(kind) {
    return this._tracks(kind).length > 0;
  }

  sends(kind) {
    return this._tracks(kind).some((track) => track.enabled);
  }

  /** Switch the microphone or the camera; whether it is on then. */
  toggle(kind) {
    const on = !this.sends(kind);
    this._enable(kind, on);
    return on;
  }

  _enable(kind, on) {
    for (const track of this._tracks(kind)) track.enabled = on;
  }

  close() {
    if (this._closed) return;
    this._closed = true;
    clearTimeout(this._patience);
    clearTimeout(this._mending);
    stopped(this._own);
    this._peer.close();
  }

  _tracks(kind) {
    return this._own?.getTracks().filter((track) => track.kind === (kind === 'camera' ? 'video' : 'audio')) ?? [];
  }

  _changed() {
    const state = this._peer.connectionState;
    clearTimeout(this._mending);
    if (state === 'connected') {
      clearTimeout(this._patience);
      this._on.connected();
    } else if (state === 'failed') {
      this._broken('lost');
    } else if (state === 'disconnected') {
      this._mending = setTimeout(() => this._broken('lost'), MENDS_WITHIN);
    }
  }

  _broken(because) {
    if (!this._closed) this._on.broken(because);
  }
}

/** Our camera and microphone, or what there is of them, and what there is to say about it. */
async function ownPicture() {
  if (!navigator.mediaDevices) return [null, 'insecure'];
  for (const wanted of [{video: {width: {ideal: 640}}, audio: true}, {video: true}, {audio: true}]) {
    try {
      return [await navigator.mediaDevices.getUserMedia(wanted), null];
    } catch (error) {
      if (error.name === 'NotAllowedError') return [null, 'refused'];
    }
  }
  return [null, 'no_camera'];
}

/** Ring, where the browser lets a page be heard; returns what ends it. */
function ringing() {
  const context = new AudioContext();
  const ring = () => {
    [0, 0.22].forEach((after, index) => {
      const loudness = new GainNode(context, {gain: 0});
      const tone = new OscillatorNode(context, {frequency: index ? 880 : 660});
      const start = context.currentTime + after;
      loudness.gain.setTargetAtTime(RING_GAIN, start, 0.01);
      loudness.gain.setTargetAtTime(0, start + 0.16, 0.04);
      tone.connect(loudness).connect(context.destination);
      tone.start(start);
      tone.stop(start + 0.5);
    });
  };
  ring();
  const again = setInterval(ring, RINGS_EVERY);
  return () => {
    clearInterval(again);
    if (context.state !== 'closed') context.close();
  };
}

function stopped(stream) {
  for (const track of stream?.getTracks() ?? []) track.stop();
}

const ICONS = {
  accept: 'M6 3h3l2 5-2.5 1.5a11 11 0 0 0 6 6L16 13l5 2v3a3 3 0 0 1-3 3A15 15 0 0 1 3 6a3 3 0 0 1 3-3z',
  start: 'M3 7h11v10H3zM14 11l7-4v10l-7-4',
  microphone: 'M12 3a3 3 0 0 1 3 3v5a3 3 0 0 1-6 0V6a3 3 0 0 1 3-3zM5 11a7 7 0 0 0 14 0M12 18v3',
  camera: 'M3 7h11v10H3zM14 11l7-4v10l-7-4',
  hang_up: 'M3 14c5-5 13-5 18 0l-2 3-4-2v-2.5a12 12 0 0 0-6 0V15l-4 2z',
};

function icon(name) {
  const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
  svg.setAttribute('viewBox', '0 0 24 24');
  svg.setAttribute('aria-hidden', 'true');
  const path = document.createElementNS('http://www.w3.org/2000/svg', 'path');
  path.setAttribute('d', ICONS[name] ?? ICONS.hang_up);
  svg.append(path);
  return svg;
}
