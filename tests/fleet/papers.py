"""An authority of a ward and the certificates that it gives, made on the spot."""

from __future__ import annotations

import ipaddress
from datetime import UTC, datetime, timedelta
from pathlib import Path

from cryptography import x509
from cryptography.hazmat.primitives import hashes, serialization
from cryptography.hazmat.primitives.asymmetric import ec
from cryptography.x509.oid import NameOID

DAY = timedelta(days=1)


class Authority:
    """Whose certificate is `file`."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder = folder
        self._key = ec.generate_private_key(ec.SECP256R1())
        self._name = _named(name)
        made = _bare(self._name, self._name, self._key, datetime.now(UTC) - DAY, 3650)
        made = made.add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        self.file = _written(folder / f"{name}.pem", made.sign(self._key, hashes.SHA256()))

    def gives(self, name: str, *, ended: bool = False, host: str = "127.0.0.1") -> dict[str, str]:
        """The files of a certificate for a robot at that address, as Zenoh calls them."""
        key = ec.generate_private_key(ec.SECP256R1())
        begins = datetime.now(UTC) - (400 * DAY if ended else DAY)
        made = _bare(_named(name), self._name, key, begins, 365)
        hosts = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address(host))])
        certificate = made.add_extension(hosts, critical=False).sign(self._key, hashes.SHA256())
        file = self._folder / f"{name}.key"
        file.write_bytes(
            key.private_bytes(
                serialization.Encoding.PEM,
                serialization.PrivateFormat.PKCS8,
                serialization.NoEncryption(),
            )
        )
        return {
            "listen_certificate": str(_written(self._folder / f"{name}.pem", certificate)),
            "listen_private_key": str(file),
        }


def _named(name: str) -> x509.Name:
    return x509.Name([x509.NameAttribute(NameOID.COMMON_NAME, name)])


def _bare(
    name: x509.Name,
    issuer: x509.Name,
    key: ec.EllipticCurvePrivateKey,
    begins: datetime,
    days: int,
) -> x509.CertificateBuilder:
    made = x509.CertificateBuilder().subject_name(name).issuer_name(issuer)
    made = made.public_key(key.public_key()).serial_number(x509.random_serial_number())
    return made.not_valid_before(begins).not_valid_after(begins + days * DAY)


def _written(file: Path, certificate: x509.Certificate) -> Path:
    file.write_bytes(certificate.public_bytes(serialization.Encoding.PEM))
    return file
