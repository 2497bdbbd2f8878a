"""Has robots at hand that nobody has: a stand-in of each kind, at an address of its own.

    python -m tests.robots.stand_ins               prints their addresses until Ctrl-C
    python -m tests.robots.stand_ins nl2robot bench robots
                                                   runs that with a `--robot` for each of them

They speak the robots' real wires, and say what the makers' documentation says. What a real robot
adds (its brakes, its radio) they do not.
"""

from __future__ import annotations

import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from importlib.util import find_spec

from tests.robots.furhat.stand_in import FurhatStandIn
from tests.robots.ros import stand_in as ros


@contextmanager
def robots() -> Iterator[list[str]]:
    """The addresses of one of each kind."""
    with ExitStack() as stack:
        addresses = []
        for version in (2, 1):
            robot = stack.enter_context(ros.StandIn(version))
            addresses.append(f"ros{version}://127.0.0.1:{robot.port}")
        if find_spec("qi") is not None:
            from tests.robots.pepper.conftest import StandIn

            pepper = StandIn()
            stack.callback(pepper.process.kill)
            addresses.append(f"pepper://127.0.0.1:{pepper.port}")
        furhat = stack.enter_context(FurhatStandIn())
        addresses.append(f"furhat://127.0.0.1:{furhat.port}")
        yield addresses


def main() -> int:
    with robots() as addresses:
        if sys.argv[1:]:
            named = [word for address in addresses for word in ("--robot", address)]
            return subprocess.run([*sys.argv[1:], *named], check=False).returncode
        print("\n".join(addresses), flush=True)
        threading.Event().wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
