"""The fleet's network: Zenoh, in a thin shell that knows nothing of what the messages mean.

    nl2robot/FLEET/all/ROBOT            what a robot says to all
    nl2robot/FLEET/to/ROBOT             what is said to one
    nl2robot/FLEET/alive/ROBOT/SESSION  a liveliness token, while that process is reached

FLEET is the fingerprint of the key, so fleets with other keys do not even hear each other. Each
robot passes on what others say (Zenoh's mode "router"), so it is enough that all are connected
somehow; a configuration of one's own may say otherwise.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any, Final

from nl2robot.errors import UserError
from nl2robot.fleet.address import FleetAddress
from nl2robot.fleet.encryption import Inspection, inspection
from robot_api.errors import cause

if TYPE_CHECKING:
    from zenoh import Config, Session

ROOT: Final = "nl2robot"
RETRY: Final = {"period_init_ms": 500, "period_max_ms": 2000, "period_increase_factor": 2}
"""How often somebody who is away is called."""
FINDING: Final = ("scouting/multicast/enabled", "scouting/gossip/enabled")
CALLING: Final = ("scouting/multicast/autoconnect", "scouting/gossip/autoconnect")
CALLED: Final = {each: ["router", "peer"] for each in ("router", "peer", "client")}
"""Whom one calls that was found; by itself, Zenoh's routers call nobody."""
BEFORE: Final[Mapping[str, Any]] = {
    "mode": "router",
    **dict.fromkeys(CALLING, CALLED),
    **dict.fromkeys(FINDING, False),  # nobody is connected to whom nobody has named
    "connect/timeout_ms": -1,  # it is tried for ever, meanwhile
    "connect/exit_on_failure": False,
    "connect/retry": RETRY,
    "listen/endpoints": [],
}
"""What holds unless Zenoh's configuration file says otherwise."""

ENDPOINTS: Final = ("listen/endpoints", "connect/endpoints")
TLS: Final = "transport/link/tls"
ENCRYPTED: Final = ("tls", "quic")


def encrypted(endpoint: str) -> bool:
    return endpoint.partition("/")[0] in ENCRYPTED


class Network:
    """A robot's connection to the others, which comes back by itself.

    `heard(raw, urgent)` and `gone(robot, session)` are called in its threads, which they must not
    keep.
    """

    def __init__(
        self,
        address: FleetAddress,
        fleet: str,
        robot: str,
        session: str,
        heard: Callable[[bytes, bool], None],
        gone: Callable[[str, str], None],
        warn: Callable[[str], None] = lambda sentence: None,
    ) -> None:
        """Nothing happens before `open`. `warn` is told what is wrong with certificates."""
        self._address = address
        self._fleet = f"{ROOT}/{fleet}"
        self._robot = robot
        self._alive = f"{self._fleet}/alive/{robot}/{session}"
        self._heard = heard
        self._gone = gone
        self._warn = warn
        self._inspection: Inspection | None = None
        self._session: Session | None = None
        self._declared: list[Any] = []
        self._strangers: dict[str, str] = {}
        """The tokens of robots with another key, and its fingerprint."""

    def open(self) -> None:
        """Join. Raises `UserError` if that cannot be: no Zenoh, a port that is taken."""
        try:
            import zenoh
        except ImportError as error:
            raise UserError(
                "A fleet needs Zenoh, which is not installed. Install it by"
                " `pip install 'nl2robot[fleet]'`."
            ) from error

        from zenoh import Priority, SampleKind

        def sample(sample: Any) -> None:
            self._heard(sample.payload.to_bytes(), sample.priority == Priority.REAL_TIME)

        def alive(sample: Any) -> None:
            if sample.kind == SampleKind.DELETE:
                *_, robot, session = str(sample.key_expr).split("/")
                self._gone(robot, session)

        def passes(sample: Any) -> None:
            token = str(sample.key_expr)
            if sample.kind == SampleKind.DELETE:
                self._strangers.pop(token, None)
            elif not token.startswith(f"{self._fleet}/"):
                self._strangers[token] = token.split("/")[1]

        try:
            config = self._config(zenoh.Config)
            session = self._session = zenoh.open(config)
            self._declared = [
                session.declare_subscriber(f"{self._fleet}/all/*", sample),
                session.declare_subscriber(f"{self._fleet}/to/{self._robot}", sample),
                session.liveliness().declare_subscriber(f"{self._fleet}/alive/*/*", alive),
                session.liveliness().declare_subscriber(
                    f"{ROOT}/*/alive/*/*", passes, history=True
                ),
                session.liveliness().declare_token(self._alive),
            ]
        except zenoh.ZError as error:
            self.close()
            raise UserError(
                f"The fleet cannot be joined ({_first(error)}). Check --fleet, --fleet-listen and"
                " --fleet-config."
            ) from error
        self._inspection = inspection(config, self._warn)
        self._inspection.begin()

    def close(self) -> None:
        if self._inspection is not None:
            self._inspection.end()
        session, self._session = self._session, None
        self._declared = []
        if session is not None:
            session.close()  # type: ignore[no-untyped-call]

    @property
    def reached(self) -> bool:
        """Whether it is connected to anybody."""
        session = self._session
        return session is not None and bool(session.info.routers_zid() or session.info.peers_zid())

    @property
    def strangers(self) -> set[str]:
        """The fingerprints of other keys, by which robots go that are reached."""
        return set(self._strangers.copy().values())

    def send(self, to: str, raw: bytes, *, urgent: bool) -> None:
        """To one robot, or to all; lost if nobody is reached, or too much waits to be sent."""
        session = self._session
        if session is None:
            return
        from zenoh import CongestionControl, Priority, ZError

        where = f"{self._fleet}/to/{to}" if to else f"{self._fleet}/all/{self._robot}"
        try:
            session.put(
                where,
                raw,
                congestion_control=CongestionControl.DROP,
                priority=Priority.REAL_TIME if urgent else Priority.DATA,
                express=urgent or bool(to),
            )
        except ZError:  # as if it were lost on the way, of which all that is said here takes care
            return

    def _config(self, made: type[Config]) -> Config:
        address, config = self._address, made()
        if address.config is not None:
            try:
                config = made.from_file(address.config)
            except Exception as error:  # whatever Zenoh says of it
                raise UserError(
                    f"The configuration of Zenoh in {address.config} cannot be used"
                    f" ({_first(error)}). Check the file."
                ) from error
        plain = made()

        def silent(key: str) -> bool:
            """Whether the file says nothing of it."""
            return bool(config.get_json(key) == plain.get_json(key))

        finds = {each: address.finds for each in FINDING if address.finds}
        ours_first = {**BEFORE, **finds}
        named = (*address.listens, *address.connects)
        if not silent(TLS) and all(map(encrypted, named)) and all(map(silent, ENDPOINTS)):
            ours_first["transport/link/protocols"] = ENCRYPTED  # whoever is found
        for key, ours in ours_first.items():
            # Where the file is silent, Zenoh would listen and look for others by itself.
            if silent(key) or key in finds:
                config.insert_json5(key, json.dumps(ours))
        for key, endpoints in (("listen", address.listens), ("connect", address.connects)):
            if endpoints:
                config.insert_json5(f"{key}/endpoints", json.dumps(endpoints))
        return config


def _first(error: Exception) -> str:
    """What Zenoh says, without the places in its source."""
    return cause(error).split(" at /")[0].strip(" .")
