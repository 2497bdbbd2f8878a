"""Routines in a file that people hand on: written, and read with every mistake in its line.

    nl2robot-routines: 1
    routines:
    - name: evening round
      sentence: go to every ward and say good night
      language: en
    - name: tea round
      program: |
        robot.goto("lobby")
        robot.say("Tea!")
      language: en

It is YAML, of which JSON is a part. What was said of a routine elsewhere (who taught it, how often
it ran) stays there: here it is new, and nobody's word (`routines.Routine.reviewed`).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar, Final, Literal

from grammar.language import languages
from grammar.program_parser import NotAPlan, parse_program
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.translate.routines import Routine, Routines, spelled, written
from nl2robot.translate.teaching import Teacher, tidied
from sandbox.limits import MAX_PROGRAM
from sim.world.yaml_nodes import (
    FileProblems,
    Hopeless,
    MappingNode,
    Node,
    NodeReader,
    ScalarNode,
    SequenceNode,
    Sort,
    compose_text,
)

VERSION: Final = 1
HEAD: Final = "nl2robot-routines"
"""The field that says what sort of file it is, and of which version."""
MOST: Final = 200
"""Routines in a file."""
LONGEST_FILE: Final = 1_000_000
"""Characters."""
LONGEST_SENTENCE: Final = 2000
_SORT: Final = Sort(
    "file of routines",
    "a file that was exported on the page Routines",
    "Export routines to see what is in one.",
)


@dataclass(frozen=True)
class Found:
    """A routine of a file."""

    routine: Routine
    line: int


State = Literal["new", "same", "taken", "unfit"]


@dataclass(frozen=True)
class Choice:
    """What somebody wants of a file: the routine of this number (from 0), under this name."""

    number: int
    name: str
    replace: bool = False
    """Whether it may take the place of the one that is called so."""


def exported(routines: Iterable[Routine]) -> str:
    """The file of these routines."""
    told = [
        {"name": each.name, **_body(each), "language": each.language}
        for each in sorted(routines, key=lambda each: (each.language, each.name.lower()))
    ]
    return written({HEAD: VERSION, "routines": told})


def _body(routine: Routine) -> dict[str, str]:
    if routine.program:
        return {"program": routine.program}
    return {"sentence": routine.sentence}


def read(text: str, file: str) -> tuple[Found, ...]:
    """The routines of a file's text; `file` is what it is called. Raises `UserError` that tells
    all that is wrong with it, line by line."""
    reader = _Reader(file)
    try:
        if len(text) > LONGEST_FILE:
            raise Hopeless(
                None, f"The file is larger than {LONGEST_FILE // 1000} kB. Export fewer routines."
            )
        found = reader.routines(compose_text(text, _SORT))
    except Hopeless as hopeless:
        raise UserError(str(FileProblems(file, [*reader.problems, hopeless.problem]))) from None
    if reader.problems:
        raise UserError(str(FileProblems(file, reader.problems)))
    return found


class _Reader(NodeReader):
    FIELDS: ClassVar[Mapping[str, str]] = {
        "the file": f"{HEAD} routines",
        "a routine": "name sentence program language",
    }

    def routines(self, root: Node) -> tuple[Found, ...]:
        version = self._version(root)
        if version is None:
            raise Hopeless(
                root.line,
                f'This is no file of routines: it does not begin with "{HEAD}: {VERSION}".'
                " Choose a file that was exported on the page Routines.",
            )
        if version != str(VERSION):
            raise Hopeless(
                root.line,
                f'The file has version "{version[:20]}", and only version {VERSION} is known here.'
                " Bring nl2robot up to date, or export the routines anew.",
            )
        fields = self.mapping(root, "the file")
        nodes = (
            self.items(fields["routines"], "The list of routines", MOST)
            if "routines" in fields
            else []
        )
        if not nodes and not self.problems:
            self.problem(root.line, "There are no routines in this file. Choose another one.")
        found = [each for node in nodes if (each := self._routine(node)) is not None]
        self._check_unique(found)
        return tuple(found)

    def _version(self, root: Node) -> str | None:
        if not isinstance(root, MappingNode):
            return None
        for key, value in root.value:
            if isinstance(key, ScalarNode) and key.value == HEAD and isinstance(value, ScalarNode):
                return value.value.strip()
        return None

    def _routine(self, node: Node) -> Found | None:
        before = len(self.problems)
        fields = self.mapping(node, "a routine")
        if len(self.problems) > before:
            return None
        name = self._name(fields, node)
        language = self._language(fields)
        sentence = program = ""
        if ("sentence" in fields) == ("program" in fields):
            self.problem(
                node.line,
                "A routine needs either a sentence or a program, and not both. Write one of them.",
            )
        elif "sentence" in fields:
            told = self.text(fields["sentence"], "The sentence", LONGEST_SENTENCE)
            sentence = told or ""
        else:
            program = self._program(fields["program"], language)
        if len(self.problems) > before:
            return None
        return Found(Routine(name, sentence, language, program=program), node.line)

    def _name(self, fields: Mapping[str, Node], node: Node) -> str:
        if "name" not in fields:
            self.problem(node.line, 'A routine needs a name: "name: evening round".')
            return ""
        name = tidied(self.text(fields["name"], "The name") or "")
        if not name and isinstance(fields["name"], ScalarNode) and fields["name"].value.strip():
            self.problem(fields["name"].line, "The name has no letters. Give it some.")
        return name

    def _language(self, fields: Mapping[str, Node]) -> str:
        if "language" not in fields:
            return "en"
        language = self.text(fields["language"], "The language") or ""
        known = sorted(languages())
        if language and language not in known:
            self.problem(
                fields["language"].line,
                f'The language "{language[:20]}" is not spoken here.'
                f" It can be {', '.join(known[:-1])} or {known[-1]}.",
            )
        return language

    def _program(self, node: Node, language: str) -> str:
        self.count(node)
        if isinstance(node, SequenceNode | MappingNode):
            self.wrong(node, "The program", "a text")
            return ""
        if len(node.value.encode("utf-8", "replace")) > MAX_PROGRAM:
            self.problem(
                node.line, f"The program is longer than {MAX_PROGRAM // 1000} kB. Make it shorter."
            )
            return ""
        if not node.value.strip():
            self.problem(node.line, "The program is empty. Write what the robot shall do.")
            return ""
        if not all(c.isprintable() or c in "\n\t" for c in node.value):
            self.problem(
                node.line, "The program holds characters that cannot be shown. Remove them."
            )
            return ""
        try:
            parse_program(node.value, language or "en")
        except NotAPlan as error:
            self.problem(node.line, f"Line {error.line} of the program: {error.sentence}")
        return node.value

    def _check_unique(self, found: Sequence[Found]) -> None:
        seen: dict[tuple[str, tuple[str, ...]], Found] = {}
        for each in found:
            routine = each.routine
            said = (routine.language, spelled(routine.name, routine.language))
            first = seen.setdefault(said, each)
            if first is not each:
                self.problem(
                    each.line,
                    f'There is a routine "{routine.name}" in line {first.line} already. Give one of'
                    " them another name.",
                )


def state_of(routine: Routine, knowledge: Knowledge) -> tuple[State, str]:
    """How a routine of a file stands to those that are known: `new`; the `same` as one; its name is
    `taken` by another one; or `unfit` for a name here, and why."""
    assert knowledge.routines is not None
    known = knowledge.routines.get(routine.name, routine.language)
    if known is not None:
        return ("same" if _is_same(known, routine) else "taken"), ""
    wrong = Teacher.of(knowledge, routine.language).wrong_name(routine.name)
    return ("unfit", wrong) if wrong else ("new", "")


def _is_same(one: Routine, other: Routine) -> bool:
    if one.program or other.program:
        return one.program == other.program
    return spelled(one.sentence, one.language) == spelled(other.sentence, other.language)


def take_over(
    found: Sequence[Found], choices: Iterable[Choice], knowledge: Knowledge, file: str
) -> list[Routine]:
    """Keep the routines that were chosen of a file: all of them, or none. Raises `UserError` if a
    name is taken and may not be replaced, or no name for a routine."""
    routines: Routines | None = knowledge.routines
    assert routines is not None
    chosen: list[tuple[Routine, bool]] = []
    names: set[tuple[str, tuple[str, ...]]] = set()
    for choice in choices:
        if not 0 <= choice.number < len(found):
            raise UserError(f"The file has no routine number {choice.number + 1}. Open it again.")
        routine = found[choice.number].routine
        name = tidied(choice.name)
        teacher = Teacher.of(knowledge, routine.language)
        said = (routine.language, spelled(name, routine.language))
        if said in names:
            raise UserError(teacher.pack.phrase("routine_name_used", name=name))
        names.add(said)
        taken = routines.get(name, routine.language) is not None
        if taken and not choice.replace:
            raise UserError(teacher.pack.phrase("routine_name_used", name=name))
        wrong = None if taken else teacher.wrong_name(name)
        if wrong:
            raise UserError(wrong)
        new = Routine(
            name,
            routine.sentence,
            routine.language,
            program=routine.program,
            imported=file,
            reviewed=False,
        )
        chosen.append((new, choice.replace))
    if not chosen:
        raise UserError("None of the routines was chosen. Choose at least one, or close the file.")
    return routines.take(chosen)
