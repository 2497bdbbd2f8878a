"""The stand-in for a Furhat speaks as a Furhat does: the maker's own package is content with it,
and our driver sends what that package sends."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Coroutine, Iterator
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import pytest

from robot_api.driver import StopFlag
from robot_api.robots.address import Address
from robot_api.robots.furhat import FURHAT
from robot_api.robots.registry import Setup
from tests.robots.furhat.stand_in import SOON, FurhatStandIn

realtime = pytest.importorskip("furhat_realtime_api")


@pytest.fixture
def furhat() -> Iterator[FurhatStandIn]:
    with FurhatStandIn(key="sesame", users=["user-1"], hears=["to the pharmacy"]) as furhat:
        yield furhat


def finished(work: Coroutine[Any, Any, None]) -> None:
    """Do it in a thread of its own: the tests of pages leave a loop running in theirs."""
    with ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, work).result()


def makers_client(furhat: FurhatStandIn, key: str | None = "sesame") -> realtime.AsyncFurhatClient:
    client = realtime.AsyncFurhatClient("127.0.0.1", key)
    client.set_logging_level(logging.ERROR)
    client.ws_url = f"ws://127.0.0.1:{furhat.port}/v1/events"  # it knows no port but 9000
    return client


async def everything(client: realtime.AsyncFurhatClient) -> None:
    """What our driver asks for, by the maker's package."""
    await client.connect()
    voices = await client.request_voice_status()
    assert [voice["name"] for voice in voices["voice_list"]] == ["Amy", "Vicki"]
    chosen = await client.request_voice_config(language="de-DE", input_language=False)
    assert chosen["voice_id"] == "vicki"
    await client.request_voice_config(name="Amy", input_language=False)
    said = await client.request_speak_text("Hello.", wait=True)
    assert said["text"] == "Hello." and not said["aborted"]
    await client.request_gesture_start("Nod", wait=True)
    await client.request_attend_user("closest")
    await client.request_attend_location(0.0, 0.0, 1.0)
    await client.request_led_set("red")
    await client.request_face_reset()
    assert (await client.request_face_status(face_list=False))["face_id"]
    assert (await client.request_users_once())["users"][0]["id"] == "user-1"
    await client.request_listen_config(["en-US"], ["pharmacy"])
    heard = asyncio.ensure_future(client.wait_for_event(realtime.Events.response_hear_end, SOON))
    await client.request_listen_start(partial=True)
    assert (await heard)["text"] == "to the pharmacy"
    await client.request_listen_stop()
    await client.request_speak_stop()
    await client.disconnect()


def test_the_makers_package_talks_to_it(furhat: FurhatStandIn) -> None:
    finished(everything(makers_client(furhat)))
    assert furhat.said == ["Hello."]
    assert furhat.light == "red"
    assert furhat.attends == (0.0, 0.0, 1.0)


def test_the_makers_package_stops_what_it_says(furhat: FurhatStandIn) -> None:
    furhat.seconds_a_letter = 1.0

    async def talk() -> None:
        client = makers_client(furhat)
        await client.connect()
        ended = asyncio.ensure_future(
            client.wait_for_event(realtime.Events.response_speak_end, SOON)
        )
        await client.request_speak_text("A long story.")
        await client.wait_for_event(realtime.Events.response_speak_start, SOON)
        await client.request_speak_stop()
        assert (await ended)["aborted"]
        await client.disconnect()

    finished(talk())
    assert furhat.said == []


def test_the_makers_package_needs_the_key(furhat: FurhatStandIn) -> None:
    with pytest.raises(RuntimeError, match="Authentication failed"):
        finished(makers_client(furhat, "guessed").connect())


def test_our_driver_sends_what_the_makers_package_sends(furhat: FurhatStandIn) -> None:
    finished(everything(makers_client(furhat)))
    theirs: dict[str, set[str]] = {}
    for message in furhat.received:
        theirs.setdefault(message["type"], set()).update(message)
    furhat.received.clear()
    furhat.hears.append("to the lab")

    driver = FURHAT.connect(
        Setup(address=Address("furhat", "127.0.0.1", furhat.port), password="sesame")
    )
    for method, arguments in (
        ("say", {"text": "Hello."}),
        ("say", {"text": "Hallo.", "language": "de"}),
        ("ask", {"question": "Where to?", "options": ["lab", "pharmacy"]}),
        ("gesture", {"name": "nod"}),
        ("emotion", {"name": "neutral"}),
        ("wait_for", {"thing": "person"}),
        ("do", {"skill": "look at point", "x": 0.0, "y": 0.0, "z": 1.0}),
        ("do", {"skill": "light", "color": "red"}),
    ):
        driver.call(method, arguments, StopFlag())
    driver.close()
    ours = {message["type"]: set(message) for message in furhat.received}
    assert set(ours) == set(theirs)
    for kind, fields in ours.items():
        assert fields <= theirs[kind] | {"request_id"}, kind
