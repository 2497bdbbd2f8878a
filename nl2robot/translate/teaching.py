"""What people ask of the application in conversation: teach it routines, ask what they can say.

Nothing is kept or forgotten before the person who asked has said yes: a request that changes
something is told back with all it would do, and waits in the conversation as `Pending`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import msgspec

from grammar.explain import explain
from grammar.language import Language, UnknownLanguage, load_language, speech
from grammar.lexicon import Lexicon
from grammar.lexicon import Routine as Named
from grammar.names import names_of
from grammar.naming import naming
from grammar.plan import Plan
from grammar.program_parser import NotAPlan, parse_program
from grammar.requests import Request
from grammar.samples import samples
from grammar.speech import fill
from grammar.understand import understand
from grammar.understanding import Understanding
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.schedule.talking import CallOff
from nl2robot.translate.routines import Routine, Routines, spelled

LITTLE = 3
"""Letters of a word that tells no topic."""
LONGEST_NAME = 5
"""Words."""
ALIKE = 70
"""How alike a topic must be to what help was asked about, in percent."""


@dataclass(frozen=True)
class Pending:
    """A change that waits for a yes."""

    kind: Literal["learn", "rename", "forget"]
    name: str
    language: str
    sentence: str = ""
    new: str = ""
    """The new name."""


@dataclass(frozen=True)
class Reply:
    """What becomes of a request."""

    status: Literal["ok", "clarify", "rejected"]
    message: str
    suggestions: Sequence[str] = ()
    pending: Pending | CallOff | None = None


def reply(request: Request, knowledge: Knowledge, language: str, before: str = "") -> Reply:
    """Answer a request; changes nothing. `before` is the command before it, for "call that ..."."""
    pack = load_language(language)
    if request.kind == "help":
        return _help(request.part, knowledge.lexicon(language), pack)
    if request.kind == "schedule":
        said = understand(request.sentence, knowledge.lexicon(language), language)
        message = pack.phrase("routine_scheduled", part=request.part)
        return Reply("rejected", message, (request.sentence,) if said.plan else ())
    if knowledge.routines is None:
        return Reply("rejected", pack.phrase("routine_nowhere"))
    teacher = Teacher(knowledge, knowledge.routines, pack)
    match request.kind:
        case "learn":
            return teacher.learn(request.name, request.sentence or before)
        case "change":
            return teacher.change(request.name, request.sentence)
        case "list":
            return teacher.list()
        case "explain":
            return teacher.explain(request.name)
        case "rename":
            return teacher.rename(request.name, request.new)
        case _:
            return teacher.forget(request.name)


def settle(pending: Pending, agreed: bool, knowledge: Knowledge, by: str = "") -> Reply:
    """Do what was waiting for a yes, or leave it. `by`: who has agreed."""
    language = pending.language
    pack = load_language(language)
    if not agreed or knowledge.routines is None:
        return Reply("ok", pack.phrase("routine_left"))
    if pending.kind == "learn":
        knowledge.routines.put(pending.name, pending.sentence, language, by)
        return Reply("ok", pack.phrase("routine_learned", name=pending.name), (pending.name,))
    if pending.kind == "rename":
        knowledge.routines.rename(pending.name, pending.new, language)
        message = pack.phrase("routine_renamed", name=pending.name, new=pending.new)
        return Reply("ok", message, (pending.new,))
    knowledge.routines.remove(pending.name, language)
    return Reply("ok", pack.phrase("routine_forgotten", name=pending.name))


def tidied(name: str) -> str:
    """A name without the punctuation around it."""
    return " ".join(name.strip(" .,:;!?\"'“”„«»").split())


def told(plan: Plan, lexicon: Lexicon, language: str) -> str:
    """The plan in plain words, with the names as they are said in the language."""
    return explain(plan, language, naming(lexicon, load_language(language)).called)


def _help(about: str, lexicon: Lexicon, pack: Language) -> Reply:
    """An example of each topic, or all of the topic that was asked about."""
    topics = samples(lexicon, pack.code)
    found = topic_of(about, list(topics)) if about else None
    phrases = topics[found] if found else [examples[0] for examples in topics.values()]
    return Reply("ok", pack.phrase("here_is_help"), phrases)


def topic_of(words: str, topics: Sequence[str]) -> str | None:
    """The topic that is meant: "loops" is "loops and conditions"."""
    from rapidfuzz import fuzz, process, utils

    def telling(text: str) -> str:
        """Without articles and the like, which all of them have."""
        said = utils.default_process(text).split()
        return " ".join([each for each in said if len(each) > LITTLE] or said)

    found = process.extractOne(
        words, topics, scorer=fuzz.partial_token_ratio, processor=telling, score_cutoff=ALIKE
    )
    return found[0] if found else None


class Teacher:
    """Answers about routines in one language."""

    def __init__(self, knowledge: Knowledge, routines: Routines, pack: Language) -> None:
        self.routines = routines
        self.pack = pack
        self.language = pack.code
        self.lexicon = knowledge.lexicon(pack.code)

    @classmethod
    def of(cls, knowledge: Knowledge, language: str) -> Teacher:
        """For a knowledge that has routines. Raises `UserError` for an unknown language."""
        assert knowledge.routines is not None
        try:
            return cls(knowledge, knowledge.routines, load_language(language))
        except UnknownLanguage as error:
            raise UserError(str(error)) from error

    def learn(self, said: str, sentence: str) -> Reply:
        name = tidied(said)
        known = self.routines.get(name, self.language)
        if known is not None:
            return self.change(known.name, sentence)
        wrong = self.wrong_name(name)
        if wrong:
            return Reply("rejected", wrong)
        if not sentence:
            return Reply("rejected", self.pack.phrase("routine_nothing", name=name))
        body = self.body(name, sentence)
        if body.plan is None:
            return self.not_learned(name, sentence, body)
        message = self.pack.phrase("routine_learn", name=name, explanation=self.told(body.plan))
        return self.asked(message, Pending("learn", name, self.language, sentence))

    def change(self, name: str, sentence: str) -> Reply:
        known = self.routines.get(name, self.language)
        if known is None:
            return self.unknown(name)
        if not sentence:
            return Reply("rejected", self.pack.phrase("routine_nothing", name=known.name))
        sentence = self.changed(known, sentence)
        if spelled(sentence, self.language) == spelled(known.sentence, self.language):
            return Reply("ok", self.pack.phrase("routine_same", name=known.name))
        body = self.body(known.name, sentence)
        if body.plan is None:
            return self.not_learned(known.name, sentence, body)
        message = self.pack.phrase(
            "routine_replace",
            name=known.name,
            before=self.does(known)[1],
            explanation=self.told(body.plan),
        )
        return self.asked(message, Pending("learn", known.name, self.language, sentence))

    def list(self) -> Reply:
        known = self.routines.known(self.language)
        if not known:
            return Reply("ok", self.pack.phrase("routines_none"))
        names = ", ".join(f"{self.quoted(each.name)} ({self.short(each)})" for each in known)
        phrase = "routine_is" if len(known) == 1 else "routines_are"
        message = self.pack.phrase(phrase, number=len(known), names=names)
        return Reply("ok", message, [each.name for each in known])

    def explain(self, name: str) -> Reply:
        known = self.routines.get(name, self.language)
        if known is None:
            return self.unknown(name)
        message = self.pack.phrase(
            "routine_does" if known.sentence else "routine_does_program",
            name=known.name,
            sentence=known.sentence,
            explanation=self.does(known)[1],
        )
        return Reply("ok", message, (known.name,))

    def rename(self, name: str, said: str) -> Reply:
        known = self.routines.get(name, self.language)
        if known is None:
            return self.unknown(name)
        new = tidied(said)
        if self.routines.get(new, self.language) is not None:
            return Reply("rejected", self.pack.phrase("routine_name_used", name=new))
        wrong = self.wrong_name(new)
        if wrong:
            return Reply("rejected", wrong)
        message = self.pack.phrase("routine_rename", name=known.name, new=new)
        users = self.users(known)
        if users:
            message = f"{message} {self.pack.phrase('routine_used_by', names=users)}"
        return self.asked(message, Pending("rename", known.name, self.language, new=new))

    def forget(self, name: str) -> Reply:
        known = self.routines.get(name, self.language)
        if known is None:
            return self.unknown(name)
        message = self.pack.phrase(
            "routine_forget", name=known.name, explanation=self.does(known)[1]
        )
        users = self.users(known)
        if users:
            message = f"{message} {self.pack.phrase('routine_used_by', names=users)}"
        return self.asked(message, Pending("forget", known.name, self.language))

    def keep(self, said: str, program: str) -> str:
        """The name under which a program can be kept as a new routine. Raises `UserError`."""
        name = tidied(said)
        if self.routines.get(name, self.language) is not None:
            raise UserError(self.pack.phrase("routine_name_used", name=name))
        wrong = self.wrong_name(name)
        if wrong:
            raise UserError(wrong)
        self.check_program(program)
        return name

    def check_program(self, program: str) -> Plan:
        """What a program does. Raises `UserError` if no routine can: only what can also be said is
        understood among other commands."""
        try:
            return parse_program(program, self.language)
        except NotAPlan as error:
            raise UserError(self.pack.phrase("routine_no_program", reason=str(error))) from error

    # --- replies

    def asked(self, message: str, pending: Pending) -> Reply:
        return Reply("clarify", message, (self.pack.phrase("yes"), self.pack.phrase("no")), pending)

    def unknown(self, name: str) -> Reply:
        message = self.pack.phrase("routine_unknown", name=name)
        return Reply("rejected", f"{message} {self.list().message}")

    def not_learned(self, name: str, sentence: str, body: Understanding) -> Reply:
        """Why the sentence cannot be a routine's."""
        if body.request is not None:
            reason = self.pack.phrase("routine_no_command")
        elif self.mentions(sentence, name):
            return Reply("rejected", self.pack.phrase("routine_itself", name=name))
        else:
            reason = body.message or self.pack.phrase("not_understood_at_all")
        message = self.pack.phrase("routine_not_understood", name=name, reason=reason)
        return Reply("rejected", message, body.suggestions)

    # --- what routines do

    def body(self, name: str, sentence: str) -> Understanding:
        """The sentence as it is understood in a routine of this name: without that routine."""
        return understand(sentence, self.without(name), self.language)

    def changed(self, known: Routine, said: str) -> str:
        """The routine's sentence after what is said of it: "also wave", "without the greeting"; a
        command of its own stands for all of it."""
        if not known.sentence:
            return said  # no words that "also" could go on from
        context = self.body(known.name, known.sentence).context
        result = understand(said, self.without(known.name), self.language, context)
        return result.context.text if result.plan is not None else said

    def without(self, name: str) -> Lexicon:
        said = spelled(name, self.language)
        others = (r for r in self.lexicon.routines if spelled(r.name, self.language) != said)
        return replace(self.lexicon, routines=tuple(others))

    def told(self, plan: Plan) -> str:
        return told(plan, self.lexicon, self.language)

    def plan_of(self, routine: Routine) -> tuple[Plan | None, str]:
        """What a routine does in this world; None and why it cannot be used here."""
        if routine.program:
            try:
                plan = parse_program(routine.program, self.language)
                # Comments are notes of who wrote it, and nothing that was said.
                return msgspec.structs.replace(plan, background=()), ""
            except NotAPlan as error:
                return None, str(error)
        body = self.body(routine.name, routine.sentence)
        return body.plan, body.message or self.pack.phrase("not_understood_at_all")

    def does(self, routine: Routine) -> tuple[bool, str]:
        """Whether a routine can be used in this world, and what it does, or why it cannot."""
        plan, why = self.plan_of(routine)
        return (True, self.told(plan)) if plan is not None else (False, why)

    def short(self, routine: Routine) -> str:
        return routine.sentence.rstrip(" .!") or self.pack.phrase("routine_a_program")

    def quoted(self, name: str) -> str:
        """In the quotation marks of the language."""
        return fill(speech(self.language).values["quoted"], {"text": name})

    def users(self, routine: Routine) -> str:
        """The names of the routines that could not do without this one."""
        less = self.without(routine.name)
        return ", ".join(
            self.quoted(each.name)
            for each in less.routines
            if self.mentions(each.sentence, routine.name)
            and understand(each.name, self.lexicon, self.language).plan is not None
            and understand(each.name, less, self.language).plan is None
        )

    def mentions(self, sentence: str, name: str) -> bool:
        words, part = spelled(sentence, self.language), spelled(name, self.language)
        return any(words[at : at + len(part)] == part for at in range(len(words)))

    # --- names

    def wrong_name(self, name: str) -> str | None:
        """Why a new routine cannot have this name; None if it can."""
        words = spelled(name, self.language)
        if not 1 <= len(words) <= LONGEST_NAME:
            return self.pack.phrase("routine_name_long", name=name)
        slot = self.slot_of(words)
        if slot is not None:
            what = {"place": "place", "person": "person", "object": "thing", "furniture": "thing"}
            taken = self.pack.phrase(f"taken_{what.get(slot, 'other')}")
            return self.pack.phrase("routine_name_taken", name=name, what=taken)
        alone = understand(name, self.lexicon, self.language)
        if alone.plan is not None or alone.request is not None:
            return self.pack.phrase("routine_name_command", name=name)
        if not self.sayable(name, words):
            return self.pack.phrase("routine_name_word", name=name)
        return None

    def slot_of(self, words: tuple[str, ...]) -> str | None:
        """The kind of name that these words are in the world or of the robot."""
        for slot, trie in names_of(self.pack, self.lexicon).tries.items():
            if slot in self.pack.lists:
                continue  # words of the language, whose commands are looked at
            node = trie
            for word in words:
                following = node.branches.get(word)
                if following is None:
                    break
                node = following
            else:
                if node.values:
                    return slot
        return None

    def sayable(self, name: str, words: tuple[str, ...]) -> bool:
        """Whether the name would be heard as the routine's, alone and between other commands."""
        silent = self.pack.closed | {word for filler in self.pack.fillers for word in filler}
        telling = [word for word in words if word not in silent and any(map(str.isalpha, word))]
        if not telling or (len(words) == 1 and words[0] in self.pack.words):
            return False
        command = samples(self.lexicon, self.language)
        example = next(iter(command.values()))[0]
        lexicon = replace(self.lexicon, routines=(Named(name, example),))
        read = [
            understand(sentence, lexicon, self.language)
            for sentence in (name, f"{name}. {example}", f"{example}. {name}")
        ]
        return all(("routine" in (slot for _, slot in each.reading)) for each in read)
