"""A Furhat sees whether people are there."""

from __future__ import annotations

import threading
import time
from typing import Final

from robot_api.capabilities.languages import fold
from robot_api.capabilities.vision import Vision
from robot_api.driver import StopFlag
from robot_api.errors import NotSupported
from robot_api.robots.furhat.robot import Exchange, Furhat

_LOOKS_EVERY: Final = 0.25
"""Seconds between two looks at who is there."""

_ARTICLES: Final = frozenset(("a", "an", "the", "any", "some"))
_PERSON: Final = frozenset(
    (
        *("person", "persons", "people", "human", "humans"),
        *("somebody", "someone", "anybody", "anyone"),
        # Who stands before it visits it.
        *("visitor", "visitors", "guest", "guests"),
    )
)
_ONLY_PEOPLE: Final = (
    "The Furhat sees that somebody is there, but not who it is, and no things. Look for a person."
)


class FurhatVision(Vision):
    """Its camera tells it that somebody is there, not who or what."""

    def __init__(self, furhat: Furhat) -> None:
        self._furhat = furhat
        self._met: set[str] = set()
        self._lock = threading.Lock()  # for those met

    def offers(self) -> tuple[str, ...]:
        return ("sees", "count", "people", "wait_for")

    def begin(self) -> None:
        """Whom a program before met is met anew."""
        with self._lock:
            self._met.clear()

    def sees(self, stop: StopFlag, thing: str) -> bool:
        return self.count(stop, thing) > 0

    def count(self, stop: StopFlag, thing: str) -> int:
        _only_people(thing)
        return len(self.people(stop))

    def people(self, stop: StopFlag) -> list[str]:
        with self._furhat.exchange(stop) as exchange:
            return ["a person" for _ in self._users(exchange)]

    def wait_for(self, stop: StopFlag, thing: str, timeout: float | None) -> bool:
        """It turns to whom it has met."""
        _only_people(thing)
        end = None if timeout is None else time.monotonic() + timeout
        with self._furhat.exchange(stop) as exchange:
            while (new := self._meet(self._users(exchange))) is None:
                left = _LOOKS_EVERY if end is None else end - time.monotonic()
                if left <= 0:
                    return False
                stop.wait(min(_LOOKS_EVERY, left))
        self._furhat.tell(stop, "request.attend.user", user_id=new)
        return True

    def objects(self, stop: StopFlag) -> list[str]:
        raise NotSupported(_ONLY_PEOPLE)

    def describe(self, stop: StopFlag, thing: str) -> str:
        raise NotSupported(_ONLY_PEOPLE)

    def find(self, stop: StopFlag, thing: str, place: str | None) -> bool:
        raise NotSupported(_ONLY_PEOPLE)

    def _meet(self, users: list[str]) -> str | None:
        """The first who was not met, and now is."""
        with self._lock:
            new = next((user for user in users if user not in self._met), None)
            if new is not None:
                self._met.add(new)
            return new

    def _users(self, exchange: Exchange) -> list[str]:
        """The robot's own numbers of those who are before it, the nearest first."""
        answer = self._furhat.request(exchange, "request.users.once", "response.users.data")
        users = answer.get("users")
        return [
            user["id"]
            for user in (users if isinstance(users, list) else [])
            if isinstance(user, dict) and isinstance(user.get("id"), str)
        ]


def _only_people(thing: str) -> None:
    words = [word for word in fold(thing) if word not in _ARTICLES]
    if len(words) != 1 or words[0] not in _PERSON:
        raise NotSupported(_ONLY_PEOPLE)
