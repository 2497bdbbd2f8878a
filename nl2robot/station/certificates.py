"""The certificate by which a server's pages are encrypted: of an authority of its own, or given.

Browsers give microphones and cameras only to pages that came encrypted. So a server that answers
others makes, at its first start, a local authority whose key never leaves the data folder, and lets
it certify every name and address that this machine has. A tablet that trusts the authority
(`/trust`) trusts the robot, also after its certificate was renewed.

The authority can certify names and addresses of local networks and of this machine only, so that
whoever steals its key cannot pretend to be anybody else to those tablets.
"""

from __future__ import annotations

import contextlib
import ipaddress
import os
import socket
import ssl
import threading
from collections.abc import Callable, Iterator, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Final

import ifaddr
from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import ExtendedKeyUsageOID, NameOID

from nl2robot.errors import UserError
from nl2robot.paths import made

Address = ipaddress.IPv4Address | ipaddress.IPv6Address
Network = ipaddress.IPv4Network | ipaddress.IPv6Network

AUTHORITY_LASTS: Final = timedelta(days=3650)
CERTIFICATE_LASTS: Final = timedelta(days=390)
"""Apple's devices take none that lasts longer than 398 days."""
RENEWED_BEFORE: Final = timedelta(days=30)
SLOW_CLOCKS: Final = timedelta(days=2)
"""A tablet whose clock is slow by this much trusts a new certificate all the same."""
LOOKED_AFTER_EVERY: Final = 600.0
"""Seconds."""
LOCAL: Final[tuple[Network, ...]] = tuple(
    ipaddress.ip_network(net)
    for net in (
        *("10.0.0.0/8", "172.16.0.0/12", "192.168.0.0/16", "169.254.0.0/16", "127.0.0.0/8"),
        *("100.64.0.0/10", "fc00::/7", "fe80::/10", "::1/128"),
    )
)
LOCAL_NAMES: Final = ("localhost", "local", "lan", "internal", "home.arpa")


def names_here() -> list[str]:
    """The names of this machine, in lower case."""
    own = socket.gethostname().lower().rstrip(".")
    names = [own, f"{own}.local"] if "." not in own else [own]
    return [*dict.fromkeys(name for name in names if _is_name(name)), "localhost"]


def addresses_here() -> list[Address]:
    """The addresses of this machine in all its networks."""
    found = {
        ipaddress.ip_address(each.ip if isinstance(each.ip, str) else each.ip[0])
        for adapter in ifaddr.get_adapters()
        for each in adapter.ips
    }
    found |= {ipaddress.ip_address("127.0.0.1"), ipaddress.ip_address("::1")}
    return sorted(found, key=lambda each: (each.version, int(each)))


class Certificate:
    """What a server shows who wants to speak encrypted with it."""

    def __init__(self, chain: Path, key: Path) -> None:
        self.context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        """Goes on to be the same when the certificate is renewed."""
        self.context.minimum_version = ssl.TLSVersion.TLSv1_2
        self.context.set_alpn_protocols(["http/1.1"])
        self._chain = chain
        self._key = key
        self._loaded: object = None

    @property
    def authority_file(self) -> Path | None:
        """The certificate (PEM) of the local authority, if it is one of that."""
        return None

    @property
    def fingerprint(self) -> str | None:
        """By which people compare that with what a screen shows: SHA-256, in pairs."""
        return None

    def renew(self) -> None:
        """Take a newer certificate, where there is one or it is time for one. Raises
        `UserError`."""
        with _told(self._chain, self._key):
            stamp = [file.stat().st_mtime_ns for file in (self._chain, self._key)]
            if stamp == self._loaded:
                return
            # Without a password: nobody may be there whom OpenSSL could ask.
            self.context.load_cert_chain(self._chain, self._key, password=_no_password)
            self._loaded = stamp


def given(chain: Path, key: Path) -> Certificate:
    """One that the hospital has. Raises `UserError`."""
    certificate = Certificate(chain, key)
    certificate.renew()
    with _told(chain, key):
        first = x509.load_pem_x509_certificates(chain.read_bytes())[0]
    if first.not_valid_after_utc < datetime.now(UTC):
        raise UserError(
            f"The certificate {chain} ended on {first.not_valid_after_utc:%Y-%m-%d}."
            " Ask for a new one."
        )
    return certificate


class LocalCertificate(Certificate):
    """One of an authority of this machine's own, in `folder`. `more` are names and addresses that
    others have for it. Raises `UserError`."""

    def __init__(
        self,
        folder: Path,
        *,
        more: Sequence[str] = (),
        names: Callable[[], Sequence[str]] = names_here,
        addresses: Callable[[], Sequence[Address]] = addresses_here,
        now: Callable[[], datetime] = lambda: datetime.now(UTC),
    ) -> None:
        super().__init__(folder / "server.crt", folder / "server.key")
        self._folder = made(folder)
        self._more = [each.strip("[]").lower() for each in more]
        self._names = names
        self._addresses = addresses
        self._now = now
        folder.chmod(0o700)
        self.renew()

    @property
    def authority_file(self) -> Path | None:
        return self._file("authority.crt")

    @property
    def fingerprint(self) -> str | None:
        return fingerprint_of(self._file("authority.crt"))

    def renew(self) -> None:
        """Make the certificate anew if it is about to end, or this machine has another address."""
        names, addresses = list(self._names()), list(self._addresses())
        for each in self._more:
            address = _address(each)
            if address is not None:
                addresses.append(address)
            elif _is_name(each):
                names.append(each)
            else:
                raise UserError(f"{each!r} is no name or address of a computer. Correct --name.")
        authority, key = self._kept_authority()
        if authority is None or key is None or not self._serves(authority, names, addresses):
            authority, key = self._new_authority(names, addresses)
        addresses = [each for each in addresses if _allows(authority, each)]
        if not self._holds(authority, names, addresses):
            self._issue(authority, key, names, addresses)
        super().renew()

    def _kept_authority(self) -> tuple[x509.Certificate | None, ec.EllipticCurvePrivateKey | None]:
        try:
            certificate = x509.load_pem_x509_certificate(self._file("authority.crt").read_bytes())
            key = serialization.load_pem_private_key(
                self._file("authority.key").read_bytes(), password=None
            )
        except (OSError, ValueError, TypeError):  # not there, or half of it
            return None, None
        return certificate, key if isinstance(key, ec.EllipticCurvePrivateKey) else None

    def _serves(
        self, authority: x509.Certificate, names: Sequence[str], addresses: Sequence[Address]
    ) -> bool:
        """Whether the authority lasts, and may certify this machine. Addresses of IPv6 come and go:
        for one alone, no tablet shall have to trust another authority."""
        if authority.not_valid_after_utc - self._now() < CERTIFICATE_LASTS:
            return False
        allowed = [each for each in _allowed(authority) if isinstance(each, str)]
        return all(
            any(name == each or name.endswith(f".{each}") for each in allowed) for name in names
        ) and all(_allows(authority, each) for each in addresses if each.version == 4)

    def _new_authority(
        self, names: Sequence[str], addresses: Sequence[Address]
    ) -> tuple[x509.Certificate, ec.EllipticCurvePrivateKey]:
        key = ec.generate_private_key(ec.SECP256R1())
        now = self._now()
        # The name tells authorities apart in a tablet's list, also those of one machine.
        title = f"Robot {names[0]}, {now:%Y-%m-%d}"[:64]
        own = [_around(each) for each in addresses if not any(_in(each, net) for net in LOCAL)]
        allowed: list[x509.GeneralName] = [
            *(x509.DNSName(name) for name in dict.fromkeys((*names, *LOCAL_NAMES))),
            *(x509.IPAddress(net) for net in (*LOCAL, *own)),
        ]
        public = key.public_key()
        certificate = (
            _begun(title, title, public, now, AUTHORITY_LASTS)
            .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
            .add_extension(_usage(key_cert_sign=True, crl_sign=True), critical=True)
            .add_extension(x509.NameConstraints(allowed, None), critical=True)
            .add_extension(x509.SubjectKeyIdentifier.from_public_key(public), critical=False)
            .sign(key, hashes.SHA256())
        )
        self._write("authority.key", _pem(key))
        self._write("authority.crt", certificate.public_bytes(serialization.Encoding.PEM), 0o644)
        return certificate, key

    def _holds(
        self, authority: x509.Certificate, names: Sequence[str], addresses: Sequence[Address]
    ) -> bool:
        """Whether the certificate that there is will do."""
        try:
            kept = x509.load_pem_x509_certificate(self._chain.read_bytes())
            kept.verify_directly_issued_by(authority)
            said = kept.extensions.get_extension_for_class(x509.SubjectAlternativeName).value
        except Exception:  # noqa: BLE001 - whatever is the matter with it, a new one is made
            return False
        if not self._key.exists() or kept.not_valid_after_utc - self._now() < RENEWED_BEFORE:
            return False
        return set(names) <= set(said.get_values_for_type(x509.DNSName)) and set(addresses) <= set(
            said.get_values_for_type(x509.IPAddress)
        )

    def _issue(
        self,
        authority: x509.Certificate,
        key: ec.EllipticCurvePrivateKey,
        names: Sequence[str],
        addresses: Sequence[Address],
    ) -> None:
        own = ec.generate_private_key(ec.SECP256R1())
        said = [
            *(x509.DNSName(name) for name in names),
            *(x509.IPAddress(each) for each in addresses),
        ]
        title = authority.subject.get_attributes_for_oid(NameOID.COMMON_NAME)[0].value
        certificate = (
            _begun(names[0][:64], str(title), own.public_key(), self._now(), CERTIFICATE_LASTS)
            .add_extension(x509.SubjectAlternativeName(said), critical=False)
            .add_extension(x509.BasicConstraints(ca=False, path_length=None), critical=True)
            .add_extension(_usage(digital_signature=True), critical=True)
            .add_extension(x509.ExtendedKeyUsage([ExtendedKeyUsageOID.SERVER_AUTH]), critical=False)
            .add_extension(
                x509.AuthorityKeyIdentifier.from_issuer_public_key(key.public_key()), critical=False
            )
            .sign(key, hashes.SHA256())
        )
        self._write("server.key", _pem(own))
        self._write("server.crt", certificate.public_bytes(serialization.Encoding.PEM), 0o644)

    def _file(self, name: str) -> Path:
        return self._folder / name

    def _write(self, name: str, content: bytes, mode: int = 0o600) -> None:
        """As a whole or not at all, and for nobody else's eyes from the beginning."""
        new = self._file(f"{name}.new")
        with _told(new):
            new.unlink(missing_ok=True)
            with os.fdopen(os.open(new, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
                file.write(content)
            new.replace(self._file(name))


def fingerprint_of(authority: Path) -> str:
    """Of an authority's certificate. Raises `UserError`."""
    with _told(authority):
        certificate = x509.load_pem_x509_certificate(authority.read_bytes())
    return certificate.fingerprint(hashes.SHA256()).hex(":").upper()


@contextlib.contextmanager
def looked_after(
    certificate: Certificate, on_trouble: Callable[[str], None]
) -> Iterator[Certificate]:
    """Renew it while the server runs; whatever stands in the way is told as a sentence."""
    over = threading.Event()

    def look() -> None:
        while not over.wait(LOOKED_AFTER_EVERY):
            try:
                certificate.renew()
            except UserError as error:
                on_trouble(str(error))

    threading.Thread(target=look, name="certificate", daemon=True).start()
    try:
        yield certificate
    finally:
        over.set()


def _begun(
    subject: str, issuer: str, key: ec.EllipticCurvePublicKey, now: datetime, lasts: timedelta
) -> x509.CertificateBuilder:
    return (
        x509.CertificateBuilder()
        .subject_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, subject)]))
        .issuer_name(x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, issuer)]))
        .public_key(key)
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - SLOW_CLOCKS)
        .not_valid_after(now + lasts)
    )


def _usage(
    *, digital_signature: bool = False, key_cert_sign: bool = False, crl_sign: bool = False
) -> x509.KeyUsage:
    return x509.KeyUsage(
        digital_signature=digital_signature,
        content_commitment=False,
        key_encipherment=False,
        data_encipherment=False,
        key_agreement=False,
        key_cert_sign=key_cert_sign,
        crl_sign=crl_sign,
        encipher_only=False,
        decipher_only=False,
    )


def _pem(key: ec.EllipticCurvePrivateKey) -> bytes:
    return key.private_bytes(
        serialization.Encoding.PEM,
        serialization.PrivateFormat.PKCS8,
        serialization.NoEncryption(),
    )


def _address(text: str) -> Address | None:
    try:
        return ipaddress.ip_address(text)
    except ValueError:
        return None


def _is_name(name: str) -> bool:
    """Whether a certificate can hold it: host names are plain ASCII."""
    return name.isascii() and all(part.replace("-", "").isalnum() for part in name.split("."))


def _around(address: Address) -> Network:
    """The address, of IPv6 with those beside it: machines there change theirs by themselves."""
    return ipaddress.ip_network((address, 32 if address.version == 4 else 64), strict=False)


def _in(address: Address, net: Network) -> bool:
    return address.version == net.version and address in net


def _allowed(authority: x509.Certificate) -> list[str | Network]:
    """The names and networks that an authority can certify."""
    limits = authority.extensions.get_extension_for_class(x509.NameConstraints).value
    return [each.value for each in limits.permitted_subtrees or ()]


def _allows(authority: x509.Certificate, address: Address) -> bool:
    return any(not isinstance(net, str) and _in(address, net) for net in _allowed(authority))


def _no_password() -> str:
    return ""


@contextlib.contextmanager
def _told(*files: Path) -> Iterator[None]:
    """What is wrong with a certificate or its key, as a sentence."""
    which = " and ".join(map(str, files))
    try:
        yield
    except FileNotFoundError as error:
        raise UserError(f"There is no file {error.filename or which}. Check its name.") from None
    except ssl.SSLError as error:
        if error.reason == "KEY_VALUES_MISMATCH":
            sentence = f"The certificate and the key in {which} do not belong together."
        else:
            sentence = f"{which} are no certificate and its key, in PEM, without a password."
        raise UserError(f"{sentence} Ask who gave them to you.") from None
    except ValueError:
        raise UserError(
            f"{which} are no certificate and its key, in PEM. Ask who gave them."
        ) from None
    except OSError as error:
        raise UserError(
            f"{error.filename or which} cannot be used ({error.strerror}). Check its rights."
        ) from None
