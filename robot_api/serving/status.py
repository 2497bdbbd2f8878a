"""The page a robot's server shows at `/`: plain HTML that asks for nothing from anywhere else."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

from robot_api.driver import Capabilities
from robot_api.methods import CAPABILITIES, METHODS

HEADERS = {
    "Content-Security-Policy": "default-src 'none'; style-src 'unsafe-inline'",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Cache-Control": "no-store",
}

_PAGE = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="refresh" content="5">
<title>{name}</title>
<style>
:root {{ color-scheme: light dark; }}
body {{ font: 16px/1.5 system-ui, sans-serif; max-width: 44rem; margin: 2rem auto;
  padding: 0 1rem; }}
h1 {{ margin-bottom: 0; }}
dl {{ display: grid; grid-template-columns: max-content 1fr; gap: .25rem 1rem; }}
dt {{ opacity: .7; }}
dd {{ margin: 0; }}
code, pre {{ font-family: ui-monospace, monospace; }}
pre {{ padding: 1rem; border: 1px solid color-mix(in srgb, currentColor 25%, transparent);
  border-radius: .5rem; overflow-x: auto; }}
</style>
</head>
<body>
<h1>{name}</h1>
<p>This robot ({kind}) is ready to be told what to do.</p>
<dl>
<dt>Address</dt><dd><code>{address}</code></dd>
<dt>Place</dt><dd>{pose}</dd>
<dt>Connections</dt><dd>{connections}</dd>
<dt>Calls in flight</dt><dd>{in_flight}</dd>
</dl>
<h2>How to connect</h2>
<pre>from robot_api import Robot

robot = Robot("{address}"{token})
robot.say("Hello")</pre>
<h2>What it can do</h2>
<dl>
{methods}
</dl>
</body>
</html>
"""


@dataclass(frozen=True)
class Status:
    """What there is to say about a server and its robot."""

    capabilities: Capabilities
    address: str
    """host:port"""
    pose: str
    """Where the robot is, in words."""
    connections: int
    in_flight: int
    """How many calls are being carried out."""
    needs_token: bool


def status_page(status: Status) -> str:
    """The page as HTML."""
    return _PAGE.format(
        name=escape(status.capabilities.name),
        kind=escape(status.capabilities.kind),
        address=escape(status.address),
        pose=escape(status.pose),
        connections=status.connections,
        in_flight=status.in_flight,
        token=', token="..."' if status.needs_token else "",
        methods="\n".join(_rows(status.capabilities.methods)),
    )


def _rows(names: Iterable[str]) -> Iterable[str]:
    has = set(names)
    for capability in CAPABILITIES:
        methods = [m for m in METHODS.values() if m.capability == capability and m.name in has]
        if methods:
            listed = ", ".join(
                f'<code title="{escape(method.doc)}">{method.name}</code>' for method in methods
            )
            yield f"<dt>{capability}</dt><dd>{listed}</dd>"
