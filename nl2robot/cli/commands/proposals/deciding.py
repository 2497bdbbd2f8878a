"""A proposal as somebody at a terminal decides on it."""

from __future__ import annotations

from nl2robot.cli.operator import Operator
from nl2robot.cli.terminal import Terminal
from nl2robot.errors import ExitStatus
from nl2robot.plain import visible
from nl2robot.proposals.proposals import Proposal
from robot_api.errors import StopNotConfirmed


def decide_on(operator: Operator, terminal: Terminal, proposal: Proposal) -> ExitStatus:
    """Show what is proposed, and have somebody decide."""
    words = terminal.words
    show = terminal.console.print
    show(visible(words["proposed"].format(by=proposal.by, text=proposal.sentence)), markup=False)
    if proposal.why:
        show(visible(words["proposed_why"].format(text=proposal.why)), markup=False)
    operator.reviewing(True)
    try:
        program = proposal.program
        while True:
            review = operator.check(program, terminal.language)
            terminal.show_review(review)
            decision = terminal.settle(review)
            if decision != "edit":
                break
            program = terminal.edit(program)
    finally:
        operator.reviewing(False)
    if decision == "reject":
        operator.decline_proposal(proposal, _reason(terminal))
        show(words["rejected"], markup=False)
        return ExitStatus.NOT_APPROVED
    decided = operator.approve_proposal(proposal, review, insists=not review.came_through)
    assert decided.run is not None
    try:
        status = operator.wait(decided.run)
    except KeyboardInterrupt:
        try:
            operator.stop()
        except StopNotConfirmed:
            terminal.show_unconfirmed()
        raise
    came = operator.answer(decided.run, terminal.language)
    terminal.show_answer(came, status.state, status.message, status.error)
    return ExitStatus.OK if status.state == "done" else ExitStatus.FAILED


def _reason(terminal: Terminal) -> str | None:
    """Why not, if somebody is there and says so."""
    return terminal.ask(terminal.words["why_not"]).strip() if terminal.somebody_is_there else None
