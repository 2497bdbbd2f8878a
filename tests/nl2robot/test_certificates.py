"""The certificate of a robot in a hospital: made, renewed, trusted by clients, and by no others."""

from __future__ import annotations

import ipaddress
import socket
import ssl
import stat
import subprocess
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import pytest
from cryptography import x509
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.hazmat.primitives.serialization import Encoding, load_pem_private_key

from nl2robot.errors import ExitStatus, UserError
from nl2robot.station.certificates import CERTIFICATE_LASTS, LocalCertificate, given
from robot_api.client import Robot
from robot_api.drivers import emulated
from robot_api.errors import AccessDenied, InvalidCall, LostConnection, NotTrusted
from robot_api.server import Server


class Ward:
    """A machine that is moved from network to network, and grows old."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.names = ["robin", "robin.local", "localhost"]
        self.addresses = ["127.0.0.1", "10.1.2.3"]
        self.now = datetime(2026, 11, 26, tzinfo=UTC)

    def certificate(self) -> LocalCertificate:
        return LocalCertificate(
            self.folder,
            names=lambda: self.names,
            addresses=lambda: [ipaddress.ip_address(each) for each in self.addresses],
            now=lambda: self.now,
        )

    def shown(self) -> x509.Certificate:
        return x509.load_pem_x509_certificate((self.folder / "server.crt").read_bytes())

    def names_shown(self) -> set[str]:
        said = self.shown().extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        return {str(each.value) for each in said}


@pytest.fixture
def ward(tmp_path: Path) -> Ward:
    return Ward(tmp_path / "certificates")


def test_it_names_all_that_the_machine_is_called_and_only_its_owner_reads_the_keys(
    ward: Ward,
) -> None:
    ward.certificate()
    assert ward.names_shown() == {*ward.names, *ward.addresses}
    assert stat.S_IMODE(ward.folder.stat().st_mode) == 0o700
    for key in ("authority.key", "server.key"):
        assert stat.S_IMODE((ward.folder / key).stat().st_mode) == 0o600
    lasts = ward.shown().not_valid_after_utc - ward.shown().not_valid_before_utc
    assert lasts <= timedelta(days=398), "Apple's devices trust none that lasts longer"


def test_it_stays_the_same_until_it_is_about_to_end(ward: Ward) -> None:
    first = ward.certificate()
    serial = ward.shown().serial_number
    ward.now += CERTIFICATE_LASTS - timedelta(days=31)
    ward.certificate()
    assert ward.shown().serial_number == serial
    ward.now += timedelta(days=2)
    first.renew()
    assert ward.shown().serial_number != serial, "a server that runs on renews it as well"
    assert first.fingerprint == ward.certificate().fingerprint, "the authority stays"


def test_another_address_is_certified_by_the_same_authority(ward: Ward) -> None:
    certificate = ward.certificate()
    before = certificate.fingerprint
    ward.addresses = ["127.0.0.1", "10.9.9.9", "fd00::7"]
    certificate.renew()
    assert ward.names_shown() >= {"10.9.9.9", "fd00::7"}
    assert certificate.fingerprint == before
    ward.addresses += ["2001:db8:1::1"]  # comes and goes by itself
    certificate.renew()
    assert certificate.fingerprint == before
    assert "2001:db8:1::1" not in ward.names_shown()


def test_a_public_address_or_another_name_takes_another_authority(ward: Ward) -> None:
    before = ward.certificate().fingerprint
    ward.addresses = ["127.0.0.1", "203.0.113.7"]
    after = ward.certificate().fingerprint
    assert after != before and "203.0.113.7" in ward.names_shown()
    ward.names = ["robin.hospital.example"]
    assert ward.certificate().fingerprint != after


def test_names_that_only_others_have_for_it_are_given(ward: Ward) -> None:
    """A container knows neither its host's name nor its address."""
    LocalCertificate(ward.folder, more=["Robin.Hospital.example", "10.20.30.40", "[fd00::9]"])
    assert {"robin.hospital.example", "10.20.30.40", "fd00::9"} <= ward.names_shown()
    with pytest.raises(UserError, match="no name or address of a computer"):
        LocalCertificate(ward.folder, more=["https://robin"])


def test_whoever_steals_the_authority_cannot_pretend_to_be_a_bank(
    ward: Ward, tmp_path: Path
) -> None:
    ward.certificate()
    authority = x509.load_pem_x509_certificate((ward.folder / "authority.crt").read_bytes())
    key = load_pem_private_key((ward.folder / "authority.key").read_bytes(), None)
    thief = Ward(ward.folder)
    forged = thief.certificate()
    assert isinstance(key, ec.EllipticCurvePrivateKey)
    forged._issue(authority, key, ["bank.example"], [])
    verify = ["openssl", "verify", "-CAfile", "authority.crt", "server.crt"]
    done = subprocess.run(verify, cwd=ward.folder, capture_output=True, text=True)
    assert done.returncode != 0 and "permitted subtree violation" in done.stderr + done.stdout


def test_a_half_written_authority_is_made_anew(ward: Ward) -> None:
    before = ward.certificate().fingerprint
    (ward.folder / "authority.key").write_bytes(b"-----BEGIN PRIV")
    assert ward.certificate().fingerprint != before


# --- one of the hospital's -----------------------------------------------------------------------


def test_one_of_the_hospitals_is_taken_and_what_is_wrong_with_it_is_said(
    ward: Ward, tmp_path: Path
) -> None:
    ward.now = datetime.now(UTC)
    ward.certificate()
    chain, key = ward.folder / "server.crt", ward.folder / "server.key"
    assert given(chain, key).authority_file is None
    nonsense = tmp_path / "letter.txt"
    nonsense.write_text("Dear colleagues")
    for wrong, sentence in (
        ((tmp_path / "none.crt", key), r"There is no file .*none.crt"),
        ((nonsense, key), "are no certificate and its key"),
        ((chain, nonsense), "are no certificate and its key"),
        ((chain, ward.folder / "authority.key"), "do not belong together"),
    ):
        with pytest.raises(UserError, match=sentence):
            given(*wrong)
    ward.now = datetime.now(UTC) - timedelta(days=800)
    (ward.folder / "server.crt").unlink()
    ward.certificate()
    with pytest.raises(UserError, match="ended on"):
        given(chain, key)


def test_a_certificate_without_its_key_is_a_mistake(nl2robot) -> None:  # type: ignore[no-untyped-def]
    status, _, err = nl2robot("serve", "--certificate", "robot.crt")
    assert status == ExitStatus.BAD_INPUT
    assert "give --certificate and --key" in err


# --- a server and its clients --------------------------------------------------------------------


@pytest.fixture
def robot(ward: Ward) -> Iterator[tuple[Server, str]]:
    """An encrypted robot, and the port it is at."""
    ward.now = datetime.now(UTC)
    context = ward.certificate().context
    driver = emulated()
    with Server(driver, host="0.0.0.0", port=0, token="sesame", encryption=context) as server:
        yield server, server.address.rpartition(":")[2]
    driver.close()


def test_a_client_that_trusts_the_authority_drives_the_robot(ward: Ward, robot: Any) -> None:
    _, port = robot
    for host in ("127.0.0.1", "localhost"):
        with Robot(
            f"wss://{host}:{port}", token="sesame", ca=ward.folder / "authority.crt"
        ) as client:
            assert client.battery() == 100
    with pytest.raises(AccessDenied, match="token is missing or wrong"):
        Robot(f"wss://127.0.0.1:{port}", ca=ward.folder / "authority.crt")


def test_a_certificate_of_nobodys_is_refused_with_a_sentence(
    ward: Ward, robot: Any, tmp_path: Path
) -> None:
    _, port = robot
    with pytest.raises(NotTrusted, match=r"is not to be trusted .* with --ca"):
        Robot(f"wss://127.0.0.1:{port}", token="sesame")
    other = Ward(tmp_path / "other")
    other.certificate()
    with pytest.raises(NotTrusted):
        Robot(f"wss://127.0.0.1:{port}", token="sesame", ca=other.folder / "authority.crt")
    with pytest.raises(InvalidCall, match="is no file with an authority's certificate"):
        Robot(f"wss://127.0.0.1:{port}", token="sesame", ca=ward.folder / "server.key")


def test_programs_on_the_robots_own_computer_need_no_certificate(robot: Any) -> None:
    _, port = robot
    with Robot(f"127.0.0.1:{port}", token="sesame") as client:
        assert client.battery() == 100


def test_a_renewed_certificate_is_shown_to_who_comes_next(ward: Ward, tmp_path: Path) -> None:
    ward.now = datetime.now(UTC)
    certificate = ward.certificate()
    driver = emulated()
    with Server(driver, host="0.0.0.0", port=0, encryption=certificate.context) as server:
        port = int(server.address.rpartition(":")[2])
        before = ssl.get_server_certificate(("127.0.0.1", port))
        ward.addresses.append("10.7.7.7")
        certificate.renew()
        after = ssl.get_server_certificate(("127.0.0.1", port))
    driver.close()
    assert before != after == ward.shown().public_bytes(Encoding.PEM).decode()


def test_who_says_nothing_or_nonsense_keeps_nobody_out(ward: Ward, robot: Any) -> None:
    _, port = robot
    silent = [socket.create_connection(("127.0.0.1", int(port))) for _ in range(250)]
    try:
        for each in silent[:20]:
            each.sendall(b"\x16\x03\x01 this is no handshake, whatever it begins with")
        for each in silent[20:40]:
            each.close()
        with Robot(
            f"wss://127.0.0.1:{port}", token="sesame", ca=ward.folder / "authority.crt"
        ) as client:
            assert client.battery() == 100
    finally:
        for each in silent:
            each.close()


def test_a_robot_without_encryption_is_said_to_be_none(ward: Ward) -> None:
    driver = emulated()
    with Server(driver, port=0) as server, pytest.raises(LostConnection):
        Robot(f"wss://{server.address}", ca=None)
    driver.close()
