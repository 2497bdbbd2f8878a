/** Sending by a click: what is meant, where the robot has room there, and what to do with it. */

/**
 * Lets clicks of the mode "send" on a map be proposals. `propose` is given what `places.aim` tells:
 * the program, what somebody would have said, the spot that it became and a note if it was moved.
 */
export function proposeClicks(map, {wire, language, propose}) {
  map.root.addEventListener('go', async ({detail: {x, y, place}}) => {
    try {
      const aimed = await wire.request('places.aim', {x, y, place, language});
      map.showError('');
      map.sentTo(aimed.place ? {x, y} : aimed);
      await propose(aimed);
    } catch (error) {
      map.sentTo(null);
      map.showError(error.message);
    }
  });
}
