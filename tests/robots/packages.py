"""Packages of third parties, as pip would install them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from robot_api.plugins import ROBOTS


def install(
    site: Path,
    name: str,
    entry_points: str,
    group: str = ROBOTS,
    files: Mapping[str, str] | None = None,
    **modules: str,
) -> Path:
    """Put a package with these entry points of a group, these modules and these other files into a
    folder, which then belongs on `sys.path` or `$PYTHONPATH`."""
    about = site / f"{name.replace('-', '_')}-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(f"[{group}]\n{entry_points}\n")
    for module, code in modules.items():
        (site / f"{module}.py").write_text(code, encoding="utf-8")
    for file, text in (files or {}).items():
        (site / file).parent.mkdir(parents=True, exist_ok=True)
        (site / file).write_text(text, encoding="utf-8")
    return site
