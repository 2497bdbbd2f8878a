/** All appointments as cards: what each is, when it comes next, and what can be done with it. */

import {element, filled} from '/static/page.js';
import {howOften} from '/static/schedule/events.js';
import {reviewPanel} from '/static/schedule/review.js';
import {datesIn, dayAfter} from '/static/schedule/days.js';

const HISTORY = 50;

export class Appointments {
  /** `changed` is told whenever something was done. */
  constructor(root, {wire, words, language, role, who, changed}) {
    Object.assign(this, {wire, words, language, who, changed});
    this.operates = role === 'operator';
    this.known = new Map(); // by number, as schedule.list tells them
    this.told = element('div', {role: 'status', class: 'schedule-told'});
    this.list = element('ul', {class: 'appointments'});
    this.drawn = '';
    root.append(element('h2', {id: 'all-title', tabindex: '-1'}, words.all), this.told, this.list);
    this.list.addEventListener('click', (event) => {
      const button = event.target.closest('button[data-act]');
      if (button) this.act(button.closest('.appointment'), button);
    });
  }

  show(listed, {zone, today}) {
    Object.assign(this, {zone, today});
    this.known = new Map(listed.map((each) => [each.appointment.id, each]));
    const now = JSON.stringify([listed, zone, today]);
    if (now === this.drawn) return;
    this.drawn = now;
    const focused = document.activeElement;
    const id = focused?.closest?.('.appointment')?.dataset.id;
    const open = new Map([...this.list.querySelectorAll('.appointment')].map((each) => [each.dataset.id, each.querySelector('.panel')]));
    const cards = listed.map((each) => this.card(each));
    this.list.replaceChildren(...(cards.length ? cards : [element('li', {class: 'card muted none'}, this.words.none)]));
    for (const card of cards) {
      const panel = open.get(card.dataset.id);
      if (!panel || panel.hidden) continue; // where somebody is at work stays as it is
      card.querySelector('.panel').replaceWith(panel);
      card.querySelector(`button[data-act=${panel.dataset.act}]`)?.setAttribute('aria-expanded', 'true');
    }
    if (id) {
      const card = cards.find((each) => each.dataset.id === id);
      const again = focused.dataset.act && card?.querySelector(`button[data-act=${focused.dataset.act}]`);
      (card?.contains(focused) ? focused : again || card?.querySelector('h3'))?.focus({preventScroll: true});
    }
  }

  /** Of an address with #appointment-3: that was not there when the page came. Once. */
  goToTheOneAsked() {
    if (this.went) return;
    this.went = true;
    const asked = location.hash && document.getElementById(location.hash.slice(1));
    if (!asked) return;
    asked.scrollIntoView({block: 'center'});
    asked.querySelector('h3').focus({preventScroll: true});
  }

  card(listed) {
    const {appointment: kept, when, next, off} = listed;
    const {words} = this;
    const chips = [];
    if (kept.asked) {
      chips.push(element('span', {class: 'chip warn'}, words.waits_for_approval));
    }
    if (kept.paused) chips.push(element('span', {class: 'chip'}, words.paused));
    const facts = [
      kept.trigger
        ? [words.last, howOften(listed, words, (seconds) => this.moment(seconds))]
        : [words.next, next.length ? this.moment(next[0]) : words.no_next],
      [words.approved, filled(words.approved_by, {who: kept.approved_by, date: this.date(kept.approved_until)})],
      [words.robot, kept.fleet ? words.any_robot : kept.robot],
      [words.priority, String(kept.priority)],
      [kept.trigger ? words.form_waits : words.if_missed, kept.makes_up ? filled(words.made_up, {minutes: kept.makes_up}) : words.left_out],
    ];
    const list = element('dl', {class: 'facts'});
    for (const [name, told] of facts) list.append(element('dt', {}, name), element('dd', {}, told));
    for (const due of off) list.append(...this.calledOff(due));
    return element(
      'li', {class: `card appointment${kept.asked ? ' asked' : ''}`, id: `appointment-${kept.id}`, 'data-id': kept.id},
      element('header', {}, element('h3', {tabindex: '-1', lang: kept.language}, kept.sentence), ...chips),
      element('p', {class: 'when'}, when),
      ...(kept.asked ? [element('p', {class: 'why'}, `${words[`asked_${kept.asked}`]}.`)] : []),
      list,
      this.acts(kept, next),
      element('div', {class: 'panel', hidden: true}),
    );
  }

  calledOff(due) {
    const dd = element('dd', {}, element('s', {}, this.moment(due)));
    if (this.operates) dd.append(' ', this.button('after_all', {class: 'button small quiet', 'data-day': this.day(due)}));
    return [element('dt', {}, this.words.off_times), dd];
  }

  acts(kept, next) {
    const row = element('div', {class: 'row acts'});
    const opens = {'aria-expanded': 'false'};
    if (this.operates) {
      if (kept.asked) row.append(this.button('review', {class: 'button small primary', ...opens}));
      row.append(this.button(kept.paused ? 'resume' : 'pause'));
      if (next.length) row.append(this.button('not_this_time'));
      if (next.some((due) => this.day(due) === this.tomorrow)) row.append(this.button('not_tomorrow'));
    }
    if (!kept.asked || !this.operates) row.append(this.button('program', {class: 'button small', ...opens}));
    row.append(this.button('history', {class: 'button small', ...opens}));
    if (this.operates) row.append(this.button('remove', {class: 'button small', ...opens}));
    return row;
  }

  button(act, more = {}) {
    return element('button', {type: 'button', class: 'button small', 'data-act': act, ...more}, this.words[act]);
  }

  // --- what is done

  /** What a button of its card does, asked for elsewhere on the page. */
  actOn(number, act) {
    const card = document.getElementById(`appointment-${number}`);
    const button = card?.querySelector(`button[data-act=${act}]`);
    if (!button) return undefined;
    if (button.hasAttribute('aria-expanded')) card.scrollIntoView({block: 'center'});
    return this.act(card, button);
  }

  async act(card, button) {
    const {act} = button.dataset;
    if (button.getAttribute('aria-expanded') === 'true') return this.shut(card);
    const id = Number(card.dataset.id);
    const {appointment} = this.known.get(id);
    const {sentence} = appointment;
    const opens = {history: () => this.history(card, id), remove: () => this.remove(card, id, sentence)};
    opens.review = opens.program = () => this.program(card, appointment);
    if (opens[act]) {
      this.shut(card);
      button.setAttribute('aria-expanded', 'true');
      card.querySelector('.panel').dataset.act = act;
      return opens[act]();
    }
    const [method, params, told] = {
      pause: ['pause', {}, () => filled(this.words.is_paused, {sentence})],
      resume: ['resume', {}, () => filled(this.words.is_resumed, {sentence})],
      not_this_time: ['skip', {}, (times) => filled(this.words.called_off, {times: this.moments(times)})],
      not_tomorrow: ['skip', {date: this.tomorrow}, (times) => filled(this.words.called_off, {times: this.moments(times)})],
      after_all: ['skip', {date: button.dataset.day, back: true}, (times) => filled(this.words.called_back, {times: this.moments(times)})],
    }[act];
    return this.ask(method, {id, ...params}, told);
  }

  /** Have it done at the server; what came of it is told, for who does not see it as well. */
  async ask(method, params, told) {
    try {
      const result = await this.wire.request(`schedule.${method}`, params);
      this.tell(told(result));
      await this.changed();
      return true;
    } catch (error) {
      this.tell(error.message, true);
      return false;
    }
  }

  tell(sentence, bad = false) {
    this.told.replaceChildren(element('p', {class: `card schedule-notice${bad ? ' bad' : ''}`}, sentence));
  }

  panel(card, ...shown) {
    const panel = card.querySelector('.panel');
    panel.replaceChildren(...shown);
    panel.hidden = false;
    return panel;
  }

  shut(card) {
    const panel = card.querySelector('.panel');
    panel.hidden = true;
    panel.replaceChildren();
    for (const button of card.querySelectorAll('[aria-expanded=true]')) {
      button.setAttribute('aria-expanded', 'false');
      if (!card.contains(document.activeElement)) button.focus();
    }
  }

  remove(card, id, sentence) {
    const yes = element('button', {type: 'button', class: 'button small danger'}, this.words.remove);
    const no = element('button', {type: 'button', class: 'button small'}, this.words.keep);
    const asked = element('p', {tabindex: '-1'}, filled(this.words.remove_sure, {sentence}));
    no.addEventListener('click', () => this.shut(card));
    yes.addEventListener('click', async () => {
      if (await this.ask('remove', {id}, () => filled(this.words.removed, {sentence}))) {
        document.getElementById('all-title').focus();
      }
    });
    this.panel(card, asked, element('div', {class: 'row'}, yes, no));
    no.focus();
  }

  async history(card, id) {
    const {words} = this;
    const came = await this.wire
      .request('schedule.history', {id, last: HISTORY, language: this.language})
      .catch((error) => this.tell(error.message, true));
    if (!came) return;
    const rows = came.map(({occurrence, told}) =>
      element(
        'li', {}, this.moment(occurrence.due), ': ', told,
        ...(occurrence.run === null ? [] : [' ', element('a', {href: `/runs/${occurrence.run}`}, filled(words.run, occurrence))]),
      ));
    const shown = rows.length ? element('ul', {class: 'history'}, ...rows) : element('p', {class: 'muted'}, words.no_history);
    this.panel(card, element('div', {'aria-live': 'polite'}, shown));
  }

  program(card, appointment) {
    const done = async (sha256, until, insists) => {
      const about = {id: appointment.id, sha256, by: this.who, until, insists};
      const told = (kept) => filled(this.words.is_approved, {sentence: kept.sentence, date: this.date(kept.approved_until)});
      const approved = await this.ask('approve', about, told);
      const now = document.getElementById(card.id) ?? card;
      if (approved) {
        this.shut(now);
        now.querySelector('h3').focus();
      }
    };
    reviewPanel(this.panel(card), {
      wire: this.wire, words: this.words, language: this.language,
      appointment, due: this.known.get(appointment.id).due, approve: this.operates ? done : null, today: this.today, zone: this.zone,
    });
  }

  // --- days and times, by the clocks of the house

  get tomorrow() {
    return dayAfter(this.today, 1);
  }

  day(seconds) {
    return new Date(seconds * 1000).toLocaleDateString('sv', {timeZone: this.zone}); // 2026-11-30
  }

  moment(seconds) {
    const format = {weekday: 'short', day: 'numeric', month: 'short', hour: '2-digit', minute: '2-digit', hourCycle: 'h23'};
    return new Date(seconds * 1000).toLocaleString(datesIn(this.language), {...format, timeZone: this.zone});
  }

  moments(all) {
    return new Intl.ListFormat(this.language).format(all.map((each) => this.moment(each)));
  }

  /** The last day of an approval. */
  date(seconds) {
    return new Date((seconds - 1) * 1000).toLocaleDateString(datesIn(this.language), {dateStyle: 'long', timeZone: this.zone});
  }
}
