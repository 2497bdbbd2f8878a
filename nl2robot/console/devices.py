"""Tablets and devices: to pair one by a QR code, to see what people came in by, to withdraw it.

A page at `/devices`, and the methods `devices.*`, for operators; what people signed in on is for
administrators, and for themselves.
"""

from __future__ import annotations

import base64
from collections.abc import Mapping
from typing import Any, Final, NotRequired, TypedDict

import msgspec

from nl2robot.console.frame import frame
from nl2robot.station.accounts import LONGEST_NAME, Account, Failure, Session
from nl2robot.station.entrance import PAGES_AT, Entrance
from nl2robot.station.part import Backstage, Part
from nl2robot.station.qr_code import as_svg
from nl2robot.wire import service_of_call
from robot_api.errors import AccessDenied, NotPossible
from robot_api.server import Context, Service
from robot_api.serving.roles import PAIRED, Role, may

HERE_ONLY: Final = (
    "This server answers this machine only, so no tablet can come in. Start it anew with"
    " `nl2robot serve --host 0.0.0.0`."
)


class Device(TypedDict):
    """`nl2robot.station.accounts.Session`, and whether it is the asker's own."""

    id: int
    role: Role
    account: str | None
    label: str
    made: float
    made_by: str | None
    used: float
    link: bool
    mine: bool


class Devices(TypedDict):
    """What tablets and people came in by, and who failed to."""

    here_only: bool
    devices: list[Device]
    failures: list[Failure]
    accounts: NotRequired[list[Account]]


class Pairing(TypedDict):
    """A link by which one tablet comes in, its QR code as a data URL, and until when."""

    link: str
    picture: str
    ends: float | None


def part(backstage: Backstage) -> Part:
    entrance = backstage.entrance
    if entrance is None:
        return Part()

    def pages() -> None:
        from nicegui import ui

        @ui.page("/devices")
        def devices() -> None:
            with frame(backstage, "devices") as visit:
                visit.hand_over({"words": dict(visit.words)})
                ui.add_head_html(
                    '<link rel="stylesheet" href="/static/devices/devices.css">'
                    '<script type="module" src="/static/devices/devices.js"></script>'
                )
                ui.html('<div id="devices" class="devices"></div>', sanitize=False)

    return Part(services=_services(entrance), pages=pages)


def _services(entrance: Entrance) -> dict[str, Service]:
    accounts = entrance.accounts

    def listed(p: Mapping[str, Any], context: Context) -> Any:
        administers = may(context.role, "administer")
        told = {
            "here_only": entrance.local,
            "devices": [
                {**msgspec.to_builtins(each), "mine": _is_own(each, context)}
                for each in accounts.sessions()
                if administers or each.account is None or _is_own(each, context)
            ],
            "failures": accounts.failures(),
        }
        return {**told, "accounts": accounts.accounts()} if administers else told

    def paired(p: Mapping[str, Any], context: Context) -> Any:
        if entrance.local:
            raise NotPossible(HERE_ONLY)
        code = accounts.invite(p["role"], p["label"], context.who)
        pages = p.get("at") or accounts.noted(PAGES_AT) or ""
        link = f"{pages.rstrip('/')}/join/{code}"
        picture = base64.b64encode(as_svg(link).encode()).decode()
        invitation = accounts.invitation(code)
        ends = invitation.ends if invitation else None
        return {"link": link, "picture": f"data:image/svg+xml;base64,{picture}", "ends": ends}

    def withdrawn(p: Mapping[str, Any], context: Context) -> None:
        device = next((each for each in accounts.sessions() if each.id == p["device"]), None)
        others = device is not None and (device.account is not None or device.link)
        if device and others and not (may(context.role, "administer") or _is_own(device, context)):
            raise AccessDenied("Only an administrator may withdraw this. Ask one.")
        accounts.withdraw(p["device"])

    return {
        "devices.list": service_of_call(
            listed,
            "List what tablets and people came in by, and who failed to; for administrators the"
            " accounts as well.",
            result=Devices,
        ),
        "devices.pair": service_of_call(
            paired,
            "Make a link by which one tablet comes in within ten minutes, and its QR code.",
            {
                "role": {"enum": list(PAIRED)},
                "label": {"type": "string", "minLength": 1, "maxLength": LONGEST_NAME},
                "at": {"type": "string", "pattern": "^https?://[^/?#@]{1,200}$"},
            },
            "role label",
            result=Pairing,
        ),
        "devices.withdraw": service_of_call(
            withdrawn,
            "Let nobody come in by this any more; whoever is connected by it is not from then on.",
            {"device": {"type": "integer", "minimum": 1}},
            "device",
            result=None,
        ),
    }


def _is_own(device: Session, context: Context) -> bool:
    return device.account is not None and device.account == context.who
