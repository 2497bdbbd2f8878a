"""What is known when a sentence is translated or a program reviewed: the world and the robot."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, lru_cache
from typing import TYPE_CHECKING

from grammar.lexicon import Lexicon, Name, Question, Routine
from grammar.owners import with_owners
from nl2robot.errors import UserError
from sim.world.model import World

if TYPE_CHECKING:
    from nl2robot.translate.routines import Routines
    from robot_api.driver import Capabilities

DEFAULT_WORLD = "city-hospital"


class Knowledge:
    """The names a sentence may use, and what the robot can do.

    Without capabilities (`nl2robot translate`, which knows no robot) everything counts as possible.
    """

    def __init__(
        self,
        world: World,
        capabilities: Capabilities | None = None,
        routines: Routines | None = None,
    ) -> None:
        self.capabilities = capabilities
        self.routines = routines
        self.trouble: str | None = None
        """Why the routines are unknown, if they could not be read last time."""
        self.see(world)

    def __reduce__(self) -> tuple[type[Knowledge], tuple[World, Capabilities | None]]:
        """For a review in another process, which needs no routines."""
        return Knowledge, (self.world, self.capabilities)

    def see(self, world: World) -> None:
        """From now on this is the world: its names are known to whatever is translated next."""
        self.world = world
        self._names = cache(self._lexicon)
        self._with = lru_cache(maxsize=8)(self._lexicon_with)

    def lexicon(self, language: str) -> Lexicon:
        """The names of the world and the robot as they are said in a language ("en"), and the
        routines in it, if they can be read: all else can be said without them."""
        if self.routines is None:
            return self._names(language)
        try:
            known, self.trouble = self.routines.known(language), None
        except UserError as error:
            self.trouble = str(error)
            return self._names(language)
        routines = (
            Routine(each.name, each.sentence, each.program, each.reviewed) for each in known
        )
        return self._with(language, tuple(routines))

    def _lexicon_with(self, language: str, routines: tuple[Routine, ...]) -> Lexicon:
        return replace(self._names(language), routines=routines)

    def _lexicon(self, language: str) -> Lexicon:
        world, robot = self.world, self.capabilities

        def said(aliases: dict[str, tuple[str, ...]]) -> tuple[str, ...]:
            return aliases.get(language, ())

        lexicon = Lexicon(
            places=tuple(
                Name(p.name, p.kind, said(p.aliases), inside=p.inside) for p in world.places
            ),
            people=tuple(Name(p.name, p.kind, said(p.aliases), p.is_) for p in world.people),
            objects=tuple(Name(o.name, o.kind, said(o.aliases), o.is_) for o in world.objects),
            furniture=(
                *(Name(f.name, f.kind, said(f.aliases), inside=f.at) for f in world.furniture),
                # Who goes to the main entrance goes to the place it leads to.
                *(Name(d.name, "door", inside=d.at) for d in world.doors if d.name and d.at),
            ),
            contacts=tuple(contact.name for contact in world.contacts),
            contact_aliases=tuple(
                Name(contact.name, contact.kind, said(contact.aliases))
                for contact in world.contacts
                if said(contact.aliases)
            ),
            questions=tuple(
                Question(q.ask[language][0], q.answer.get(language, ""), q.ask[language][1:])
                for q in world.questions
                if q.ask.get(language)
            ),
        )
        lexicon = with_owners(lexicon, language)
        if robot is None:
            return replace(lexicon, robot_name=world.robot.name or "")
        # A robot may declare less than people suggest; what it cannot do, the review refuses.
        return replace(
            lexicon,
            gestures=tuple(dict.fromkeys((*robot.gestures, *lexicon.gestures))),
            emotions=tuple(dict.fromkeys((*robot.emotions, *lexicon.emotions))),
            contacts=tuple(dict.fromkeys((*robot.contacts, *lexicon.contacts))),
            joints=tuple(robot.joints),
            skills=tuple(robot.skills),
            languages=robot.languages,
            robot_name=robot.name,
        )
