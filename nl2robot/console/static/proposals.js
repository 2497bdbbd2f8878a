/** Programs that assistants propose: a line at the top of every page of somebody who decides, for as
 * long as each waits. What an assistant says is text, and never more. */

import {tellBrowser} from '/static/notices.js';
import {element, filled} from '/static/page.js';

export function mountProposals(shelf, {wire, words, language, robot}) {
  let waiting = []; // the one that waits longest first

  function show() {
    const here = new URLSearchParams(location.search).get('proposal');
    shelf.replaceChildren(
      ...waiting
        .filter(({id}) => String(id) !== here)
        .map(({id, by, sentence}) =>
          element(
            'p',
            {class: 'proposal'},
            element('span', {}, filled(words.proposal_waits, {by, sentence})),
            element('a', {class: 'button small', href: `/?proposal=${id}`}, words.proposal_look),
          ),
        ),
    );
  }

  async function fetchThem() {
    const found = await wire.request('proposal.list').catch(() => []);
    waiting = found.filter(({state}) => state === 'waiting');
    show();
  }

  wire.subscribe('proposal', (proposal) => {
    const {id, by, sentence, state} = proposal;
    waiting = waiting.filter((each) => each.id !== id);
    if (state === 'waiting') {
      waiting.push(proposal);
      tellBrowser(filled(words.proposal_waits, {by, sentence}), `proposal-${id}`, {
        ...{words, language, robot},
        address: `/?proposal=${id}`,
      });
    }
    show();
  });
  wire.onChange((connected) => connected && fetchThem());
}
