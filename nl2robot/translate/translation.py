"""From words to a program: what `nl2robot translate` answers.

Kept light, because it must answer at once: it imports the grammar and the world's names only.
"""

from __future__ import annotations

import time
from collections import Counter
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import replace
from typing import TYPE_CHECKING

import msgspec

from grammar.language import UnknownLanguage, known_by_word, languages, load_language
from grammar.naming import naming
from grammar.normal import normal
from grammar.plan import Plan, calls, from_data, methods, to_data
from grammar.planning.planner import (
    Answer,
    Drafts,
    Interrupted,
    Question,
    Refusal,
    Service,
    Watch,
)
from grammar.planning.turn import Turn
from grammar.program_parser import NotAPlan, parse_program
from grammar.requests import ABOUT_RUNS, Request, agreed
from grammar.summary import summary
from grammar.times.said import begun_by
from grammar.understanding import Context
from nl2robot.deliberation.deciding import Chosen, Open, between, decide
from nl2robot.deliberation.sufficing import is_sure
from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.run.history import told_of
from nl2robot.schedule import talking as appointments
from nl2robot.schedule.asking import Timeless, asked_for
from nl2robot.schedule.rhythm import BadRhythm, local
from nl2robot.schedule.wishes import first_time
from nl2robot.schedule.words import in_words
from nl2robot.sentences import in_language
from nl2robot.translate.courtesies import courtesy
from nl2robot.translate.each_time import each_time, ordered
from nl2robot.translate.other_language import language_of
from nl2robot.translate.outcome import Status, Translation
from nl2robot.translate.planners import AUTO, available, planner
from nl2robot.translate.talk import Talk
from nl2robot.translate.teaching import Reply, reply, settle
from nl2robot.work import Died, Do, TookTooLong, here
from robot_api.capabilities.matching import match_answer
from robot_api.local_time import local_zone

if TYPE_CHECKING:
    from nl2robot.run.history import History, Record
    from nl2robot.schedule.schedule import Schedule


STOP = "robot.stop()\n"
"""The program of a sentence that only stops the robot."""
BRIEF = 8
"""Tokens up to which the rules think about a sentence here: "stop" waits for nobody else's."""
POLITE = 3
"""Words that an answer may have besides those of what was offered."""
SOON = 15 * 60
"""Seconds until which somebody waits beside the robot rather than sends it an appointment: it has
little else to do before, and they see that it waits. Beyond that it would be kept from others."""
_IN_ANY_LANGUAGE = ({"set_language"}, {"stop"})
"""What is done, whatever language it is asked for in."""


def translate(
    utterance: str,
    knowledge: Knowledge,
    language: str = "en",
    planner: str = AUTO,
    talk: Talk | None = None,
    history: History | None = None,
    watch: Watch | None = None,
    do: Do = here,
    schedule: Schedule | None = None,
    as_errand: bool = False,
) -> Translation:
    """Understand an utterance and write it as a program. Never moves anything, never raises for
    words that are not understood: the status says so. A `talk` remembers it; `history` knows what
    was run, for questions about it; `watch` is told how far it is, and may end it; `do`
    does what computes for more than a moment (`nl2robot.review.apart.think`: in another process);
    `schedule` knows the appointments, for questions about them; `as_errand`: it is no order for
    each time that something happens.
    Raises `UserError` for a language or a planner that there is not, and
    `grammar.planning.planner.Interrupted` when `watch` has ended it."""
    started, watch, talk = time.perf_counter(), watch or Watch(), talk or Talk()
    courteous = _courtesy(utterance, knowledge, language, talk)
    if courteous is not None:  # what was said before is as it was
        return _answer(utterance, courteous, None, started)
    answered = _settled(utterance, knowledge, talk, schedule)
    if answered is not None:
        return _answer(utterance, answered, None, started)
    later = _with_its_time(utterance, knowledge, language, planner, talk, watch, do, schedule)
    if later is not None:
        return later
    if not as_errand:

        def errand(said: str, in_talk: Talk) -> Translation:
            return translate(
                said, knowledge, language, planner, in_talk, watch=watch, do=do, as_errand=True
            )

        order = ordered(utterance, knowledge, language)
        kept = schedule is not None
        each = each_time(utterance, order, knowledge, language, talk, errand, kept)
        if each is not None and each.translation is not None:
            return msgspec.structs.replace(each.translation, ms=_milliseconds(started))
        utterance = each.errand if each is not None else utterance
    record = history.last() if history is not None else None
    if talk.context is not None and talk.carried_out(record):
        assert record is not None
        origin = record.origin(knowledge.world)
        talk.context = replace(talk.context, carried_out=True, origin=origin)
    before = talk.context.text if talk.context else ""
    turn = _turn(utterance, knowledge, language, talk.context)
    chosen = _chosen(utterance, turn, talk)
    insists, talk.refused = talk.refused == utterance, ""
    if chosen:
        answer: Decided = chosen
    else:
        try:
            turn, answer = _planned(turn, knowledge, planner, watch, insists, do)
        except (TookTooLong, Died):
            answer = Refusal(turn.language.phrase("not_sure_enough"), context=turn.context)
    if watch.cancelled:  # nobody waits for it, so nothing that is said later can refer to it
        raise Interrupted
    match answer:
        case Service(request=request) if request.kind == "schedule" and request.when is not None:
            talk.context = answer.context
            what = translate(
                request.sentence, knowledge, turn.language.code, planner, watch=watch, do=do
            )
            now = _now(schedule)
            return _at_set_times(utterance, request, what, turn.language.code, talk, now, started)
        case Service(request=request):
            talk.context = answer.context
            reply = _replied(request, knowledge, turn.language.code, before, talk, record, schedule)
            talk.pending = reply.pending
            return _answer(utterance, reply, request, started)
        case Question() | Refusal():
            slip = _courtesy(utterance, knowledge, turn.language.code, talk, with_slips=True)
            if slip is not None and isinstance(answer, Refusal):
                return _answer(utterance, slip, None, started)
            talk.context = answer.context
            talk.refused = utterance if isinstance(answer, Refusal) else ""
            message = _with_trouble(answer.message, knowledge)
            status: Status = "clarify" if isinstance(answer, Question) else "rejected"
            return _without_program(utterance, status, message, answer.suggestions, started)
        case Open(question=question):
            talk.offers = answer.offers
            return _without_program(
                utterance, "clarify", question.message, question.suggestions, started
            )
        case Chosen():
            if schedule is not None:
                later = _as_an_appointment(
                    utterance, turn, answer, knowledge, planner, talk, schedule, do, started
                )
                if later is not None:
                    talk.context = answer.draft.context
                    return later
            talk.context = answer.draft.context
            seen = history.sightings.told(turn, answer.plan) if history and not insists else None
            if seen is not None:
                talk.refused = utterance
                return _remembered(utterance, *seen, started)
            translation = _with_program(utterance, turn, answer, started)
            last = history.sightings.told_of_before(turn, answer.plan) if history else None
            if last is not None:
                explanation = f"{last} {translation.explanation}"
                translation = msgspec.structs.replace(translation, explanation=explanation)
            talk.note(translation)
            return translation


def _at_set_times(
    utterance: str,
    request: Request,
    what: Translation,
    language: str,
    talk: Talk,
    now: float,
    started: float,
) -> Translation:
    """What is to be done is understood, or not; at what times is told here, or asked back."""
    if what.program is None:
        return msgspec.structs.replace(what, utterance=utterance, ms=_milliseconds(started))
    try:
        found = asked_for(request, now, local_zone(), language)
    except BadRhythm as error:
        message = in_language(str(error), language) or str(error)
        return _without_program(utterance, "rejected", message, (), started)
    if isinstance(found, Timeless):
        talk.timeless = found
        return _without_program(utterance, "clarify", found.question, found.sentences, started)
    words = in_words(found, language, now)
    planned = what.at(words, request, utterance, language, rhythm=found)
    return msgspec.structs.replace(planned, ms=_milliseconds(started))


def _as_an_appointment(
    utterance: str,
    turn: Turn,
    chosen: Chosen,
    knowledge: Knowledge,
    planner: str,
    talk: Talk,
    schedule: Schedule,
    do: Do,
    started: float,
) -> Translation | None:
    """What is to be done later, once, is for the book of appointments: there it survives a restart,
    and nobody's robot stands still until then. None for what begins at once or soon, or where what
    is left without its time is not the same."""
    later = begun_by(turn.text, turn.lexicon, turn.language.code, chosen.plan)
    if later is None:
        return None
    request = later.request
    now, zone = schedule.clock(), local_zone()
    with suppress(BadRhythm):
        first = first_time(later.when, now, zone)
        if first is not None and first - now < SOON and later.waits_until(local(first, zone)):
            return None
    alone = Talk()
    alone.context = turn.context
    language = turn.language.code
    what = translate(request.sentence, knowledge, language, planner, alone, do=do)
    rest = msgspec.structs.replace(chosen.plan, steps=later.steps)
    if what.plan is None or normal(from_data(what.plan)).steps != normal(rest).steps:
        return None
    return _at_set_times(utterance, request, what, language, talk, now, started)


def _now(schedule: Schedule | None) -> float:
    """Whoever keeps appointments says what time it is."""
    return schedule.clock() if schedule is not None else time.time()


def _with_its_time(
    utterance: str,
    knowledge: Knowledge,
    language: str,
    planner: str,
    talk: Talk,
    watch: Watch,
    do: Do,
    schedule: Schedule | None,
) -> Translation | None:
    """What is to be done, at the time of day that was said when it was asked back; None if this is
    no answer to that."""
    timeless, talk.timeless = talk.timeless, None
    for whole in timeless.with_answer(utterance, language) if timeless is not None else ():
        mine = talk.copy()
        made = translate(
            whole, knowledge, language, planner, mine, watch=watch, do=do, schedule=schedule
        )
        if made.schedule is not None:
            talk.adopt(mine)
            return msgspec.structs.replace(made, utterance=utterance)
    return None


def _turn(utterance: str, knowledge: Knowledge, language: str, context: Context | None) -> Turn:
    try:
        lexicon = knowledge.lexicon(language)
        return Turn(utterance, lexicon, load_language(language), context or Context())
    except UnknownLanguage as error:
        raise UserError(str(error)) from error


Decided = Service | Question | Refusal | Open | Chosen


def _planned(
    turn: Turn, knowledge: Knowledge, name: str, watch: Watch, insists: bool, do: Do
) -> tuple[Turn, Decided]:
    """What the planner of this name makes of a turn. The rules come first where nobody has chosen:
    what they know they know at once; what they do not, a language model may, unless it seems to be
    in another language than is spoken here: a model would guess, where one has to ask. Whoever says
    the same again `insists`."""
    first = "grammar" if name == AUTO else name
    quick = here if len(turn.tokens) <= BRIEF else do
    if first == "grammar":
        decided = quick(_by_rules, turn, knowledge)
    else:
        decided = do(_decided, turn, planner(first).plan(turn, watch), knowledge)
    if isinstance(decided, Refusal):
        other = _in_another_language(turn.text, knowledge, turn.language.code, quick)
        if other is not None:
            return other
    if name != AUTO or not turn.tokens or not available("model"):
        return turn, decided
    if not _is_open(turn, decided, quick):
        return turn, decided
    if isinstance(decided, Refusal) and not insists and _seems_foreign(turn):
        return turn, decided
    by_model = do(_decided, turn, planner("model").plan(turn, watch), knowledge)
    if isinstance(by_model, Refusal) and not by_model.final:
        if by_model.absent and isinstance(decided, Refusal):
            decided = replace(decided, message=f"{decided.message} {by_model.message}")
        if by_model.absent or isinstance(decided, Refusal):
            return turn, decided  # the rules say which word they do not know
    if isinstance(decided, Chosen) and not isinstance(by_model, Question | Service):
        return turn, do(between, turn, decided, by_model)
    return turn, by_model


def _by_rules(turn: Turn, knowledge: Knowledge) -> Decided:
    return _decided(turn, planner("grammar").plan(turn, Watch()), knowledge)


def _is_open(turn: Turn, decided: Decided, do: Do) -> bool:
    """Whether another planner may know better than the rules."""
    if isinstance(decided, Chosen):
        if methods(decided.plan) == {"stop"}:  # nobody thinks twice
            return False
        return not is_sure(turn, decided.considered) or do(_loses, turn, decided.plan)
    return isinstance(decided, Refusal) and not decided.final


def _seems_foreign(turn: Turn) -> bool:
    return language_of(turn.text, turn.language.code) is not None


def _loses(turn: Turn, plan: Plan) -> bool:
    """Whether a plan for a sentence that says something only after another one ("and ward b?") does
    less than that one's, which a language model wrote: rules know too little of what that was."""
    last = turn.context.plan
    if not turn.context.written or last is None:
        return False
    if not Counter(each.method for each in calls(last)) - Counter(
        each.method for each in calls(plan)
    ):
        return False
    alone = replace(turn, context=Context())
    return not isinstance(planner("grammar").plan(alone, Watch()), Drafts)


def _decided(turn: Turn, answer: Answer, knowledge: Knowledge) -> Decided:
    if not isinstance(answer, Drafts):
        return answer
    decided = decide(turn, answer.drafts, knowledge)
    if isinstance(decided, Refusal):
        return replace(decided, context=turn.context)
    return decided


def _chosen(utterance: str, turn: Turn, talk: Talk) -> Chosen | None:
    """Which one was chosen of what was offered; None if this is no answer to that."""
    offers, talk.offers = talk.offers, ()
    if not offers:
        return None

    if len(offers) == 1 and agreed(utterance, turn.language.code):
        return offers[0].chosen
    longest = max(len(each.told.split()) for each in offers) + POLITE
    if len(utterance.split()) > longest:  # it says more: another order
        return None
    said = match_answer(utterance, [each.told for each in offers], turn.language.code)
    return next((each.chosen for each in offers if each.told == said), None)


def _with_program(utterance: str, turn: Turn, chosen: Chosen, started: float) -> Translation:
    pack = turn.language
    return Translation(
        utterance=utterance,
        status="ok",
        program=_as_kept(turn, chosen.plan) or chosen.considered.program,
        plan=to_data(chosen.plan),
        source=chosen.draft.planner,
        confidence=chosen.confidence,
        explanation=summary(chosen.plan, pack.code, naming(turn.lexicon, pack).called),
        message=None,
        suggestions=[],
        ms=_milliseconds(started),
        unused=chosen.considered.checked.unused,
        own=chosen.considered.checked.own,
    )


def _as_kept(turn: Turn, plan: Plan) -> str | None:
    """The program of the routine that is all that was asked for, as it was kept: so it has been
    approved before. None if it is more, or something else."""
    said = " ".join(turn.language.tokens_of(turn.text))
    for routine in turn.lexicon.routines:
        if routine.program and " ".join(turn.language.tokens_of(routine.name)) in said:
            with suppress(NotAPlan):
                kept = parse_program(routine.program, turn.language.code)
                if kept.steps == normal(plan).steps:
                    return routine.program
    return None


def _remembered(utterance: str, thing: str, told: str, started: float) -> Translation:
    """What the robot need not look for."""
    return _answer(utterance, Reply("ok", told), Request("found", thing), started)


def _without_program(
    utterance: str, status: Status, message: str | None, suggestions: Sequence[str], started: float
) -> Translation:
    ms = _milliseconds(started)
    return Translation.without_program(utterance, status, message, suggestions, ms)


def _milliseconds(started: float) -> float:
    return round((time.perf_counter() - started) * 1000, 3)


def _in_another_language(
    utterance: str, knowledge: Knowledge, language: str, do: Do
) -> tuple[Turn, Chosen] | None:
    """Who wants to be spoken to in another language, or cries stop, may do so in that one: "sprich
    Deutsch", "arrête". What was understood in it; None for anything else."""
    for code in known_by_word(utterance):
        if code == language:
            continue
        turn = _turn(utterance, knowledge, code, None)
        decided = do(_by_rules, turn, knowledge)
        if isinstance(decided, Chosen) and methods(decided.plan) in _IN_ANY_LANGUAGE:
            return turn, decided
    return None


def _with_trouble(message: str | None, knowledge: Knowledge) -> str | None:
    """Why something was not understood; that may be because the routines could not be read."""
    if message is None or knowledge.trouble is None:
        return message
    return f"{message} {knowledge.trouble}"


def _replied(
    request: Request,
    knowledge: Knowledge,
    language: str,
    before: str,
    talk: Talk,
    record: Record | None,
    schedule: Schedule | None,
) -> Reply:
    """The answer to what is asked of the application."""
    pack = load_language(language)
    if request.kind in appointments.KINDS:
        return _of_appointments(request, schedule, language)
    if request.kind in ABOUT_RUNS:
        answer = told_of(request, record, knowledge.lexicon(language), pack)
        return Reply("ok" if record is not None else "rejected", answer)
    match request.kind:
        case "cancel":
            talk.last = None
            return Reply("ok", pack.phrase("dropped"))
        case "undo":
            return Reply("rejected", pack.phrase("nothing_to_undo"))
        case "pace":
            return Reply("rejected", pack.phrase("one_pace"))
        case "planned":
            if talk.last is None or talk.carried_out(record):
                return Reply("rejected", pack.phrase("nothing_planned"))
            return Reply("ok", talk.last.explanation)
        case "why" if talk.last is not None and not talk.carried_out(record):
            values = {"task": talk.last.utterance, "explanation": talk.last.explanation}
            return Reply("ok", pack.phrase("because_said", **values))
        case "why":
            happened = told_of(Request("happened"), record, knowledge.lexicon(language), pack)
            return Reply("ok" if record is not None else "rejected", happened)
        case _:
            return reply(request, knowledge, language, before)


def _of_appointments(request: Request, schedule: Schedule | None, language: str) -> Reply:
    try:
        said = appointments.answered(request, schedule, language)
    except UserError as error:  # the book cannot be read
        return Reply("rejected", in_language(str(error), language) or str(error))
    return Reply(said.status, said.message, pending=said.pending)


def _courtesy(
    utterance: str, knowledge: Knowledge, language: str, talk: Talk, *, with_slips: bool = False
) -> Reply | None:
    """The answer to a courtesy; None where something else was asked back, which it may answer."""
    asked = talk.pending or talk.offers or (talk.context and talk.context.question)
    if asked or language not in languages():
        return None
    said = courtesy(utterance, knowledge.lexicon(language), language, with_slips=with_slips)
    return Reply("ok", said) if said is not None else None


def _settled(
    utterance: str, knowledge: Knowledge, talk: Talk, schedule: Schedule | None
) -> Reply | None:
    """What became of the change that was waiting for a yes; None if this is no answer to it."""
    pending, talk.pending = talk.pending, None
    if pending is None:
        return None
    yes = agreed(utterance, pending.language)
    if yes is None:
        return None
    if isinstance(pending, appointments.CallOff):
        said = appointments.settled(pending, yes, schedule)
        return Reply(said.status, said.message)
    return settle(pending, yes, knowledge, talk.who)


def _answer(utterance: str, answer: Reply, request: Request | None, started: float) -> Translation:
    return Translation(
        utterance=utterance,
        status=answer.status,
        program=None,
        plan=None,
        source="grammar",
        confidence=1.0,
        explanation="",
        message=answer.message,
        suggestions=answer.suggestions,
        ms=_milliseconds(started),
        request=request,
    )
