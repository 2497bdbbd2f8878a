"""A language as data: reads the files of its folder (`grammar.languages`) and compiles its rules.

Every file may hold any of these keys; those of all files are put together:

    rules         templates by rule (`grammar.templates`), each entry with what it means
    lists         named values with the words for them: slots such as {emotion}
    spelling      contractions, endings, abbreviations, symbols
    numbers       number words, scales, fractions
    fillers       words that may stand anywhere and say nothing
    closed        words that are no part of a thing's name ("the", "from", "and")
    plurals       how plurals are made
    kinds         words for kinds of places, where they differ from the world's
    verbs         verbs by group, for templates with ~ (`grammar.verbs`)
    conjugation   how their forms are made
    orders        where they stand in a clause
    phrases       what the robot says or the application answers, by name
    speech        how reported speech becomes direct speech
    rewordings    other ways to say the same
    help          topics with example phrases
    methods       what is said of a robot method, besides those of `explain.yaml` (`grammar.speech`)
    sayings       what else people say, for the recogniser
    known_by      words by which a language that is added is known while another is spoken
"""

from __future__ import annotations

import functools
import gc
import itertools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import msgspec
import yaml

from grammar.cache import kept
from grammar.languages import registry
from grammar.languages.registry import UnknownLanguage as UnknownLanguage
from grammar.network import Network, Production, RuleError, compile_rules
from grammar.speech import Speech, explained
from grammar.templates import (
    NOTHING,
    Choice,
    Part,
    Sequence,
    Template,
    TemplateError,
    Word,
    parse_template,
)
from grammar.tokens import Spelling, words_of, words_of_template
from grammar.verbs import forms, ordered

_COMPILED: Final = frozenset(
    {"rules", "verbs", "conjugation", "orders", "lists", "fillers", "closed"}
)
"""Keys that only matter when a language is compiled."""


@dataclass(frozen=True, eq=False)
class Language:
    code: str
    rules: Mapping[str, tuple[Production, ...]]
    network: Network
    lists: Mapping[str, Mapping[str, tuple[tuple[str, ...], ...]]]
    """list -> value -> the ways to say it, as normal forms"""
    spelling: Spelling
    numbers: Mapping[str, Any]
    fillers: tuple[tuple[str, ...], ...]
    closed: frozenset[str]
    plurals: Mapping[str, Any]
    kinds: Mapping[str, Any]
    phrases: Mapping[str, str]
    speech: Mapping[str, Any]
    rewordings: tuple[Mapping[str, Any], ...]
    """Other ways to say the same, as they are written down (`grammar.rewordings`)."""
    help: Mapping[str, tuple[str, ...]]
    """topic -> example templates"""
    sayings: tuple[str, ...]
    """More templates like these, which nobody is shown."""
    methods: Mapping[str, Any]
    """robot method -> what is said of it (`grammar.speech`)"""
    known_by: tuple[str, ...]
    words: frozenset[str]
    """Normal forms of all words of rules and lists."""
    spelled_words: frozenset[str]
    """The same words as people write and speak them, for the recogniser."""

    def __reduce__(self) -> tuple[Callable[[str], Language], tuple[str]]:
        """Another process has it, too."""
        return load_language, (self.code,)

    def tokens_of(self, text: str) -> tuple[str, ...]:
        """The normal forms of the words of a text."""
        return _tokens_of(self, text)

    def words_called(self, name: str) -> frozenset[str]:
        """The normal forms of a list of words in the data on speech."""
        return _words_called(self, name)

    def words_for(self, meaning: str) -> frozenset[str]:
        """The normal forms of the words by which rules ask for a meaning, those of the lists that
        stand in them among them."""
        words: set[str] = set()
        asking = (each for each in self.network.productions if each.means == meaning)
        for template in itertools.chain.from_iterable(each.templates for each in asking):
            for text in _texts(template):
                words.update(self.tokens_of(text))
            for slot in _slots(template):
                for way in itertools.chain.from_iterable(self.lists.get(slot, {}).values()):
                    words.update(way)
        return frozenset(words)

    def phrase(self, name: str, /, **values: object) -> str:
        """What the language says by this name, with the values put in."""
        return self.phrases[name].format(**values)


@functools.lru_cache(maxsize=10_000)  # mostly names and phrases, asked for again and again
def _tokens_of(language: Language, text: str) -> tuple[str, ...]:
    return words_of(text, language.spelling)


@functools.lru_cache(maxsize=1_000)
def _words_called(language: Language, name: str) -> frozenset[str]:
    words = map(str, language.speech.get(name, ()))
    return frozenset(norm for word in words for norm in language.tokens_of(word))


def spoken_name(name: str, language: Language) -> str:
    """A name as it stands in a sentence: "the kitchen", but "Alice's office" and "room 12"."""
    form: str = language.speech.get("common_name", "{name}")
    last = name.split()[-1] if name.split() else ""
    proper = name[:1].isupper() or last.isdigit() or len(last) == 1
    owner, mark, _ = name.partition(language.speech.get("possessive") or "\0")
    proper = proper or bool(mark and owner not in language.speech.get("common_owners", ()))
    return name if proper else form.format(name=name)


@functools.lru_cache
def speech(code: str) -> Speech:
    """The phrases in which plans are told, with what other files of the language say of robot
    methods. Raises as `grammar.speech.explained`, and `RuleError` where a method has two."""
    data, methods = explained(code), load_language(code).methods
    twice = next(iter(methods.keys() & data["methods"].keys()), None)
    if twice is not None and registry.is_ours(code):
        raise RuleError(f"explain.yaml and another file of {code} both speak of {twice!r}")
    return msgspec.convert({**data, "methods": {**data["methods"], **methods}}, Speech)


def languages() -> list[str]:
    """The codes of the languages there are: ours, and those of other packages that can be used."""
    return sorted((*registry.ours(), *(code for code in registry.added().folders if usable(code))))


def usable(code: str) -> bool:
    """Whether a language can be loaded; whoever made it is told why not by `languages check`."""
    try:
        load_language(code)
        speech(code)
    except (ValueError, LookupError, OSError, msgspec.MsgspecError, yaml.YAMLError):
        return False
    return True


def troubles() -> dict[str, str]:
    """By code, a sentence on each language of another package that cannot be used."""
    found = registry.added()
    broken = {
        code: f"The language {code!r} in {folder} cannot be used."
        f" Run `nl2robot languages check {code}` to see why."
        for code, folder in found.folders.items()
        if not usable(code)
    }
    return {**found.troubles, **broken}


def known_by_word(text: str) -> list[str]:
    """The languages that a word of a text is known by everywhere: "Deutsch", "arrête". Does not
    load ours."""
    said = {word.casefold() for word in re.findall(r"[^\W\d_]+", text)}
    words = {
        code: load_language(code).known_by for code in languages() if not registry.is_ours(code)
    }
    everywhere = {**words, **_known_everywhere()}
    return [code for code, theirs in everywhere.items() if not said.isdisjoint(theirs)]


@functools.cache
def _known_everywhere() -> Mapping[str, list[str]]:
    words: dict[str, list[str]] = yaml.safe_load((registry.FOLDER / "everywhere.yaml").read_bytes())
    return words


@functools.cache
def load_language(code: str) -> Language:
    """The language of this code. Raises `UnknownLanguage`; `RuleError` where its data are wrong."""
    files = registry.files_of(code)
    english = [] if registry.is_ours(code) else registry.files_of(registry.ENGLISH)
    sources = {path: path.read_bytes() for path in (*files, *english)}

    def compile_language() -> Compiled:
        data = put_together({path: sources[path] for path in files})
        if english:
            data = _completed(data, put_together({path: sources[path] for path in english}))
        return _compiled(data)

    made_from = [*sources.values(), *_own_code()]
    language = _language(code, kept(f"grammar-{code}", made_from, Compiled, compile_language))
    # Its hundred thousand objects live as long as the process: a collection that looked through
    # them all would make some sentence wait for 60 ms.
    gc.freeze()
    return language


def put_together(sources: Mapping[Path, bytes]) -> dict[str, Any]:
    """What the files of a language say together. Raises `RuleError`, `yaml.YAMLError`."""
    contents = {path: _read(path, source) for path, source in sources.items()}
    _no_name_twice(contents)
    data: dict[str, Any] = {}
    for path, content in contents.items():
        for key, value in content.items():
            _merge(data, key, value, path)
    return data


def _completed(data: dict[str, Any], english: dict[str, Any]) -> dict[str, Any]:
    """A language that lacks some of its data: English phrases stand in, and what else English has
    words for is there without any."""
    return {
        **data,
        "phrases": {**english["phrases"], **data.get("phrases", {})},
        "speech": _with_gaps(data.get("speech", {}), english["speech"]),
        "lists": {**{name: {} for name in english["lists"]}, **data.get("lists", {})},
    }


def _with_gaps(data: dict[str, Any], english: dict[str, Any]) -> dict[str, Any]:
    filled = dict(data)
    for key, value in english.items():
        match value:
            case dict():
                filled[key] = _with_gaps(data.get(key) or {}, value)
            case list():
                filled.setdefault(key, [])
            case _:
                filled.setdefault(key, value)
    return filled


def _own_code() -> Iterator[bytes]:
    """What a compiled language depends on besides its data."""
    for name in ("language", "network", "templates", "tokens", "verbs"):
        yield (Path(__file__).parent / f"{name}.py").read_bytes()


class Compiled(msgspec.Struct, frozen=True):
    """A language as it is kept on disk once it is compiled."""

    data: dict[str, Any]
    """What all its files say together, without the rules."""
    network: Network
    lists: dict[str, dict[str, tuple[tuple[str, ...], ...]]]
    fillers: tuple[tuple[str, ...], ...]
    closed: frozenset[str]
    words: frozenset[str]
    spelled_words: frozenset[str]


def _read(path: Path, source: bytes) -> dict[str, Any]:
    try:
        loaded = yaml.load(source, Loader=_Loader)
    except RuleError as error:
        raise RuleError(f"{path.name}: {error}") from error
    if not isinstance(loaded, dict):
        raise RuleError(f"{path.name} is not a mapping of rules, lists and the like")
    return loaded


class _Loader(getattr(yaml, "CSafeLoader", yaml.SafeLoader)):  # type: ignore[misc]
    """YAML in which "no", "yes", "on" and "off" are words, as they are in any language. Nothing in
    it may be named twice: the second would silently take the place of the first."""

    def construct_mapping(self, node: Any, deep: bool = False) -> dict[Any, Any]:
        keys = [key.value for key, _ in node.value]
        twice = next((key for key in keys if keys.count(key) > 1), None)
        if twice is not None:
            raise RuleError(f"{twice!r} stands twice in line {node.start_mark.line + 1} and below")
        mapping: dict[Any, Any] = super().construct_mapping(node, deep)
        return mapping


_Loader.yaml_implicit_resolvers = {
    letter: [entry for entry in entries if entry[0] != "tag:yaml.org,2002:bool"]
    for letter, entries in _Loader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver("tag:yaml.org,2002:bool", re.compile("true|false"), list("tf"))


def _no_name_twice(contents: Mapping[Path, dict[str, Any]]) -> None:
    """Two files that call different things by one name would be merged in silence. A rule that is
    meant to get entries from several files ("command", "thing") is listed under `extended`."""
    extended = {rule for content in contents.values() for rule in content.get("extended", ())}
    home: dict[str, Path] = {}
    for path, content in contents.items():
        for rule in content.get("rules", ()):
            if rule in home and rule not in extended:
                raise RuleError(
                    f"{path.name} and {home[rule].name} both have a rule {rule!r}: name one "
                    "of them otherwise, or list it under 'extended' if both should add to it"
                )
            home[rule] = path


def _merge(data: dict[str, Any], key: str, value: Any, path: Path) -> None:
    if key not in data:
        data[key] = value
    elif key == "rules":
        for rule, entries in value.items():
            old = data[key].get(rule)
            data[key][rule] = entries if old is None else [*_entries(old), *_entries(entries)]
    elif isinstance(value, dict):
        twice = next(iter(value.keys() & data[key].keys()), None)
        if twice is not None:  # the second would silently take the place of the first
            raise RuleError(f"{path.name} gives {twice!r} in {key!r}, which another file has given")
        data[key].update(value)
    elif isinstance(value, list):
        data[key] = [*data[key], *value]
    else:
        raise RuleError(f"{path.name} gives {key!r} a second time")


def _entries(value: Any) -> list[Any]:
    return value if isinstance(value, list) else [value]


def _language(code: str, compiled: Compiled) -> Language:
    data = compiled.data
    rules: dict[str, list[Production]] = {}
    for production in compiled.network.productions:
        rules.setdefault(production.rule, []).append(production)
    return Language(
        code=code,
        rules={name: tuple(productions) for name, productions in rules.items()},
        network=compiled.network,
        lists=compiled.lists,
        spelling=_spelling(data),
        numbers=data.get("numbers", {}),
        fillers=compiled.fillers,
        closed=compiled.closed,
        plurals=data.get("plurals", {}),
        kinds=data.get("kinds", {}),
        phrases=data.get("phrases", {}),
        speech=data.get("speech", {}),
        rewordings=tuple(data.get("rewordings", ())),
        help={topic: tuple(examples) for topic, examples in data.get("help", {}).items()},
        sayings=tuple(data.get("sayings", ())),
        methods=data.get("methods", {}),
        known_by=tuple(data.get("known_by", ())),
        words=compiled.words,
        spelled_words=compiled.spelled_words,
    )


def _spelling(data: Mapping[str, Any]) -> Spelling:
    spelling = data.get("spelling", {})
    letters = spelling.get("letters", {})
    return Spelling(
        contractions=spelling.get("contractions", {}),
        endings=spelling.get("endings", {}),
        abbreviations=frozenset(spelling.get("abbreviations", ())),
        numbers=_with_hundreds(
            data.get("numbers", {}), _number_words(data.get("numbers", {}), letters)
        ),
        symbols=spelling.get("symbols", {}),
        letters=letters,
        hours=frozenset(spelling.get("hours", ())),
        accents_optional=spelling.get("accents") == "optional",
    )


def _compiled(data: Mapping[str, Any]) -> Compiled:
    spelling = _spelling(data)
    normal = functools.cache(lambda text: words_of_template(text, spelling))
    network = compile_rules(_rules(data), normal)
    lists = {
        name: {
            str(value): tuple(
                tuple(word for text in way for word in normal(text))
                for template in _entries(ways)
                for way in _ways(_template(template, name))
            )
            for value, ways in values.items()
        }
        for name, values in data.get("lists", {}).items()
    }
    words = {word for state in network.states for word in state.words}
    words |= {
        word
        for values in lists.values()
        for ways in values.values()
        for way in ways
        for word in way
    }
    words |= {
        word for template in _other_ways(data) for text in _texts(template) for word in normal(text)
    }
    return Compiled(
        data={key: value for key, value in data.items() if key not in _COMPILED},
        network=network,
        lists=lists,
        fillers=tuple(normal(filler) for filler in data.get("fillers", ())),
        closed=frozenset(
            word
            for entry in data.get("closed", ())
            for text in entry.split()
            for word in normal(text)
        ),
        words=frozenset(words),
        spelled_words=_spelled(data, network),
    )


def _rules(data: Mapping[str, Any]) -> dict[str, tuple[Production, ...]]:
    entries_of = dict(data.get("rules", {}))
    if "verbs" in data:
        entries_of |= forms(data["verbs"], data["conjugation"])
    orders: list[Any] = data.get("orders", [])
    rules: dict[str, tuple[Production, ...]] = {}
    for name, entries in entries_of.items():
        order = functools.partial(_ordered, name, orders=orders, rules=entries_of)
        try:
            rules[name] = tuple(_productions(name, _entries(entries), order))
            for production in rules[name]:
                _ = production.templates  # so that a mistake is told with its rule
        except TemplateError as error:
            raise RuleError(f"<{name}>: {error}") from error
    return rules


def _other_ways(data: Mapping[str, Any]) -> Iterator[Template]:
    """What is said otherwise than the rules say it (`grammar.rewordings`)."""
    for entry in data.get("rewordings", ()):
        yield from (_template(say, "rewordings") for say in _entries(entry["say"]))


def _spelled(data: Mapping[str, Any], network: Network) -> frozenset[str]:
    """All words as people write and speak them."""
    numbers = data.get("numbers", {})
    templates = [template for each in network.productions for template in each.templates]
    templates += _other_ways(data)
    templates += [
        _template(way, "lists")
        for values in data.get("lists", {}).values()
        for ways in values.values()
        for way in _entries(ways)
    ]
    spelled = {text for template in templates for text in _texts(template)}
    spelled |= set(_number_words(numbers, {})) | set(numbers.get("scales", {}))
    return frozenset(spelled | {*data.get("fillers", ()), *data.get("closed", ())})


def _with_hundreds(numbers: Mapping[str, Any], words: dict[str, float]) -> dict[str, float]:
    """These and those above that are written in one word, as German "zweihundertfünf"; there are a
    thousand, which nobody has to hear one by one."""
    hundred = numbers.get("hundred")
    if not hundred:
        return words
    whole = {word: value for word, value in words.items() if value < 100 and value == int(value)}
    units = {"": 1.0, **{word: value for word, value in whole.items() if 0 < value < 10}}
    above = {
        f"{unit}{hundred}{rest}": 100 * many + more
        for unit, many in units.items()
        for rest, more in {"": 0.0, **whole}.items()
    }
    return above | words


def _number_words(numbers: Mapping[str, Any], letters: Mapping[str, str]) -> dict[str, float]:
    """One-word numbers: those listed, and compounds such as German "fünfundzwanzig"."""
    words = {str(word): float(value) for word, value in numbers.get("words", {}).items()}
    pattern = numbers.get("compound")
    if pattern:
        units = {word: value for word, value in words.items() if 0 < value < 10}
        tens = {word: value for word, value in words.items() if value >= 20 and value % 10 == 0}
        for ten, much in tens.items():
            for unit, more in units.items():
                words.setdefault(pattern.format(unit=unit, ten=ten), much + more)
    for word, value in tuple(words.items()):
        for letter, instead in letters.items():
            word = word.replace(letter, instead)
        words.setdefault(word, value)
    return words


def _ordered(
    rule: str, say: str, orders: list[Any], rules: Mapping[str, Any]
) -> Iterator[tuple[float, str]]:
    """The templates that one stands for, each with what its order costs more than the usual ones.
    An order may be for the entries of one rule only: {order: ..., of: command, cost: 0.5}."""
    usual = [order for order in orders if isinstance(order, str)]
    yield from ((0.0, each) for each in ordered(say, usual, rules))
    for order in orders:
        if not isinstance(order, str) and order["of"] == rule:
            rarer = ordered(say, [order["order"]], rules)
            yield from ((float(order["cost"]), each) for each in rarer if each != say)


def _productions(
    rule: str, entries: list[Any], ordered: Callable[[str], Iterable[tuple[float, str]]]
) -> Iterator[Production]:
    plain: list[str] = []
    for entry in entries:
        if isinstance(entry, str):
            plain += (each for _, each in ordered(entry))
            continue
        by_cost: dict[float, list[str]] = {}
        for say in _entries(entry["say"]):
            for cost, each in ordered(str(say)):
                by_cost.setdefault(cost, []).append(each)
        unknown = set(entry) - {"say", "means", "cost", "with"}
        if unknown:
            raise RuleError(f"the rule <{rule}> has an entry with {', '.join(sorted(unknown))}")
        for cost, says in by_cost.items():
            cost += float(entry.get("cost", 0))
            yield Production(rule, entry.get("means"), tuple(says), cost, entry.get("with", {}))
    if plain:
        yield Production(rule, None, tuple(plain))


def _template(source: Any, rule: str) -> Template:
    try:
        return parse_template(str(source))
    except TemplateError as error:
        raise RuleError(f"<{rule}>: {error}") from error


def _ways(template: Template) -> Iterator[tuple[str, ...]]:
    """All word sequences of a template without references."""
    match template:
        case Word(text):
            yield (text,)
        case Choice(alternatives):
            for alternative in alternatives:
                yield from _ways(alternative)
        case Sequence(parts):
            if not parts:
                yield ()
                return
            for first in _ways(parts[0]):
                for rest in _ways(Sequence(parts[1:]) if len(parts) > 1 else NOTHING):
                    yield (*first, *rest)
        case _:
            raise RuleError("a list holds words only, no references")


def _texts(template: Template) -> Iterator[str]:
    match template:
        case Word(text):
            yield text
        case Choice(inner) | Sequence(inner):
            for each in inner:
                yield from _texts(each)


def _slots(template: Template) -> Iterator[str]:
    match template:
        case Part(name, is_rule=False):
            yield name
        case Choice(inner) | Sequence(inner):
            for each in inner:
                yield from _slots(each)
