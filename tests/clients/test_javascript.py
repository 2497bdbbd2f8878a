"""The client for JavaScript: it fits the server, goes with Node's own WebSocket and with that of
`ws`; its types keep out what the server would refuse. In a page: tests/console/test_client.py."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tomllib
import urllib.request
from collections.abc import Iterator
from fnmatch import fnmatch
from pathlib import Path

import pytest
from playwright._impl._driver import compute_driver_executable

from tests.clients.conftest import CLIENT, MODULES, ROOT, WORKSHOP, Run
from tests.console.conftest import Served, serving

STORIES = Path(__file__).with_name("stories")
FILES = ("package.json", "nl2robot.js", "nl2robot.d.ts", "methods.d.ts")
HINT = "run: make client"
OWN = "--experimental-websocket"
"""Makes Node 20 have what later versions have."""
NONE = "--no-experimental-websocket"


def newer() -> str:
    """The Node that Playwright brings along, years younger than 20."""
    return str(compute_driver_executable()[0])


@pytest.fixture
def project(served: Served, node: str, tmp_path: Path) -> Path:
    """A folder of somebody who has fetched the client from the robot, as docs/clients.md says."""
    fetched = tmp_path / "robot-client"
    fetched.mkdir()
    for name in FILES:
        with urllib.request.urlopen(f"{served.url}/static/client/{name}", timeout=20) as answer:
            (fetched / name).write_bytes(answer.read())
    modules = tmp_path / "node_modules"
    modules.mkdir()
    (modules / "nl2robot").symlink_to(fetched)
    (tmp_path / "package.json").write_text('{"type": "module"}')
    return tmp_path


def with_ws(project: Path) -> None:
    for name in ("ws", "@types"):
        (project / "node_modules" / name).symlink_to(MODULES / name)


@pytest.mark.parametrize("story", ["whole_run", "errors", "stops", "cut"])
@pytest.mark.parametrize("kind", ["ws", "own", "newer"])
def test_a_story_in_node(
    story: str, kind: str, served: Served, node: str, project: Path, run: Run
) -> None:
    if kind == "ws":
        with_ws(project)
    (project / "story.mjs").write_bytes((STORIES / f"{story}.mjs").read_bytes())
    command = {"ws": [node, NONE], "own": [node, OWN], "newer": [newer()]}[kind]
    run(*command, "story.mjs", cwd=project, ROBOT=f"ws://{served.address}")


def test_a_node_that_can_talk_to_no_robot_says_what_to_install(
    served: Served, node: str, project: Path, run: Run
) -> None:
    script = "import {connect} from 'nl2robot'; await connect().catch(e => console.log(e.message))"
    said = run(node, NONE, "--input-type=module", "-e", script, cwd=project).stdout
    assert said == "This Node has no WebSocket. Take Node 22 or newer, or: npm install ws\n"


@pytest.fixture(scope="module")
def house(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """A server that others reach, too."""
    with serving(tmp_path_factory.mktemp("house"), "--host", "0.0.0.0") as served:
        yield served


@pytest.mark.parametrize("kind", ["ws", "newer"])
def test_from_elsewhere_one_shows_a_token(
    kind: str, house: Served, node: str, project: Path, run: Run
) -> None:
    with_ws(project)
    (project / "story.mjs").write_bytes((STORIES / "token.mjs").read_bytes())
    token = next(line.split()[-1] for line in house.said if "must show this token" in line)
    port = house.address.rpartition(":")[2]
    run(
        *([node, NONE] if kind == "ws" else [newer()]),
        "story.mjs",
        cwd=project,
        ROBOT=f"wss://127.0.0.1:{port}",
        TOKEN=token,
        NODE_EXTRA_CA_CERTS=str(house.home / "certificates" / "authority.crt"),
    )


# --- what is made ---------------------------------------------------------------------------------


def test_the_types_are_what_a_server_says_of_itself(
    node: str, served: Served, tmp_path: Path, run: Run
) -> None:
    document = subprocess.run(
        [sys.executable, "-m", "nl2robot.console.wire_page", "--document"],
        capture_output=True,
        encoding="utf-8",
        check=True,
    ).stdout
    made = run(node, WORKSHOP / "generate.mjs", cwd=tmp_path, typed=document).stdout
    assert made == (CLIENT / "methods.d.ts").read_text("utf-8"), HINT
    with urllib.request.urlopen(f"{served.url}/openrpc.json", timeout=20) as answer:
        there = json.load(answer)
    everywhere = [
        each for each in json.loads(document)["methods"] if not each["name"].startswith("fleet.")
    ]
    assert there["methods"] == everywhere, "a robot of a fleet has those besides"


def test_its_own_types_are_what_its_text_says(node: str, tmp_path: Path, run: Run) -> None:
    tsc = MODULES / "typescript/bin/tsc"
    run(node, tsc, "--project", WORKSHOP, "--outDir", tmp_path, cwd=tmp_path)
    made = (tmp_path / "nl2robot.d.ts").read_text("utf-8")
    assert made == (CLIENT / "nl2robot.d.ts").read_text("utf-8"), HINT


def test_what_the_robot_would_refuse_does_not_compile(node: str, project: Path, run: Run) -> None:
    with_ws(project)
    strict = ("--strict", "--noEmit", "--target", "es2022", "--module", "nodenext")
    tsc = (node, MODULES / "typescript/bin/tsc", *strict, "--types", "node")
    text = (STORIES / "typed.ts").read_text("utf-8")
    (project / "typed.ts").write_text(text)
    run(*tsc, "typed.ts", cwd=project)
    # Without its marks, each of the lines below them is one error, and nothing else is.
    (project / "typed.ts").write_text(re.sub("// @ts-expect-error", "//", text))
    said = run(*tsc, "typed.ts", cwd=project, fails=True).stdout
    wrong = {int(line) for line in re.findall(r"^typed\.ts\((\d+),", said, re.M)}
    marks = text.splitlines()
    assert wrong == {number + 2 for number, line in enumerate(marks) if "@ts-expect" in line}


def test_what_is_installed_is_named_with_its_hash_and_no_host() -> None:
    locked = json.loads((WORKSHOP / "package-lock.json").read_text("utf-8"))["packages"]
    asked = locked.pop("")["devDependencies"]
    assert set(asked) == {"@types/ws", "json-schema-to-typescript", "typescript", "ws"}
    assert all(re.fullmatch(r"[\d.]+", version) for version in asked.values())
    assert all(package["integrity"].startswith("sha512-") for package in locked.values())
    assert "://" not in re.sub(r'"url": "[^"]*"', "", json.dumps(locked))


def test_the_wheel_has_the_client_and_not_its_workshop() -> None:
    assert {file.name for file in CLIENT.iterdir()} == set(FILES)
    setuptools = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["tool"]["setuptools"]
    patterns = setuptools["package-data"]["*"]
    assert all(any(fnmatch(name, each) for each in patterns) for name in FILES)
    packages = setuptools["packages"]["find"]["include"]
    assert not any(fnmatch("docs.clients.javascript", each) for each in packages)
