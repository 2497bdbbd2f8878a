"""The methods on the wire for proposals: `proposal.make` to `proposal.decline`."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

from nl2robot.errors import UserError
from nl2robot.proposals.proposals import HOLDS, Made, Proposal, Proposals
from nl2robot.wire import LANGUAGE, NAME, NUMBER, PROGRAM, SHA256, service, service_of_call
from robot_api.methods import MAX_TEXT
from robot_api.server import Context, Service

_TEXT: Final = {"type": "string", "maxLength": MAX_TEXT}


_MARKS: Final = str.maketrans(dict.fromkeys('“”„«»"‟❝❞〝〞＂', "'"))


def proposal_services(proposals: Proposals) -> dict[str, Service]:
    """The methods to register with a `robot_api.server.Server`."""

    def made(p: Mapping[str, Any], context: Context) -> Made:
        for name in ("sentence", "why", "by"):
            if not p.get(name, "").isprintable():
                raise UserError(f"The text of `{name}` is one line without control characters.")
        # A program, and whoever has no account, may call itself anything, but stands in quotation
        # marks: nobody takes it for a person.
        person = context.who is not None and context.role != "assistant"
        by = p["by"] if person else f"“{_quoted(p['by'])}”"
        return proposals.make(
            p["program"],
            _quoted(p["sentence"]),
            by,
            _quoted(p.get("why", "")),
            p.get("language", "en"),
            context.who or "",
            context.connection,
        )

    def waited(p: Mapping[str, Any], context: Context) -> Proposal:
        return proposals.wait(p["id"], p.get("timeout", HOLDS), context.stop.is_set)

    def withdrawn(p: Mapping[str, Any], context: Context) -> Proposal:
        return proposals.withdraw(p["id"], context.who or "", context.connection)

    return {
        "proposal.make": service_of_call(
            made,
            "Lay a program before those who decide: `sentence` says what it is to do, `why` what"
            " they should know. It is reviewed at once; one with an error is refused. It runs when"
            " somebody approves it, and waits ten minutes for that.",
            {
                "program": PROGRAM,
                "sentence": {**_TEXT, "minLength": 1},
                "by": NAME,
                "why": _TEXT,
                "language": LANGUAGE,
            },
            "program sentence by",
            right="propose",
            result=Made,
        ),
        "proposal.list": service(
            lambda p: proposals.all(),
            "List the proposals since the server began, the newest last.",
            observes=True,
            result=list[Proposal],
        ),
        "proposal.show": service(
            lambda p: proposals.one(p["id"]),
            "Tell how a proposal stands.",
            {"id": NUMBER},
            "id",
            observes=True,
            result=Proposal,
        ),
        "proposal.wait": service_of_call(
            waited,
            "Wait until a proposal is decided, `timeout` seconds at most, and tell how it stands.",
            {"id": NUMBER, "timeout": {"type": "number", "minimum": 0, "maximum": HOLDS}},
            "id",
            observes=True,
            for_caller=True,
            lane="wait",
            result=Proposal,
        ),
        "proposal.withdraw": service_of_call(
            withdrawn,
            "Take back a proposal that is not decided, and one's own.",
            {"id": NUMBER},
            "id",
            right="propose",
            result=Proposal,
        ),
        "proposal.approve": service(
            lambda p: proposals.approve(
                p["id"],
                p["sha256"],
                p["by"],
                program=p.get("program"),
                insists=p.get("insists", False),
            ),
            "Approve exactly the proposed program with this SHA-256, or the `program` that somebody"
            " made of it by hand, and begin it at once; `run` is its run. One that does not come to"
            " its end in the dry run is refused unless somebody `insists`.",
            {
                "id": NUMBER,
                "sha256": SHA256,
                "by": NAME,
                "program": PROGRAM,
                "insists": {"type": "boolean"},
            },
            "id sha256 by",
            result=Proposal,
        ),
        "proposal.decline": service(
            lambda p: proposals.decline(p["id"], p["by"], p.get("reason")),
            "Say no to a proposal, and why.",
            {"id": NUMBER, "by": NAME, "reason": _TEXT},
            "id by",
            result=Proposal,
        ),
    }


def _quoted(text: str) -> str:
    """As it may stand in quotation marks, which nothing inside closes."""
    return text.translate(_MARKS)
