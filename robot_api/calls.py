"""The robot methods with their Python signatures: what a client's `Robot` inherits.

Made from the method table by `python -m robot_api.stub --write`; not to be edited.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from typing import Any, overload

from robot_api.values import Clock, Location


class Calls(ABC):
    """Every robot method as a blocking call; what a call does is up to `_call`."""

    @abstractmethod
    def _call(self, method: str, /, *arguments: Any, **named: Any) -> Any:
        """Make the call and return its result: plain data, a `Location` or a `Clock`."""

    def say(self, text: str, language: str | None = None) -> None:
        """Speak a text aloud; returns when it has been spoken."""
        self._call("say", text=text, language=language)

    def listen(self, prompt: str | None = None, timeout: float = 10) -> str:
        """Listen to whoever is there and return the words heard."""
        result: str = self._call("listen", prompt=prompt, timeout=timeout)
        return result

    def ask(
        self, question: str, options: list[str] | None = None, person: str | None = None
    ) -> str:
        """Ask a question and return the answer: one of the options exactly, or the words heard."""
        result: str = self._call("ask", question=question, options=options, person=person)
        return result

    def answer(self, question: str | None = None) -> str:
        """Answer a question from the predefined ones; listens for it if none is given."""
        result: str = self._call("answer", question=question)
        return result

    def set_volume(self, percent: int) -> None:
        """Set how loud the robot speaks."""
        self._call("set_volume", percent=percent)

    def set_language(self, code: str) -> None:
        """Set the language the robot speaks and hears."""
        self._call("set_language", code=code)

    @overload
    def goto(self, place: str | Location) -> None: ...
    @overload
    def goto(self, x: float, y: float, theta: float | None = None) -> None: ...
    def goto(self, *arguments: Any, **named: Any) -> Any:
        """Drive to a place, a point of the map, or a location remembered before."""
        self._call("goto", *arguments, **named)

    def move(self, metres: float) -> None:
        """Drive straight ahead (or back, if negative)."""
        self._call("move", metres=metres)

    def turn(self, degrees: float) -> None:
        """Turn on the spot."""
        self._call("turn", degrees=degrees)

    def drive(self, linear: float, angular: float, seconds: float) -> None:
        """Drive as with a joystick for a moment."""
        self._call("drive", linear=linear, angular=angular, seconds=seconds)

    def stop(self) -> None:
        """Stop everything at once."""
        self._call("stop")

    def wait(self, seconds: float) -> None:
        """Wait for a while."""
        self._call("wait", seconds=seconds)

    def wait_until(self, time: str, weekday: str | None = None, date: str | None = None) -> None:
        """Wait until the clock next shows a time: today, or tomorrow if that is over today."""
        self._call("wait_until", time=time, weekday=weekday, date=date)

    def dock(self) -> None:
        """Drive back to the charging station."""
        self._call("dock")

    def location(self) -> Location:
        """Tell where the robot is."""
        result: Location = self._call("location")
        return result

    @overload
    def localize(self, place: str | Location) -> None: ...
    @overload
    def localize(self, x: float, y: float, theta: float) -> None: ...
    def localize(self, *arguments: Any, **named: Any) -> Any:
        """Tell the robot where it is, when it is wrong about it."""
        self._call("localize", *arguments, **named)

    def places(self, kind: str | None = None) -> list[str]:
        """List the named places."""
        result: list[str] = self._call("places", kind=kind)
        return result

    def emotion(self, name: str) -> None:
        """Show an emotion."""
        self._call("emotion", name=name)

    def gesture(self, name: str) -> None:
        """Make a gesture."""
        self._call("gesture", name=name)

    def joint(self, name: str, degrees: float) -> None:
        """Move one joint to an angle and hold it there."""
        self._call("joint", name=name, degrees=degrees)

    def log(self, lines: int = 20) -> list[str]:
        """Read the last lines of the robot's debug log."""
        result: list[str] = self._call("log", lines=lines)
        return result

    def call(self, contact: str) -> None:
        """Start a video call with a contact."""
        self._call("call", contact=contact)

    def hang_up(self) -> None:
        """End the video call."""
        self._call("hang_up")

    def scan(self, prompt: str | None = None, timeout: float = 30) -> str:
        """Scan a bar code or QR code held before the robot and return what it says."""
        result: str = self._call("scan", prompt=prompt, timeout=timeout)
        return result

    def show(
        self, text: str | None = None, html: str | None = None, url: str | None = None
    ) -> None:
        """Show a text, a page of HTML or a web page on the screen."""
        self._call("show", text=text, html=html, url=url)

    def click(self, selector: str) -> None:
        """Click on an element of the page on the screen."""
        self._call("click", selector=selector)

    def type_text(self, selector: str, text: str) -> None:
        """Type into a field of the page on the screen."""
        self._call("type_text", selector=selector, text=text)

    def touch(self, options: list[str], prompt: str | None = None) -> str:
        """Show buttons on the touchscreen and return the one that is touched."""
        result: str = self._call("touch", options=options, prompt=prompt)
        return result

    def read_text(self, selector: str) -> str:
        """Read the text of an element of the page on the screen."""
        result: str = self._call("read_text", selector=selector)
        return result

    def sees(self, thing: str) -> bool:
        """Tell whether the robot sees such a thing or person where it is."""
        result: bool = self._call("sees", thing=thing)
        return result

    def count(self, thing: str) -> int:
        """Count such things or people where the robot is."""
        result: int = self._call("count", thing=thing)
        return result

    def objects(self) -> list[str]:
        """List the objects the robot sees where it is."""
        result: list[str] = self._call("objects")
        return result

    def people(self) -> list[str]:
        """List the people the robot sees where it is."""
        result: list[str] = self._call("people")
        return result

    def describe(self, thing: str) -> str:
        """Describe such a thing or person in one sentence."""
        result: str = self._call("describe", thing=thing)
        return result

    def find(self, thing: str, place: str | None = None) -> bool:
        """Look for such a thing or person, here and then from place to place, and stand by it."""
        result: bool = self._call("find", thing=thing, place=place)
        return result

    def wait_for(self, thing: str, timeout: float | None = None) -> bool:
        """Wait until such a thing or person is there that was not already met by waiting here."""
        result: bool = self._call("wait_for", thing=thing, timeout=timeout)
        return result

    def grab(self, thing: str) -> None:
        """Take a thing that is here."""
        self._call("grab", thing=thing)

    def put(self, thing: str, where: str | None = None) -> None:
        """Put a thing that is held down here, on or in a piece of furniture of this place."""
        self._call("put", thing=thing, where=where)

    def give(self, thing: str, person: str | None = None) -> None:
        """Hand a thing that is held to a person who is here."""
        self._call("give", thing=thing, person=person)

    def follow(self, person: str, to: str | None = None) -> None:
        """Go after a person until they reach a place, stand still for a while, or a stop."""
        self._call("follow", person=person, to=to)

    def guide(self, person: str, place: str | Location) -> None:
        """Lead a person to a place at their pace, waiting for them."""
        self._call("guide", person=person, place=place)

    def clock(self) -> Clock:
        """Tell the time, the weekday, the date and the time zone."""
        result: Clock = self._call("clock")
        return result

    def battery(self) -> int:
        """Tell the battery's charge in percent."""
        result: int = self._call("battery")
        return result

    def do(self, /, skill: str, **parameters: Any) -> Any:
        """Use a skill of this robot's own, listed in its capabilities."""
        result: Any = self._call("do", skill=skill, **parameters)
        return result
