/** Days as they are written in fields, "2026-11-30", and the clocks of the house. */

/** How dates are written in a language; in English as the sentences of appointments have them. */
export const datesIn = (language) => (language === 'en' ? 'en-GB' : language);

export function dayAfter(day, days) {
  const there = new Date(`${day}T12:00Z`);
  there.setUTCDate(there.getUTCDate() + days);
  return there.toISOString().slice(0, 10);
}

/** When a day is over by the clocks of a zone, in seconds since the epoch. */
export function endOf(day, zone) {
  const wanted = Date.parse(`${dayAfter(day, 1)}T00:00Z`);
  let moment = wanted;
  for (let tries = 0; tries < 2; tries++) {
    const there = new Date(moment).toLocaleString('sv', {timeZone: zone}).replace(' ', 'T');
    moment += wanted - Date.parse(`${there}Z`);
  }
  return moment / 1000;
}
