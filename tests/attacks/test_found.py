"""What attacks have found, and is borne since."""

from __future__ import annotations

import io
import random
import warnings
from pathlib import Path

import numpy as np
import pytest
import soundfile

from nl2robot.errors import UserError
from nl2robot.knowledge import Knowledge
from nl2robot.speech.audio import read_bytes
from nl2robot.station.accounts import Accounts
from nl2robot.translate.talk import Talk
from nl2robot.translate.translation import translate
from robot_api import protocol
from robot_api.errors import InvalidCall
from robot_api.schema import is_oversize, read_arguments
from robot_api.stub import stub
from sandbox.check import check
from sim.world.loading import load_world
from sim.world.map_image import ImageError, image_size
from sim.world.model import WorldError
from tests.attacks.outcome import what_is_no_sentence


@pytest.mark.parametrize("method", ["robot.stop", "robot.fly", "rpc.cancel"])
def test_half_a_sign_in_an_id_is_refused_and_ends_no_connection(method: str) -> None:
    """It could not be written into the reply, and the error of that went up to the loop."""
    wire = protocol.Connection({}, [])
    [answer] = wire.receive(f'{{"jsonrpc": "2.0", "id": "a\\ud800", "method": "{method}"}}')
    assert isinstance(answer, protocol.Send) and '"id":null' in answer.frame


def test_what_is_refused_is_not_listed_without_end() -> None:
    with pytest.raises(InvalidCall) as refused:
        read_arguments("location", [0] * 900)
    assert str(refused.value).endswith("0 and 890 more.") and len(str(refused.value)) < 100


def test_names_of_what_is_refused_are_cut_short() -> None:
    with pytest.raises(InvalidCall) as refused:
        read_arguments("do", named={"a" * 70_000: 1})
    assert len(str(refused.value)) < 200


@pytest.mark.parametrize("number", [10**400, -(10**400), 2**63])
def test_a_number_that_nothing_can_take_is_refused_before_it_is_used(number: int) -> None:
    assert is_oversize({"properties": {"x": {"type": "number"}}}, {"x": number})
    with pytest.raises(InvalidCall):
        read_arguments("wait", [number])


def test_a_word_without_end_costs_nothing() -> None:
    """Of 70,000 letters, each way of swapping two of them was kept: 5 GB."""
    word = "".join(random.Random(1).choices("abcdefghij", k=250_000))
    for language in ("en", "de", "fr"):
        told = translate(f"tell me {word}", Knowledge(load_world("ward")), language, "grammar")
        assert told.status == "rejected" and what_is_no_sentence(told.message) is None
        assert told.ms < 5_000


def test_a_sign_that_only_belongs_over_another_is_no_word() -> None:
    told = translate("dmande à Bob sil e\u0323", Knowledge(load_world("ward")), "fr", "grammar")
    assert told.program is not None or what_is_no_sentence(told.message) is None


def test_a_correction_of_a_correction_of_a_correction_is_refused() -> None:
    again = "nee, bring den leeren Karton ins Lager."
    said = f"Bring den Müll... ach {again * 5}"
    told = translate(said, Knowledge(load_world("ward")), "de", "grammar")
    assert told.program is not None or what_is_no_sentence(told.message) is None


@pytest.mark.parametrize(
    "said",
    [
        "{}",
        "wait {} seconds",
        "say hello {} times",
        "move {} metres",
        "count to {}",
        "set it to {}",
    ],
)
def test_a_number_beyond_all_numbers_is_refused(said: str) -> None:
    told = translate(said.format("9" * 400), Knowledge(load_world("ward")), "en", "grammar")
    assert told.program is not None or what_is_no_sentence(told.message) is None


def test_of_many_corrections_not_all_ways_are_tried() -> None:
    """It took a minute and a half, and four times as long with each two more."""
    said = "bring the cup to Bob" + ", no, zorple the red one" * 8
    told = translate(said, Knowledge(load_world("city-hospital")), "en", "grammar")
    assert told.status == "rejected" and told.ms < 20_000


def test_a_row_of_numbers_is_not_read_in_all_the_ways_there_are() -> None:
    """It took seven seconds, and twice as long with each number more."""
    knowledge, talk = Knowledge(load_world("city-hospital")), Talk()
    assert translate("chase persons", knowledge, "en", "grammar", talk).program is not None
    told = translate("é'8611é'2d4!04?522i" + "'2d" * 20, knowledge, "en", "grammar", talk)
    assert told.ms < 5_000


@pytest.mark.parametrize("sample", [1e30, 3e38, float("inf"), float("nan")])
def test_enormous_samples_are_only_loud(sample: float) -> None:
    file = io.BytesIO()
    loud = np.full(800, sample, np.float32)
    soundfile.write(file, loud, 8_000, format="WAV", subtype="FLOAT")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_bytes(file.getvalue(), "the siren.wav")


def test_an_image_of_too_many_pixels_is_refused_and_no_warning_is_printed(tmp_path: Path) -> None:
    head = b"BM\xb6\x04" + b"\0" * 6 + b"6\0\0\0(\0\0\0" + b"\x18\0d\0\x10\0\0\0\x01\0\x18"
    (tmp_path / "floor.bmp").write_bytes(head + b"\0" * 40)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(ImageError, match="too large"):
            image_size(tmp_path / "floor.bmp")


def test_a_device_whose_number_is_too_large_is_none(tmp_path: Path) -> None:
    with pytest.raises(UserError, match="There is no device"):
        Accounts(tmp_path / "accounts.sqlite").withdraw(2**63)


def test_what_the_check_calls_a_type_is_told_in_words() -> None:
    [finding] = check("x = robot.objects() > list[str]\n", stub())
    assert "between a list and a type" in finding.message and "<class" not in finding.message


@pytest.mark.parametrize("program", ["~int", "-str", "robot.battery() -~ int", "not -[1]"])
def test_what_a_sign_does_not_fit_is_told_in_words(program: str) -> None:
    for finding in check(program, stub()):
        assert what_is_no_sentence(finding.message) is None, finding.message


@pytest.mark.parametrize("text", ["name: x\nplaces: &a [*a]\n", "name: x\nzones: [&a {b: [*a]}]\n"])
def test_what_is_a_part_of_itself_is_refused_with_its_line(tmp_path: Path, text: str) -> None:
    file = tmp_path / "world.yaml"
    file.write_text(text, encoding="utf-8")
    with pytest.raises(WorldError, match="without end") as refused:
        load_world(file)
    assert ":2:" in str(refused.value)
