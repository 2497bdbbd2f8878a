"""How robots come together over Zenoh: encrypted, found by multicast, or not at all."""

from __future__ import annotations

import json
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from nl2robot.errors import UserError
from nl2robot.fleet.address import FleetAddress
from nl2robot.fleet.network import Network
from nl2robot.sentences import in_language
from tests.fleet.papers import Authority
from tests.fleet.wards import port

SOON = 20.0
NEVER = 2.0
"""Seconds in which those who may meet would have met three times."""


class Post:
    """Robots of one fleet with nothing but their network."""

    def __init__(self, folder: Path, stack: ExitStack) -> None:
        self._folder, self._stack = folder, stack

    def joins(self, name: str, **how: Any) -> tuple[Network, Mailbox]:
        """`said`: what its Zenoh's configuration says, if it has one."""
        said = how.pop("said", None)
        if said is not None:
            how["config"] = self._folder / f"{name}.json5"
            how["config"].write_text(json.dumps(said), encoding="utf-8")
        box = Mailbox()
        made = Network(
            FleetAddress(name, **how),
            *("fleet", name, "life"),
            box.comes,
            lambda robot, session: None,
            box.warned,
        )
        self._stack.callback(made.close)
        made.open()
        return made, box


class Mailbox:
    """What came to one of them, and what it was warned of."""

    def __init__(self) -> None:
        self.came, self.warns = threading.Event(), threading.Event()
        self.sentences: list[str] = []
        self.urgent = False

    def comes(self, raw: bytes, urgent: bool) -> None:
        self.urgent = urgent
        self.came.set()

    def warned(self, sentence: str) -> None:
        self.sentences.append(sentence)
        self.warns.set()


def meet(sender: Network, to: str, box: Mailbox, seconds: float) -> bool:
    """Whether something that is said again and again comes within that time."""
    for _ in range(int(seconds / 0.1)):
        sender.send(to, b"Good morning.", urgent=True)
        if box.came.wait(0.1):
            return True
    return False


@pytest.fixture
def post(tmp_path: Path) -> Iterator[Post]:
    with ExitStack() as stack:
        yield Post(tmp_path, stack)


@pytest.fixture
def house(tmp_path: Path) -> Authority:
    return Authority(tmp_path, "house")


def tls(**about: object) -> dict[str, Any]:
    return {"transport": {"link": {"tls": about}}}


@pytest.mark.parametrize("both", [False, True], ids=["one shows its certificate", "both do"])
def test_they_meet_encrypted(post: Post, house: Authority, both: bool) -> None:
    where = f"tls/127.0.0.1:{port()}"
    trusts = {"root_ca_certificate": str(house.file), "enable_mtls": both}
    shows = {f"connect_{what[7:]}": file for what, file in house.gives("ben").items()}
    ada, _ = post.joins("ada", listens=(where,), said=tls(**trusts, **house.gives("ada")))
    _, box = post.joins("ben", connects=(where,), said=tls(**trusts, **(shows if both else {})))
    assert meet(ada, "ben", box, SOON)
    assert box.sentences == []
    assert box.urgent  # as it was said


@pytest.mark.parametrize("trouble", ["another's", "ended", "of elsewhere", "none", "no TLS"])
def test_who_is_not_believed_is_not_met_and_that_is_said(
    post: Post, house: Authority, tmp_path: Path, trouble: str
) -> None:
    other = Authority(tmp_path, "other")
    shown = {
        "another's": lambda: other.gives("ada"),
        "ended": lambda: house.gives("ada", ended=True),
        "of elsewhere": lambda: house.gives("ada", host="10.9.9.9"),
    }.get(trouble, lambda: house.gives("ada"))()
    said = {
        "another's": "is not believed (",
        "ended": "is not believed (certificate has expired)",
        "of elsewhere": "is not believed (IP address mismatch",
        "none": "does not take this one's certificate, or lacks one",
        "no TLS": "does not speak TLS",
    }[trouble]
    number = port()
    trusts = {"root_ca_certificate": str(house.file)}
    kind = "tcp" if trouble == "no TLS" else "tls"
    asks = {"enable_mtls": trouble == "none"}
    ada, hers = post.joins(
        "ada", listens=(f"{kind}/127.0.0.1:{number}",), said=tls(**trusts, **asks, **shown)
    )
    _, his = post.joins("ben", connects=(f"tls/127.0.0.1:{number}",), said=tls(**trusts))
    assert his.warns.wait(SOON)
    [sentence] = his.sentences
    assert said in sentence and f"tls/127.0.0.1:{number}" in sentence
    assert all(in_language(sentence, language) for language in ("de", "fr"))
    assert not meet(ada, "ben", his, NEVER)
    if trouble == "ended":
        assert hers.warns.wait(SOON)
        assert "ended on" in hers.sentences[0] and in_language(hers.sentences[0], "de")


@pytest.mark.parametrize(
    ("given", "says"),
    [
        ({}, "Missing TLS private key"),
        (
            {"listen_certificate": "nowhere.pem", "listen_private_key": "nowhere.key"},
            "No such file",
        ),
    ],
    ids=["none", "not there"],
)
def test_who_would_listen_without_a_certificate_does_not_begin(
    post: Post, house: Authority, given: dict[str, str], says: str
) -> None:
    where = (f"tls/127.0.0.1:{port()}",)
    with pytest.raises(UserError, match=says):
        post.joins("ada", listens=where, said=tls(root_ca_certificate=str(house.file), **given))


def test_an_authority_that_is_not_there_is_said(post: Post, tmp_path: Path) -> None:
    nowhere = tmp_path / "nowhere.pem"
    where = (f"tls/127.0.0.1:{port()}",)
    _, box = post.joins("ben", connects=where, said=tls(root_ca_certificate=str(nowhere)))
    assert box.warns.wait(SOON)
    assert f"{nowhere} (root_ca_certificate) cannot be read" in box.sentences[0]
    assert in_language(box.sentences[0], "fr")


def scouting(group: int) -> dict[str, Any]:
    """By multicast on this machine alone, and not where others of this network scout."""
    about = {"address": f"224.0.0.224:{group}", "interface": "127.0.0.1", "ttl": 0}
    return {"scouting": {"multicast": about}}


@pytest.mark.parametrize("finds", [True, False], ids=["looked for", "not looked for"])
def test_they_find_each_other_by_multicast_if_they_look(post: Post, finds: bool) -> None:
    said = scouting(port())
    where = (f"tcp/127.0.0.1:{port()}",)
    ada, _ = post.joins("ada", listens=where, finds=finds, said=said)
    _, box = post.joins("ben", finds=finds, said=said)
    assert meet(ada, "ben", box, SOON if finds else NEVER) == finds


def test_who_encrypts_calls_nobody_without_it_whom_it_finds(post: Post, house: Authority) -> None:
    said = scouting(port())
    ada, _ = post.joins("ada", listens=(f"tcp/127.0.0.1:{port()}",), finds=True, said=said)
    trusts = {**said, **tls(root_ca_certificate=str(house.file))}
    _, box = post.joins("ben", finds=True, said=trusts)
    assert not meet(ada, "ben", box, NEVER)


def test_they_find_each_other_and_encrypt(post: Post, house: Authority) -> None:
    trusts = {**scouting(port()), **tls(root_ca_certificate=str(house.file), **house.gives("ada"))}
    ada, _ = post.joins("ada", listens=(f"tls/127.0.0.1:{port()}",), finds=True, said=trusts)
    _, box = post.joins("ben", finds=True, said=trusts)
    assert meet(ada, "ben", box, SOON)


def test_a_configuration_that_only_speaks_of_tls_opens_no_port(
    post: Post, house: Authority
) -> None:
    """Zenoh by itself would listen for anybody, and look for others, without encryption."""
    trusts = tls(root_ca_certificate=str(house.file))
    ada, _ = post.joins("ada", said=trusts)
    _, box = post.joins("ben", said=trusts)
    assert not meet(ada, "ben", box, NEVER)


@pytest.mark.skipif(shutil.which("openssl") is None, reason="there is no openssl here")
def test_the_commands_of_the_page_make_certificates_that_are_believed(
    post: Post, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page = (Path(__file__).parents[2] / "docs" / "fleet.md").read_text(encoding="utf-8")
    commands, file = (
        page.partition(f"```{kind}\n")[2].partition("```")[0] for kind in ("bash", "json")
    )
    subprocess.run(["bash", "-ec", commands], cwd=tmp_path, check=True, capture_output=True)
    monkeypatch.chdir(tmp_path)
    said, where = json.loads(file), f"tls/127.0.0.1:{port()}"
    trusts = said["transport"]["link"]["tls"]["root_ca_certificate"]
    ada, _ = post.joins("ada", listens=(where,), said=said)
    _, box = post.joins("ben", connects=(where,), said=tls(root_ca_certificate=trusts))
    assert meet(ada, "ben", box, SOON)
    assert box.sentences == []
