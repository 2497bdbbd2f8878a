/** Small faces for the emotions: our own drawings, in a square of 48, in the colour of the text. */

const EYES = '<circle cx="17" cy="21" r="2.6"/><circle cx="31" cy="21" r="2.6"/>';
const LOW_BROWS = '<path d="M12 13.5 L20 17 M36 13.5 L28 17"/>';

/** What is inside the outline: lines, and `<circle>`s that are filled. */
const FEATURES = {
  neutral: `${EYES}<path d="M17 33 H31"/>`,
  happy: `${EYES}<path d="M14.5 29.5 Q24 40 33.5 29.5"/>`,
  sad: `${EYES}<path d="M16 35.5 Q24 28 32 35.5 M12.5 17 L19 13.5 M35.5 17 L29 13.5"/>`,
  confused: `${EYES}<path d="M16 34 Q20 29.5 24 33 T32 32 M12.5 15 H20 M28 12.5 Q32 9.5 35.5 12.5"/>`,
  angry: `${EYES}${LOW_BROWS}<path d="M16.5 35 Q24 30 31.5 35"/>`,
  surprised:
    '<circle cx="17" cy="20" r="3.2"/><circle cx="31" cy="20" r="3.2"/>' +
    '<path d="M12.5 12.5 Q16.5 9.5 20.5 12.5 M27.5 12.5 Q31.5 9.5 35.5 12.5"/>' +
    '<ellipse cx="24" cy="34" rx="4" ry="5"/>',
  thinking:
    '<circle cx="19.5" cy="19" r="2.6"/><circle cx="33" cy="19" r="2.6"/>' +
    '<path d="M13 13.5 H21.5 M28.5 11.5 L35.5 13 M18 33.5 H27"/>' +
    '<circle cx="33.5" cy="35.5" r="1.3"/><circle cx="37" cy="31.5" r="1.6"/>',
  listening:
    `${EYES}<path d="M19 33 Q24 36.5 29 33 M37.5 17 Q41 21.5 37.5 26 M10.5 17 Q7 21.5 10.5 26"/>`,
  speaking: `${EYES}<path d="M16.5 30 H31.5 Q31 39 24 39 Q17 39 16.5 30 Z"/>`,
};

/** The drawing of an emotion, as HTML; of one that nobody drew, a face with its first letter. */
export function face(emotion) {
  const inside =
    FEATURES[emotion] ??
    `<text x="24" y="31" text-anchor="middle" font-size="20">${letterOf(emotion)}</text>`;
  return (
    '<svg class="face" viewBox="0 0 48 48" aria-hidden="true">' +
    `<circle class="rim" cx="24" cy="24" r="21"/>${inside}</svg>`
  );
}

function letterOf(emotion) {
  const letter = emotion.trim().charAt(0).toUpperCase();
  return /\p{L}|\p{N}/u.test(letter) ? letter : '?';
}
