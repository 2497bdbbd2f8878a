"""Known faults of what is installed: asks pip-audit, whose database is on the network.

    python docs/deploy/audit.py PIP_AUDIT FOLDER      FOLDER: of the installed packages

Exits with 1 if there are any. Where the database cannot be reached nothing was looked up, and that
is said instead; no pipeline fails for it.
"""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

UNREACHED = "The database of known faults cannot be reached from here: nothing was looked up."


def told(report: dict[str, Any]) -> tuple[list[str], bool]:
    """What to say of a report of pip-audit, and whether something has to be mended."""
    packages = report.get("dependencies", [])
    known = [each for each in packages if "skip_reason" not in each]
    if not known:
        return [UNREACHED], False
    lines = [
        f"{each['name']} {each['version']}: {fault['id']}"
        + (f", mended in {', '.join(fault['fix_versions'])}" if fault.get("fix_versions") else "")
        for each in known
        for fault in each.get("vulns", ())
    ]
    faults = len(lines)
    unknown = [each["name"] for each in packages if "skip_reason" in each]
    lines.append(f"{len(known)} packages were looked up; {faults or 'no'} known faults.")
    if unknown:
        lines.append(f"Not in the database: {', '.join(unknown)}.")
    return lines, faults > 0


def main() -> int:
    pip_audit, folder = sys.argv[1:]
    asked = subprocess.run(
        [pip_audit, "--path", folder, "--format", "json", "--progress-spinner", "off"],
        capture_output=True,
        text=True,
        check=False,
    )
    try:
        report = json.loads(asked.stdout)
    except ValueError:  # it has not got as far as a report
        report = {}
    lines, has_faults = told(report)
    print("\n".join(lines))
    return int(has_faults)


if __name__ == "__main__":
    sys.exit(main())
