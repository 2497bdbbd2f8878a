"""What is wrong with a fleet's certificates, in a sentence: Zenoh tries again and says nothing.

The files that its configuration names are read, and each `tls/HOST:PORT` is called until whoever
answers there is believed, and believes us.
"""

from __future__ import annotations

import json
import re
import socket
import ssl
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final

from robot_api.errors import cause

if TYPE_CHECKING:
    from zenoh import Config

LOOKS_EVERY: Final = 30.0
"""Seconds between two looks."""
ANSWERS_WITHIN: Final = 5.0
"""Seconds that whoever is called has; Zenoh without TLS waits for more, and says nothing."""
_CERTIFICATES: Final = ("root_ca_certificate", "listen_certificate", "connect_certificate")


class Inspection:
    """Looks at the certificates while the fleet goes on; `warn` is told each trouble once, in a
    thread of its own."""

    def __init__(
        self, tls: Mapping[str, Any], endpoints: Sequence[str], warn: Callable[[str], None]
    ) -> None:
        """`tls` is `transport/link/tls` of Zenoh's configuration."""
        self._tls = tls
        whole = (re.split("[?#]", each)[0] for each in endpoints)  # without options of Zenoh's
        self._calls = {each for each in whole if each.startswith("tls/")}
        self._warn = warn
        self._told: set[str] = set()
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._look, name="fleet tls", daemon=True)

    def begin(self) -> None:
        if self._calls or any(self._tls.get(each) for each in _CERTIFICATES):
            self._thread.start()

    def end(self) -> None:
        self._over.set()

    def _look(self) -> None:
        while not self._over.is_set():
            for sentence in (*ended(self._tls, datetime.now(UTC)), *self._called()):
                if sentence not in self._told and not self._over.is_set():
                    self._told.add(sentence)
                    self._warn(sentence)
            self._over.wait(LOOKS_EVERY)

    def _called(self) -> Iterator[str]:
        for each in sorted(self._calls):
            try:
                called(each, self._tls)
            except ssl.SSLError as error:
                yield _told(each, error)
            except (OSError, ValueError):  # away, or files or a port that are told of elsewhere
                continue
            else:
                self._calls.discard(each)


def ended(tls: Mapping[str, Any], now: datetime) -> Iterator[str]:
    """What is wrong with the files themselves."""
    from cryptography import x509

    for option in _CERTIFICATES:
        file = tls.get(option)
        if not file:
            continue
        try:
            found = x509.load_pem_x509_certificates(Path(file).read_bytes())
        except (OSError, ValueError) as error:
            yield (
                f"The certificate of the fleet in {file} ({option}) cannot be read"
                f" ({cause(error)}). Check the file and its rights."
            )
            continue
        last = min(each.not_valid_after_utc for each in found)
        if last < now:
            yield (
                f"The certificate of the fleet in {file} ended on {last:%Y-%m-%d}. Have a new one"
                " made, and start this robot again."
            )


def called(endpoint: str, tls: Mapping[str, Any]) -> None:
    """Greet whoever answers there as Zenoh would. Raises `ssl.SSLError` if one does not believe the
    other, OSError if nobody answers."""
    host, _, port = endpoint.removeprefix("tls/").rpartition(":")
    host = host.strip("[]")
    context = ssl.create_default_context(cafile=tls.get("root_ca_certificate"))
    context.check_hostname = tls.get("verify_name_on_connect") is not False
    if tls.get("enable_mtls"):
        context.load_cert_chain(tls["connect_certificate"], tls["connect_private_key"])
    with socket.create_connection((host, int(port)), ANSWERS_WITHIN) as plain:
        try:
            greeted = context.wrap_socket(plain, server_hostname=host)
        except TimeoutError as error:
            raise ssl.SSLError("no answer to a greeting") from error
        with greeted, suppress(TimeoutError):  # it waits for us, so it takes our certificate
            greeted.settimeout(1.0)
            greeted.recv(1)


def inspection(config: Config, warn: Callable[[str], None]) -> Inspection:
    """Of what a configuration of Zenoh's says."""
    tls = json.loads(config.get_json("transport/link/tls")) or {}
    said = json.loads(config.get_json("connect/endpoints"))
    each_mode = said.values() if isinstance(said, dict) else [said]
    return Inspection(tls, [each for endpoints in each_mode for each in endpoints], warn)


def _told(endpoint: str, error: ssl.SSLError) -> str:
    if isinstance(error, ssl.SSLCertVerificationError):
        why = error.verify_message.rstrip(".")
        return (
            f"Whoever answers at {endpoint} is not believed ({why}). Look at the certificate there,"
            " and at root_ca_certificate here."
        )
    if "ALERT" in (getattr(error, "reason", None) or "") or isinstance(
        error, ssl.SSLZeroReturnError
    ):
        return (
            f"The robot at {endpoint} does not take this one's certificate, or lacks one. Look at"
            " connect_certificate and enable_mtls in the configuration of Zenoh on both."
        )
    return (
        f"What answers at {endpoint} does not speak TLS. Have it listen at tls/HOST:PORT, or call"
        " it by tcp/HOST:PORT."
    )
