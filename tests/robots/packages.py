"""Packages of third parties, as pip would install them."""

from __future__ import annotations

from pathlib import Path


def install(site: Path, name: str, entry_points: str, **modules: str) -> Path:
    """Put a package with these entry points of the group `nl2robot.robots` and these modules into
    a folder, which then belongs on `sys.path` or `$PYTHONPATH`."""
    about = site / f"{name.replace('-', '_')}-1.0.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(f"[nl2robot.robots]\n{entry_points}\n")
    for module, code in modules.items():
        (site / f"{module}.py").write_text(code, encoding="utf-8")
    return site
