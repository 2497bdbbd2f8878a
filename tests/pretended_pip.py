"""`pip install -e .` for the package of this folder, whose modules are on the path: it puts only
what names its robot there, so that a tutorial is played without building anything."""

import sys
import tomllib
from pathlib import Path

from tests.robots.packages import install

if __name__ == "__main__":
    assert sys.argv[1:] == ["install", "-e", "."], "this pip does nothing else"
    project = tomllib.loads(Path("pyproject.toml").read_text("utf-8"))["project"]
    points = project["entry-points"]["nl2robot.robots"]
    install(Path(), project["name"], "\n".join(f"{key} = {at}" for key, at in points.items()))
    print(f"Successfully installed {project['name']}-{project['version']}")
