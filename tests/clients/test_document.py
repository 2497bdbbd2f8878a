"""What makers of clients in other languages begin with: the server's document."""

from __future__ import annotations

import json
import urllib.error
import urllib.request

import pytest

from robot_api import Robot, Server
from robot_api.drivers import emulated


def test_the_document_is_there_for_whoever_may_come_in() -> None:
    with Server(emulated(), host="0.0.0.0", port=0) as server:
        here = server.address.replace("0.0.0.0", "127.0.0.1")
        with pytest.raises(urllib.error.HTTPError, match="401"):
            urllib.request.urlopen(f"http://{here}/openrpc.json", timeout=20)
        asked = urllib.request.Request(
            f"http://{here}/openrpc.json", headers={"Authorization": f"Bearer {server.token}"}
        )
        with urllib.request.urlopen(asked, timeout=20) as answer:
            assert answer.headers["Content-Type"] == "application/json"
            document = json.load(answer)
        with Robot(here, token=server.token) as robot:
            assert document == robot.request("rpc.discover")


def test_a_stop_may_say_in_whose_name_it_is() -> None:
    with Server(emulated(), port=0) as server, Robot(server.address) as robot:
        methods = {each["name"]: each for each in robot.request("rpc.discover")["methods"]}
    (who,) = methods["robot.stop"]["params"]
    assert (who["name"], who["required"]) == ("who", False)
