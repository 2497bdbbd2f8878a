"""What a command asks for, without the names in it: "bring; thing at a place; to somebody by name".

Such a frame is made of a logical form (the notation of the GPSR commands: `frames_of_form`) and of
a plan (`frames_of_plan`), so that the two can be compared, role by role. A role's features are
words such as "thing.at" (it is said where the thing is), "to.name" (it goes to somebody by name)
or "thing.superlative=biggest". Names themselves are left out, because logical forms have none.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from typing import Any, Final

from grammar.lexicon import Lexicon
from grammar.plan import Ask, Call, Choice, If, Not, Plan, Recall, Remember, Text, Value, While

Form = str | list["Form"]
"""A logical form: an atom, or a list of forms."""

UNKNOWN: Final = "UNKNOWN"
"""Stands in a logical form for what the command does not say."""
SAME: Final = {
    "largest": "biggest",
    "below": "under",
    "right_of": "right",
    "left_of": "left",
    "on_top_of": "above",
    "in_front_of": "front",
    "next_to": "near",
}
SUPERLATIVES: Final = (
    *("biggest", "smallest", "heaviest", "lightest", "thinnest", "thickest"),
    *("tallest", "shortest", "leftmost", "rightmost"),
)
RELATIONS: Final = {
    "behind": "behind",
    "under": "under",
    "left of": "left",
    "right of": "right",
    "above": "above",
    "next to": "near",
    "in front of": "front",
}
"""How plans say where a thing is from another one."""
SOMEWHERE: Final = re.compile(r" (on|in|at|near|by|under|next to|behind|in front of) the (.*)")
"""How plans say on which furniture a thing is."""
GENDERS: Final = {"male": "man boy male gentleman", "female": "woman girl female lady"}
PEOPLE: Final = frozenset(
    {"person", "child", "visitor", *(noun for nouns in GENDERS.values() for noun in nouns.split())}
)
POSES: Final = ("lying", "sitting", "standing")
GESTURES: Final = ("waving", "raising", "pointing")
DESCRIBED: Final = frozenset({"pose", "gender"})
"""What the description of a person tells."""

NAME_ASKED: Final = "What is your name?"
"""The question that finds out somebody's name; the form says only that the name is told."""

TOLD: Final = frozenset({"count", "describe", "people"})
"""Methods whose result is what is told."""


@dataclass(frozen=True)
class Frame:
    """One action and the features of its roles."""

    head: str
    features: frozenset[str] = frozenset()
    optional: bool = False
    """Whether logical forms may leave it out: where somebody is followed to."""

    def __str__(self) -> str:
        return f"{self.head}({', '.join(sorted(self.features))})"


# --- of a logical form ---------------------------------------------------------------------------


def parsed(text: str) -> Form:
    """A logical form as lists in lists. Raises `ValueError` for one that is not closed."""
    stack: list[list[Form]] = [[]]
    for token in re.findall(r'"[^"]*"|[()]|[^\s()"]+', text):
        if token == "(":
            stack.append([])
        elif token == ")" and len(stack) > 1:
            inner = stack.pop()
            stack[-1].append(inner)
        else:
            stack[-1].append(f'"{token[1:-1].strip()}"' if token[0] == '"' else token)
    if len(stack) != 1 or len(stack[0]) != 1:
        raise ValueError(f"this is no logical form: {text}")
    return stack[0][0]


def frames_of_form(form: Form) -> list[Frame]:
    """What a logical form asks for, step by step."""
    if isinstance(form, str):
        return []
    if form[0] == "lambda":
        return frames_of_form(form[-1])
    if form[0] == "sequence":
        frames: list[Frame] = []
        for each in form[1:]:
            frames += [_of_action(each, frames)] if isinstance(each, list) else []
        return frames
    return [_of_action(form, [])]


def _of_action(form: list[Form], before: list[Frame]) -> Frame:
    head, parts = str(form[0]), form[1:]
    first, second = parts[0], parts[1] if len(parts) > 1 else None
    if head == "say":
        return _of_saying(first, second)
    if head == "count":
        return _frame("count", _features(first, "thing"), {"to.me"})
    if head == "go":
        return _frame("go", {"to.at"})
    if head == "follow":
        return _frame("follow", _features(parts, "who"))
    if head == "guide":
        who = _features(first, "who")
        if isinstance(first, str) and before:  # the same person as before
            who = {each for each in before[-1].features if each.startswith("who.")} - {"who.at"}
        return _frame("guide", who, {"to.back" if second == '"current"' else "to.at"})
    if head == "find":
        number = {f"thing.count={second}"} if isinstance(second, str) else set()
        return _frame("find", _features(first, "thing"), number)
    if head == "bring":
        if isinstance(second, str):  # the place where it is
            return _frame("bring", _features(first, "thing"), {"thing.at", "to.me"})
        to = {"to.me"} if second is None else _features(second, "to")
        return _frame("bring", _features(first, "thing"), to)
    if head == "put":
        return _frame("put", _features(first, "thing"), {"to.at"} if second else set())
    return _frame(head, _features(parts, "thing"))


def _of_saying(what: Form, to: Form | None) -> Frame:
    whom = {"to.me"} if to is None else _features(to, "to")
    if isinstance(what, str):
        return _frame("say", {"what=text"}, whom)
    if what[0] == "answer":
        return _frame("say", {"what=answer"}, whom)
    if what[0] == "count":
        return _frame("count", _features(what, "thing"), whom)
    features = _features(what, "thing")
    asked = {each for each in features if each.startswith("asked=")}
    return _frame("say", features - asked, asked or {"what=which"}, whom)


def _features(form: Form, role: str) -> set[str]:
    """The features that a part of a logical form gives to a role."""
    if isinstance(form, str):
        return set()
    head, rest = form[0], form[1:]
    if isinstance(head, list) or head in ("lambda", "and", "count"):
        inner = [each for each in form if isinstance(each, list)]
        return {feature for each in inner for feature in _features(each, role)}
    quoted = [each for each in rest if isinstance(each, str) and each.startswith('"')]
    head = SAME.get(head, head)
    if head in ("person", "is_a"):
        return set()
    if head in ("pose", "gender", "name") and not quoted:
        return {f"asked={'description' if head in DESCRIBED else head}"}
    if head == "name":
        return {f"{role}.name"}
    if head == "is":
        return {f"{role}.gesture"}
    if head == "at":
        return {f"{role}.at"}
    if head in ("male", "female"):
        return {f"{role}.gender={head}"}
    if head in POSES:
        return {f"{role}.pose={head}"}
    if head in SUPERLATIVES:
        number = {
            f"{role}.count={each}" for each in rest if isinstance(each, str) and each.isdigit()
        }
        return {f"{role}.superlative={head}"} | number | ({f"{role}.at"} if quoted else set())
    return {f"{role}.relation={head}"}


def _frame(head: str, *features: Iterable[str]) -> Frame:
    return Frame(head, frozenset(feature for each in features for feature in each))


# --- of a plan -----------------------------------------------------------------------------------


def frames_of_plan(plan: Plan, lexicon: Lexicon) -> list[Frame]:
    """What a plan does where everything goes well, step by step. Ways that only lead to the next
    step, and looking for what is then used, are a part of that step."""
    names = {each.name for each in lexicon.people}
    walk = _Walk(names, {each.name for each in lexicon.furniture})
    walk.steps(plan.steps)
    return [step.frame for step in walk.done if not step.used]


@dataclass
class _Step:
    frame: Frame
    used: bool = False
    """Whether a later step is what it was for."""


@dataclass
class _Walk:
    """Goes through a plan and remembers where the robot is, with whom and what it holds."""

    names: set[str]
    furniture: set[str]
    done: list[_Step] = field(default_factory=list)
    at: str = ""
    """Empty where the command was given, else "at" or "back"."""
    whom: set[str] | None = None
    """The features of the person the robot stands before."""
    found: dict[str, set[str]] = field(default_factory=dict)
    looked: dict[str, _Step] = field(default_factory=dict)
    way: _Step | None = None
    held: dict[str, set[str]] = field(default_factory=dict)
    taken: dict[str, _Step] = field(default_factory=dict)
    results: dict[str, Frame] = field(default_factory=dict)
    spots: set[str] = field(default_factory=set)
    """Variables that keep where the robot was."""
    sights: set[str] = field(default_factory=set)
    """Variables that keep what was looked for: telling them is the end of looking."""
    glance: _Step | None = None
    """The last step, if it looked at what is there."""

    def steps(self, steps: tuple[Any, ...]) -> None:
        for step in steps:
            if isinstance(step, Call):
                self.call(step.method, step.arguments, step.save_as)
            elif isinstance(step, If) and self._tells_sights(step):
                self._arrive()
            elif isinstance(step, If):
                for ask in _asks(step.condition):
                    self.call(ask.method, ask.arguments, None)
                self.steps(step.otherwise if isinstance(step.condition, Not) else step.then)
            elif isinstance(step, While):  # "all cups in the kitchen": as long as one is found
                for ask in _asks(step.condition):
                    self.call(ask.method, ask.arguments, None)
                self.steps(step.steps)
            elif isinstance(step, Remember):
                for ask in _asks(step.value):
                    self.call(ask.method, ask.arguments, step.name)
            else:
                self.steps(getattr(step, "steps", ()))

    def call(self, method: str, arguments: dict[str, Value], save_as: str | None) -> None:
        act = getattr(self, f"_{method}", None)
        if act is not None:
            act(arguments, save_as)
        else:
            self._do(Frame(method))

    # --- ways and searches, which may only serve what follows

    def _goto(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self.at = "back" if isinstance(arguments.get("place"), Recall) else "at"
        self.whom = None
        self.way = self._do(Frame("go", frozenset({f"to.{self.at}"})))

    def _find(self, arguments: dict[str, Value], save_as: str | None) -> None:
        text = _text(arguments["thing"])
        features = self._noun(text)
        if "place" in arguments:
            features |= {"at"}
            self.at = "at"
        self._arrive()
        self._use(text)
        self.found[text] = features
        self.looked[text] = self._do(_frame("find", (f"thing.{each}" for each in features)))
        self.whom = features

    def _wait_for(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self._find(arguments, save_as)  # whoever is waited for is there then
        if self.at == "at" and self.whom is not None:
            self.whom |= {"at"}

    def _arrive(self) -> None:
        """The last way was for what is done now."""
        if self.way is not None:
            self.way.used, self.way = True, None

    def _use(self, text: str) -> set[str]:
        """What is done now is what somebody or something was looked for."""
        if text in self.looked:
            self.looked[text].used = True
        return self.found.get(text) or self._noun(text)

    # --- things

    def _grab(self, arguments: dict[str, Value], save_as: str | None) -> None:
        text = _text(arguments["thing"])
        features = self._use(text) | ({"at"} if self.at == "at" and not self.looked else set())
        self._arrive()
        name = SOMEWHERE.split(text)[0]
        self.held[name] = features
        self.taken[name] = self._do(_frame("take", (f"thing.{each}" for each in features)))

    def _give(self, arguments: dict[str, Value], save_as: str | None) -> None:
        if "person" in arguments:
            to = self._use(_text(arguments["person"]))
        else:
            to = self._here()
            self._met()
        self._hand_over("bring", _text(arguments["thing"]), to)

    def _put(self, arguments: dict[str, Value], save_as: str | None) -> None:
        to = {"at"} if "where" in arguments or self.at == "at" else set()
        self._hand_over("put", _text(arguments["thing"]), to)

    def _hand_over(self, head: str, text: str, to: set[str]) -> None:
        self._arrive()
        if text in self.taken:
            self.taken[text].used = True
        thing = self.held.get(text) or self._noun(text)
        self._do(_frame(head, (f"thing.{each}" for each in thing), (f"to.{each}" for each in to)))

    # --- people

    def _guide(self, arguments: dict[str, Value], save_as: str | None) -> None:
        place = arguments["place"]
        self._with("guide", arguments, {"to.back" if isinstance(place, Recall) else "to.at"})

    def _follow(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self._with("follow", arguments, set())
        if "to" in arguments:
            self.done.append(_Step(Frame("go", frozenset({"to.at"}), optional=True)))

    def _with(self, head: str, arguments: dict[str, Value], to: set[str]) -> None:
        text = _text(arguments["person"])
        who = self._use(text)
        self._arrive()
        self._do(_frame(head, (f"who.{each}" for each in who), to))
        self.found[text] = who - {"at"}
        self.at = "back" if "to.back" in to else "at"

    # --- words

    def _answer(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self._speak(Frame("say", frozenset({"what=answer"})))

    def _ask(self, arguments: dict[str, Value], save_as: str | None) -> None:
        if save_as is None or _text(arguments["question"]) != NAME_ASKED:
            self._speak(Frame("ask"))
            return
        whom = self._here() - {"me"}
        self._arrive()
        self._met()
        self.results[save_as] = _frame("say", {"asked=name"}, (f"thing.{each}" for each in whom))
        self.whom = None

    def _tells_sights(self, step: If) -> bool:
        """Whether it says whether something was seen, and nothing else."""
        says = (*step.then, *step.otherwise)
        names = {each.name for each in _inside(step.condition, Recall)}
        seen = [ask for ask in _asks(step.condition) if ask.method == "sees"]
        if not step.otherwise or not all(_is_say(each) for each in says):
            return False
        for ask in seen:
            self._sees(ask.arguments, None)
        return bool(seen) or bool(names & self.sights)

    def _sees(self, arguments: dict[str, Value], save_as: str | None) -> None:
        """Looking whether something is there is looking for it."""
        self._look(arguments, save_as)

    def _objects(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self._look({"thing": Text("object")}, save_as)

    def _look(self, arguments: dict[str, Value], save_as: str | None) -> None:
        text = _text(arguments["thing"])
        features = self._noun(text) | ({"at"} if self.at == "at" else set())
        self._arrive()
        if self.done and self.done[-1] is self.glance:
            self.done.pop()  # seen first, and then described
        self.glance = self._do(_frame("find", (f"thing.{each}" for each in features)))
        self.looked[text] = self.glance
        if save_as is not None:
            self.sights.add(save_as)

    def _say(self, arguments: dict[str, Value], save_as: str | None) -> None:
        said = arguments["text"]
        asked = {ask.method: ask for ask in _inside(said, Ask)}
        names = [each.name for each in _inside(said, Recall)]
        if self.looked and ("location" in asked or self.spots & set(names)):
            self._arrive()
            return  # where it was found
        if self.sights & set(names):
            self._arrive()
            return  # what was seen
        for method in TOLD & asked.keys():
            self.call(method, asked[method].arguments, method)
            names.append(method)
        results = [self.results[name] for name in names if name in self.results]
        self._speak(results[0] if results else Frame("say", frozenset({"what=text"})))

    def _speak(self, frame: Frame) -> None:
        to = self._here()
        self._arrive()
        self._met()
        self._do(_frame(frame.head, frame.features, (f"to.{each}" for each in to)))

    def _met(self) -> None:
        """Whoever was looked for is dealt with now."""
        for text, features in self.found.items():
            if features is self.whom:
                self._use(text)

    def _here(self) -> set[str]:
        """Whom the robot speaks to, or hands something to, where it is."""
        if self.whom is not None and self.at != "back":
            return self.whom
        return {"at"} if self.at == "at" else {"me"}

    # --- what is told later

    def _count(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self._keep(save_as, "count", _text(arguments["thing"]), ())

    def _describe(self, arguments: dict[str, Value], save_as: str | None) -> None:
        text = _text(arguments["thing"])
        best = any(each.startswith("superlative") for each in self._noun(text))
        if not best and not (PEOPLE | self.names) & set(text.split()):
            self._look(arguments, save_as)
            return
        self._keep(save_as, "say", text, ("what=which" if best else "asked=description",))

    def _location(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self.spots |= {save_as} if save_as is not None else set()

    def _people(self, arguments: dict[str, Value], save_as: str | None) -> None:
        self._met()  # the names are those of whoever was looked for there
        self._keep(save_as, "say", "", ("asked=name",))

    def _keep(self, save_as: str | None, head: str, text: str, what: Iterable[str]) -> None:
        thing = self._use(text) | ({"at"} if self.at == "at" else set())
        self._arrive()
        self.whom = None
        frame = _frame(head, (f"thing.{each}" for each in thing), what)
        if save_as is not None:
            self.results[save_as] = frame

    # --- helpers

    def _do(self, frame: Frame) -> _Step:
        self.done.append(_Step(frame))
        return self.done[-1]

    def _noun(self, text: str) -> set[str]:
        """The features of a noun phrase as it stands in a plan: "3 biggest object on the desk"."""
        if text in self.names:
            return {"name"}
        features: set[str] = set()
        where = SOMEWHERE.search(text)
        if where is not None and where[2] in self.furniture:
            features.add("at")
            text = text[: where.start()]
        for phrase, relation in RELATIONS.items():
            if f" {phrase} " in text:
                text = text.split(f" {phrase} ")[0]
                features.add(f"relation={relation}")
        if re.search(r" (on|at|in) the ", text):
            features.add("at")
        words = text.split()
        features |= {f"count={each}" for each in words[:1] if each.isdigit()}
        features |= {f"superlative={each}" for each in words if each in SUPERLATIVES}
        features |= {f"pose={each}" for each in POSES if each in words}
        features |= {"gesture" for each in GESTURES if each in words}
        for gender, nouns in GENDERS.items():
            features |= {f"gender={gender}" for each in nouns.split() if each in words}
        return features


def _text(value: Value) -> str:
    return value.value if isinstance(value, Text) else ""


def _is_say(step: Any) -> bool:
    return isinstance(step, Call) and step.method == "say"


def _asks(node: Any) -> list[Ask]:
    return list(_inside(node, Ask))


def _inside(node: Any, kind: type[Any]) -> Iterator[Any]:
    """The parts of a value or condition that are of a kind, itself included."""
    if isinstance(node, kind):
        yield node
        return
    if isinstance(node, Choice):
        return
    for name in getattr(node, "__struct_fields__", ()):
        child = getattr(node, name)
        for each in child if isinstance(child, tuple) else (child,):
            yield from _inside(each, kind)
