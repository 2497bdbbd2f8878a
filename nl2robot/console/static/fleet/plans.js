/** The appointments of the fleet: whose each is, when it comes, and what nobody here knows of it. To be looked at only: they are changed where they were made. */

import {element, filled} from '/static/page.js';
import {datesIn} from '/static/schedule/days.js';

/** `words` are those of the fleet's page or of the schedule's. */
export function planCards(kept, {words, language}) {
  const moment = (seconds, {rhythm}) => // by the clocks of the house that keeps it
    new Date(seconds * 1000).toLocaleString(datesIn(language), {weekday: 'short', day: 'numeric', month: 'short', hour: '2-digit', minute: '2-digit', hourCycle: 'h23', timeZone: rhythm?.zone});
  return kept.map(({robot, name, here, known, planned}) => {
    const {plan, when, next, unknown, told} = planned;
    const chips = [element('span', {class: 'chip'}, here ? words.here ?? name : filled(words.kept_by, {robot: name}))];
    if (plan.asked) chips.push(element('span', {class: 'chip warn'}, words.waits_for_approval));
    if (plan.paused) chips.push(element('span', {class: 'chip'}, words.paused));
    const made = element(
      'li', {class: 'plan', id: `plan-${robot}-${plan.number}`},
      element('strong', {lang: plan.language}, plan.sentence),
      ...chips,
      element('span', {class: 'muted'}, next.length && known ? `${when}, ${filled(words.plan_next, {due: moment(next[0], plan)})}` : when),
    );
    if (unknown !== null) made.append(element('span', {class: 'warn'}, filled(words.plan_unknown, {robot: name, due: moment(unknown, plan)})));
    else if (!known) made.append(element('span', {class: 'warn'}, filled(words.plan_away, {robot: name})));
    else if (told) made.append(element('span', {class: 'muted'}, filled(words.plan_latest, {told})));
    return made;
  });
}
