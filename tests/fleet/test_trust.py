"""Whose approval counts: a robot that trusts Ada's station alone begins what was approved there."""

from __future__ import annotations

import stat
from pathlib import Path

import pytest
from msgspec.structs import replace

from nl2robot.cli import main as cli
from nl2robot.errors import ExitStatus, UserError
from nl2robot.fleet.messages import Order
from nl2robot.fleet.trust import KEY, TRUSTED, Station, distrust, trust, trusted
from tests.fleet.conftest import FakeNetwork, FakeRobot, begun, errand

WAY = 'robot.goto("pharmacy")\n'
OTHER = 'robot.say("Nobody approved this.")\n'


@pytest.fixture
def net() -> FakeNetwork:
    return FakeNetwork()


@pytest.fixture
def ada(net: FakeNetwork) -> FakeRobot:
    return net.robot("Ada", methods=("say",))


@pytest.fixture
def ben(net: FakeNetwork, ada: FakeRobot, tmp_path: Path) -> FakeRobot:
    """Trusts Ada's station."""
    ben = net.robot("Ben", folder=tmp_path)
    trust(tmp_path, "Ada", ada.station.public)
    net.goes_on(2.0)
    return ben


def offer(ada: FakeRobot, ben: FakeRobot, what: str = "offer", program: str = WAY) -> Order:
    """As Ada's station signs it for him."""
    order = Order(offer="7", what=what, program=program, by="Nurse Kim")  # type: ignore[arg-type]
    return ada.station.signed(ada.id, ben.id, order)


def test_what_a_trusted_station_approved_is_done(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot
) -> None:
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(3.0)
    assert list(begun(net)) == [("Ben", WAY)]


def test_what_another_station_approved_is_refused_and_it_is_told_why(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot
) -> None:
    cleo = net.robot("Cleo", methods=("say",))
    net.goes_on(2.0)
    cleo.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(3.0)
    assert list(begun(net)) == []
    [kept] = cleo.book.errands()
    assert "does not trust the station" in kept.refused["Ben"]
    ben.hub.dispatcher.add(errand(WAY), net.now)  # at his own station he is approved for himself
    net.goes_on(3.0)
    assert list(begun(net)) == [("Ben", WAY)]


def test_who_trusts_nobody_by_name_takes_what_the_key_says(
    net: FakeNetwork, ada: FakeRobot, tmp_path: Path
) -> None:
    net.robot("Ben", folder=tmp_path)
    net.goes_on(2.0)
    ada.hub.dispatcher.add(errand(WAY), net.now)
    net.goes_on(3.0)
    assert list(begun(net)) == [("Ben", WAY)]


@pytest.mark.parametrize(
    "change",
    [
        {"program": OTHER},
        {"by": "Doctor Lee"},
        {"offer": "8"},
        {"reviewed": "all is well"},
        {"signature": b""},
        {"station": Station(None).public},
        {"station": "é" * 43},
    ],
    ids=lambda change: next(iter(change)),
)
def test_what_was_changed_after_it_was_signed_is_refused(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot, change: dict[str, str]
) -> None:
    """By whoever has the fleet's key."""
    changed = replace(offer(ada, ben), **change)
    assert ben.answers(ada.id, changed).stand == "refused"
    assert ben.answers(ada.id, offer(ada, ben)).stand == "accepted"
    begins = replace(offer(ada, ben, "go"), **{**change, "offer": "7"})
    if "offer" in change:
        begins = replace(begins, what="go", signature=offer(ada, ben).signature)
    assert ben.answers(ada.id, begins).stand == "accepted"  # nobody told him to begin
    assert list(begun(net)) == []
    assert ben.answers(ada.id, offer(ada, ben, "go")).stand == "begun"
    assert list(begun(net)) == [("Ben", WAY)]


def test_what_was_signed_for_another_robot_or_from_another_is_refused(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot
) -> None:
    cleo = net.robot("Cleo")
    assert ben.answers(ada.id, offer(ada, cleo)).stand == "refused"
    assert ben.answers(cleo.id, offer(ada, ben)).stand == "refused"


def test_what_is_played_again_is_not_begun_again(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot
) -> None:
    for what in ("offer", "go", "offer", "go"):
        ben.answers(ada.id, offer(ada, ben, what))
    ben.starts()
    for what in ("offer", "go"):
        ben.answers(ada.id, offer(ada, ben, what))
    assert list(begun(net)) == [("Ben", WAY)]


def test_who_is_not_trusted_any_more_before_it_begins_begins_nothing(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot, tmp_path: Path
) -> None:
    ben.answers(ada.id, offer(ada, ben))
    distrust(tmp_path, "Ada")
    assert ben.answers(ada.id, offer(ada, ben, "go")).stand == "accepted"
    net.now += 30.0
    assert ben.answers(ada.id, offer(ada, ben, "go")).stand == "expired"
    assert list(begun(net)) == []


def test_a_list_that_cannot_be_read_has_nobody_trusted(
    net: FakeNetwork, ada: FakeRobot, ben: FakeRobot, tmp_path: Path
) -> None:
    (tmp_path / TRUSTED).write_text(f"{ada.station.public} Ada\nnonsense\n", encoding="utf-8")
    answer = ben.answers(ada.id, offer(ada, ben))
    assert answer.stand == "refused" and "Line 2 of the list" in (answer.why or "")
    with pytest.raises(UserError, match="Line 2"):
        trust(tmp_path, "Cleo", ada.station.public)
    (tmp_path / TRUSTED).write_bytes(b"\xff\xfe")
    assert "cannot be read" in (ben.answers(ada.id, offer(ada, ben)).why or "")


def test_a_station_keeps_its_key_for_itself(tmp_path: Path) -> None:
    assert Station(tmp_path).public == Station(tmp_path).public
    file = tmp_path / KEY
    assert stat.S_IMODE(file.stat().st_mode) == 0o600
    file.chmod(0o644)
    with pytest.raises(UserError, match="can be read by others"):
        Station(tmp_path)
    file.chmod(0o600)
    file.write_bytes(b"short")
    with pytest.raises(UserError, match="cannot be used"):
        Station(tmp_path)


def test_stations_are_trusted_and_not_any_more_by_a_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("NL2ROBOT_HOME", str(tmp_path))
    assert cli.main(["fleet", "trust"]) == ExitStatus.OK
    said = capsys.readouterr().out
    assert Station(tmp_path).public in said and "any station of the fleet" in said
    key = Station(None).public
    assert cli.main(["fleet", "trust", "Ward 3", "--station", key, "--lang", "de"]) == ExitStatus.OK
    assert f"{key} Ward 3" in capsys.readouterr().out
    assert trusted(tmp_path) == {key: "Ward 3"}
    assert cli.main(["fleet", "trust", "Ward 4", "--station", "short"]) == ExitStatus.BAD_INPUT
    assert cli.main(["fleet", "distrust", "Ward 4"]) == ExitStatus.BAD_INPUT
    assert "No station “Ward 4” is trusted here" in capsys.readouterr().err
    assert cli.main(["fleet", "distrust", "Ward 3"]) == ExitStatus.OK
    assert trusted(tmp_path) == {}  # from now on its own station alone
