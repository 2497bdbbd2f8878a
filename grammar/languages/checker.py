"""Whether a language is as it should be: a checker for ours and for anybody's.

    for finding in check_language("nl", lambda: lexicon):
        print(finding)              # commands.yaml:12: There is no meaning ...

An error is something that is written down and wrong; a note tells what is lacking, where English
stands in or which words nobody can say yet.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from string import Formatter
from typing import Any, Final, Literal

import msgspec
import yaml

from grammar.explain import explain
from grammar.language import Language, load_language, put_together, speech
from grammar.languages import registry
from grammar.lexicon import Lexicon
from grammar.meanings.registry import MEANINGS
from grammar.names import names_of
from grammar.naming import naming
from grammar.network import RuleError, parts_of
from grammar.normal import normal
from grammar.plan import Ask, Call, Plan
from grammar.program import write_program
from grammar.program_parser import NotAPlan, parse_program
from grammar.samples import filled, samples
from grammar.traversal import nodes
from grammar.understand import understand
from robot_api.methods import METHODS

Severity = Literal["error", "note"]
Place = tuple[str, int | None]
"""A file's name, and a line in it where that is known."""

KEYS: Final = frozenset(
    {"closed", "conjugation", "extended", "fillers", "help", "kinds", "known_by", "lists"}
    | {"numbers", "orders", "phrases", "plurals", "rewordings", "rules", "sayings", "speech"}
    | {"spelling", "verbs"}
)
"""What may stand at the top of a file; `grammar.language` says what each is."""
METHODS_FILE: Final = "methods.yaml"
"""A command for each robot method, in everyday words."""
ANSWERS: Final = {"agree": "yes", "refuse": "no"}
"""Lists of `speech` that nothing can be asked back without, and what is said with them."""
DIGITS: Final = frozenset(range(10))
MOST_NAMED: Final = 8
"""Names in a sentence; of more it is said how many there are."""

_QUOTED: Final = re.compile(r"'(.+?)'(?!\w)|(<\w+>)")


@dataclass(frozen=True)
class Finding:
    """Something about a language."""

    severity: Severity
    file: str
    line: int | None
    message: str

    def __str__(self) -> str:
        where = self.file if self.line is None else f"{self.file}:{self.line}"
        return f"{where}: {self.message}"


def check_language(code: str, names: Callable[[], Lexicon]) -> list[Finding]:
    """What is wrong with the language of this code, and what it lacks; `names`, those of a world as
    the language has them, stand in its samples. Raises `UnknownLanguage`."""
    folder, files = registry.folder_of(code), registry.files_of(code)
    places: dict[tuple[str, str], Place] = {}
    found: list[Finding] = []
    for path in files:
        try:
            root = yaml.compose(path.read_bytes(), Loader=yaml.SafeLoader)
        except (yaml.YAMLError, UnicodeDecodeError) as error:
            found.append(unreadable(path, error))
            continue
        places.update(_named(root, path.name))
        found += _of_file(root, path.name)
    if any(each.severity == "error" for each in found):
        return found  # what follows would only say it again
    try:
        pack = load_language(code)
        own = put_together({path: path.read_bytes() for path in files})
    except RuleError as error:
        return [*found, _of_rules(error, files)]
    lexicon = names()
    found += _of_slots(pack, lexicon, files)
    found += _of_phrases(pack, own.get("phrases", {}), places)
    found += _of_answers(pack)
    wrong = list(_of_explanations(code, folder))
    found += wrong
    if not any(each.severity == "error" for each in wrong):
        found += _of_samples(pack, lexicon, places)
        found += _of_methods(pack, folder / METHODS_FILE, lexicon)
    return found


def unreadable(path: Path, error: Exception) -> Finding:
    """A file that is no YAML, or no text."""
    mark = getattr(error, "problem_mark", None)
    why = getattr(error, "problem", None) or "it is no text in UTF-8"
    line = mark.line + 1 if mark is not None else None
    return Finding("error", path.name, line, f"This cannot be read as YAML: {why}.")


# --- what stands in the files


def _named(root: yaml.Node | None, file: str) -> Iterator[tuple[tuple[str, str], Place]]:
    """Where what has a name stands: rules, phrases, topics ..."""
    for key, value in _entries(root):
        yield ("", key.value), (file, key.start_mark.line + 1)
        for name, _ in _entries(value):
            yield (key.value, str(name.value)), (file, name.start_mark.line + 1)


def _entries(node: yaml.Node | None) -> list[tuple[Any, Any]]:
    return node.value if isinstance(node, yaml.MappingNode) else []


def _of_file(root: yaml.Node | None, file: str) -> Iterator[Finding]:
    if not isinstance(root, yaml.MappingNode):
        yield Finding("error", file, 1, "This is no mapping of rules, lists and the like.")
    for key, value in _entries(root):
        if key.value not in KEYS:
            known = ", ".join(sorted(KEYS))
            message = f"{key.value!r} is nothing that a language has. It can be: {known}."
            yield Finding("error", file, key.start_mark.line + 1, message)
        if key.value == "rules":
            for _, entries in _entries(value):
                yield from _of_meanings(entries, file)


def _of_meanings(entries: yaml.Node, file: str) -> Iterator[Finding]:
    for entry in entries.value if isinstance(entries, yaml.SequenceNode) else [entries]:
        for key, value in _entries(entry):
            if key.value == "means" and value.value not in MEANINGS.keys() | METHODS.keys():
                message = f"There is no meaning and no robot method called {value.value!r}."
                yield Finding("error", file, value.start_mark.line + 1, message)


def _of_rules(error: RuleError, files: Sequence[Path]) -> Finding:
    """What stood in the way when the rules were put together: where what it names last stands."""
    named = [quoted or rule for quoted, rule in _QUOTED.findall(str(error))]
    places = (_place_of(each, files) for each in reversed(named))
    file, line = next((place for place in places if place[1] is not None), (files[0].name, None))
    return Finding("error", file, line, f"{str(error)[:1].upper()}{str(error)[1:]}.")


def _place_of(text: str, files: Sequence[Path]) -> Place:
    """The first line that a text stands in."""
    for path in files:
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if text in line:
                return path.name, number
    return files[0].name, None


def _of_slots(pack: Language, lexicon: Lexicon, files: Sequence[Path]) -> Iterator[Finding]:
    """Rules that nothing can be said by, and the one that all begin with."""
    if "utterance" not in pack.rules:
        yield Finding("error", pack.code, None, "There is no rule 'utterance', which all else is.")
    known = names_of(pack, lexicon).tries.keys() | _open_slots()
    for rule in pack.rules:
        for slot in sorted(_slots(pack, rule) - known):
            file, line = _place_of(f"{{{slot}", files)
            message = f"Nothing can stand for {{{slot}}}: give it a list of that name."
            yield Finding("error", file, line, message)


def _slots(pack: Language, rule: str) -> set[str]:
    """What a rule has in braces."""
    templates = [each for production in pack.rules[rule] for each in production.templates]
    return {part.name for each in templates for part in parts_of(each) if not part.is_rule}


def _open_slots() -> set[str]:
    """What our languages have in braces and list nowhere: numbers, any words, names of a world."""
    ours = [load_language(code) for code in registry.ours()]
    used = {slot for pack in ours for rule in pack.rules for slot in _slots(pack, rule)}
    return used - {name for pack in ours for name in pack.lists}


def _of_phrases(
    pack: Language, own: Mapping[str, str], places: Mapping[tuple[str, str], Place]
) -> Iterator[Finding]:
    english = load_language(registry.ENGLISH).phrases
    for name, phrase in own.items():
        file, line = places[("phrases", name)]
        if name not in english:
            if not registry.is_ours(pack.code):
                yield Finding("error", file, line, f"Nothing is said by the name {name!r}.")
        elif (gaps := _gaps(phrase)) != (theirs := _gaps(english[name])):
            message = f"The phrase {name!r} has {_braced(gaps)}, and English has {_braced(theirs)}."
            yield Finding("error", file, line, message)
    missing = english.keys() - own.keys()
    if missing and not registry.is_ours(pack.code):
        message = f"{len(missing)} of {len(english)} phrases are said in English: {few(missing)}."
        yield Finding("note", "phrases", None, message)


def _gaps(phrase: str) -> set[str]:
    try:
        return {name for _, name, _, _ in Formatter().parse(phrase) if name}
    except ValueError:
        return {"?"}


def _braced(names: Iterable[str]) -> str:
    return ", ".join(f"{{{name}}}" for name in sorted(names)) or "no gap"


def few(names: Iterable[str]) -> str:
    """The first of some names, and how many there are besides."""
    ordered = sorted(names)
    more = len(ordered) - MOST_NAMED
    return ", ".join(ordered[:MOST_NAMED]) + (f" and {more} more" if more > 0 else "")


def _of_answers(pack: Language) -> Iterator[Finding]:
    for name, meant in ANSWERS.items():
        if not pack.speech.get(name):
            message = f"Nobody can say {meant} when something is asked back: list it as {name!r}."
            yield Finding("note", "speech", None, message)
    words, phrases = pack.numbers.get("words", {}), pack.numbers.get("phrases", {})
    missing = DIGITS - {*words.values(), *phrases.values()}
    if missing:
        numbers = ", ".join(map(str, sorted(missing)))
        yield Finding("note", "numbers", None, f"There is no word for {numbers}.")


def _of_explanations(code: str, folder: Path) -> Iterator[Finding]:
    path = folder / "explain.yaml"
    if not path.exists():
        message = "There is no such file: programs are explained in English."
        yield Finding("note", path.name, None, message)
        return
    try:
        own = yaml.safe_load(path.read_bytes())
        speech(code)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        yield unreadable(path, error)
        return
    except (msgspec.MsgspecError, AttributeError, TypeError) as error:
        yield Finding("error", path.name, None, f"This has another shape than English: {error}.")
        return
    missing = METHODS.keys() - own.get("methods", {}).keys()
    if missing:
        message = f"What these do is explained in English: {few(missing)}."
        yield Finding("note", path.name, None, message)


# --- what can be said


def _of_samples(
    pack: Language, lexicon: Lexicon, places: Mapping[tuple[str, str], Place]
) -> Iterator[Finding]:
    topics = samples(lexicon, pack.code)
    for topic, sentences in topics.items():
        file, line = places.get(("help", topic), (pack.code, None))
        for sentence in sentences:
            _, wrong = _understood(sentence, lexicon, pack)
            if wrong:
                yield Finding("error", file, line, f"“{sentence}”: {wrong}")
    if not topics:
        message = "There are no samples: nobody is told what they can say."
        yield Finding("note", "help", None, message)


def _of_methods(pack: Language, path: Path, lexicon: Lexicon) -> Iterator[Finding]:
    """A command for each robot method, and whether it is one."""
    try:
        root = yaml.compose(path.read_bytes(), Loader=yaml.SafeLoader) if path.exists() else None
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        yield unreadable(path, error)
        return
    commands = {key.value: (value.value, key.start_mark.line + 1) for key, value in _entries(root)}
    for method, (sentence, line) in commands.items():
        said = filled(str(sentence), lexicon, pack)
        if said is None:  # nobody in this world could say it
            continue
        plan, wrong = _understood(said, lexicon, pack)
        if method not in METHODS:
            wrong = f"There is no robot method called {method!r}."
        elif not wrong and (plan is None or method not in _methods(plan)):
            wrong = f"This does not ask for {method!r}."
        if wrong:
            yield Finding("error", path.name, line, f"“{said}”: {wrong}")
    missing = METHODS.keys() - commands.keys()
    if missing:
        message = f"{len(missing)} of {len(METHODS)} methods have no command: {few(missing)}."
        yield Finding("note", path.name, None, message)


def _understood(sentence: str, lexicon: Lexicon, pack: Language) -> tuple[Plan | None, str]:
    """What a sample means, or what is wrong with it."""
    understood = understand(sentence, lexicon, pack.code)
    if understood.status != "ok":
        return None, f"This is not understood ({understood.message})."
    plan = understood.plan
    if plan is None:  # asks for nothing from the robot
        return None, ""
    called = naming(lexicon, pack).called
    try:
        program = write_program(plan)
        explain(plan, pack.code, called)
        back = parse_program(program, pack.code)
    except (NotAPlan, ArithmeticError, AttributeError, LookupError, TypeError, ValueError) as error:
        return None, f"Its plan is not whole ({type(error).__name__}: {error})."
    if normal(back).steps != normal(plan).steps:
        return None, "Its program reads as another plan than it was made from."
    return plan, ""


def _methods(plan: Plan) -> set[str]:
    return {each.method for each in nodes(plan.steps) if isinstance(each, Call | Ask)}
