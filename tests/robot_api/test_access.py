"""Who may talk to a robot: nobody from another web page, nobody else without the token."""

import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from robot_api.serving.access import Guest, Refusal, Tokens, admitted, is_loopback, new_token
from robot_api.serving.roles import Role


def answer(
    headers: dict[str, str],
    *,
    local: bool = True,
    token: str | None = None,
    given: str | None = None,
) -> Role | Refusal:
    query = {} if given is None else {"token": given}
    tokens = Tokens(token, "only to look", "robot-9090")
    answered = admitted(headers, query, local=local, tokens=tokens)
    return answered.role if isinstance(answered, Guest) else answered


def status(
    headers: dict[str, str],
    *,
    local: bool = True,
    token: str | None = None,
    given: str | None = None,
) -> int:
    answered = answer(headers, local=local, token=token, given=given)
    return answered.status if isinstance(answered, Refusal) else 200


@pytest.mark.parametrize("host", ["localhost:9090", "127.0.0.1:9090", "[::1]:9090", "LOCALHOST"])
def test_this_machine_is_welcome_under_each_of_its_names(host: str) -> None:
    assert status({"host": host}) == 200


@pytest.mark.parametrize(
    "host", ["evil.example:9090", "", "localhost.evil.example", "[::", "10.0.0.1"]
)
def test_a_name_that_was_made_to_point_here_is_refused(host: str) -> None:
    assert status({"host": host}) == 403


@pytest.mark.parametrize(
    "origin",
    [
        "https://evil.example",
        "null",
        "http://localhost:3000",
        "http://127.0.0.1:9090",
        "",
        "file://",
    ],
)
def test_a_page_from_elsewhere_may_not_drive_the_robot(origin: str) -> None:
    assert status({"host": "localhost:9090", "origin": origin}) == 403


def test_the_servers_own_page_may() -> None:
    assert status({"host": "localhost:9090", "origin": "http://localhost:9090"}) == 200
    assert status({"host": "robot.ward:80", "origin": "http://robot.ward"}, local=False) == 200


def test_from_another_machine_the_token_is_needed() -> None:
    robot = {"host": "10.0.0.5:9090"}
    assert status(robot, local=False, token="sesame") == 401
    assert status(robot, local=False, token="sesame", given="wrong") == 401
    assert status(robot, local=False, token="sesame", given="sesame") == 200
    bearer = {**robot, "authorization": "Bearer sesame"}
    assert status(bearer, local=False, token="sesame") == 200
    assert status({**robot, "authorization": "Basic sesame"}, local=False, token="sesame") == 401


def test_a_browser_keeps_its_token_in_the_cookie_of_this_server() -> None:
    robot = {"host": "10.0.0.5:9090"}
    mine = {**robot, "cookie": "other=1; robot-9090=sesame"}
    of_another = {**robot, "cookie": "robot-9091=sesame"}
    assert status(mine, local=False, token="sesame") == 200
    assert status(of_another, local=False, token="sesame") == 401
    assert status(mine, local=False, token="sesame", given="wrong") == 401, "the link is newer"


@pytest.mark.parametrize("local", [True, False])
def test_who_has_the_observers_link_looks_on(local: bool) -> None:
    robot = {"host": "127.0.0.1:9090"}
    token = None if local else "sesame"
    assert answer(robot, local=local, token=token, given="only to look") == "observer"
    kept = {**robot, "cookie": "robot-9090=only to look"}
    assert answer({**robot, "cookie": 'robot-9090="only to look"'}, local=local, token=token) == (
        "observer"
    )
    if token:
        assert answer(kept, local=local, token=token, given="sesame") == "operator"


def test_who_shows_what_does_not_hold_is_nobody_here_either() -> None:
    """An observer's link of before a restart makes no operator of whom it was given to."""
    here = {"host": "localhost:9090"}
    old = {**here, "cookie": "robot-9090=from before the restart"}
    assert answer(here) == "administrator"
    for refused in (answer(old), answer(here, given="guessed")):
        assert isinstance(refused, Refusal) and refused.status == 401 and refused.outdated
    assert answer(old, given="") == "administrator", "they begin anew, as who sits here"


def test_cookies_that_take_long_to_read_take_no_time() -> None:
    robot = {"host": "10.0.0.5:9090"}
    before = time.perf_counter()
    for cookie in ('a="' + "\\x" * 100_000, "a=1;" * 60_000, "robot-9090=" + "x" * 250_000):
        assert status({**robot, "cookie": cookie}, local=False, token="sesame") == 401
    assert time.perf_counter() - before < 1.0


def test_tokens_differ_and_loopback_is_told_from_the_rest() -> None:
    assert new_token() != new_token()
    assert all(new_token().isalnum() for _ in range(100)), "it is typed after --token"
    assert is_loopback("127.0.0.1") and is_loopback("::1") and is_loopback("localhost")
    assert not is_loopback("0.0.0.0") and not is_loopback("example.org")


@given(host=st.text(), origin=st.none() | st.text(), authorization=st.text(), cookie=st.text())
def test_odd_headers_never_get_in_and_never_break_it(
    host: str, origin: str | None, authorization: str, cookie: str
) -> None:
    headers = {"host": host, "authorization": authorization, "cookie": cookie}
    if origin is not None:
        headers["origin"] = origin
    assert status(headers, local=False, token="a secret that nobody guesses") in (401, 403)
