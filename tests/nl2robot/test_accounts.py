"""Who may come in: names, passwords, tablets, and how long each holds."""

from __future__ import annotations

import io
import threading
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace

import pytest
from PIL import Image

from nl2robot.console.face.codes import read_codes
from nl2robot.errors import ExitStatus, UserError
from nl2robot.station import passwords
from nl2robot.station.accounts import INVITED_FOR, SHIFT, YEAR, Accounts, TooSoon
from nl2robot.station.qr_code import HALVES, in_terminal

PASSWORD = "correct horse battery"
HERE = ("10.0.0.7", "Firefox, Android")


@pytest.fixture
def clock() -> SimpleNamespace:
    return SimpleNamespace(now=1_800_000_000.0)


@pytest.fixture
def accounts(tmp_path: Path, clock: SimpleNamespace) -> Iterator[Accounts]:
    accounts = Accounts(tmp_path / "accounts.sqlite", lambda: clock.now)
    yield accounts
    accounts.close()


def test_a_person_is_known_by_name_however_it_is_written(accounts: Accounts) -> None:
    accounts.add("  Ann   Müller ", "operator", PASSWORD)
    secret = accounts.sign_in("ann müller", PASSWORD, *HERE)
    guest = accounts.known(secret or "")
    assert guest is not None and (guest.name, guest.role) == ("Ann Müller", "operator")
    assert accounts.sign_in("Ann Müller", "Correct horse battery", *HERE) is None
    assert accounts.sign_in("Nobody", PASSWORD, *HERE) is None
    assert accounts.known("guessed") is None


@pytest.mark.parametrize(
    ("name", "password", "sentence"),
    [
        ("Ann", PASSWORD, "already"),
        ("ANN", PASSWORD, "already"),
        ("", PASSWORD, "1 to 60 characters"),
        ("x" * 61, PASSWORD, "1 to 60 characters"),
        ("a\x07b", PASSWORD, "1 to 60 characters"),
        ("Ben", "short", "10 to 200 characters"),
    ],
)
def test_what_is_no_account_is_refused_with_a_sentence(
    accounts: Accounts, name: str, password: str, sentence: str
) -> None:
    accounts.add("Ann", "operator", PASSWORD)
    with pytest.raises(UserError, match=sentence):
        accounts.add(name, "operator", password)


def test_a_person_is_signed_out_after_a_shift_a_tablet_stays(
    accounts: Accounts, clock: SimpleNamespace
) -> None:
    accounts.add("Ann", "operator", PASSWORD)
    person = accounts.sign_in("Ann", PASSWORD, *HERE) or ""
    tablet = accounts.join(accounts.invite("face", "Tablet at the reception", "Ann")) or ""
    clock.now += SHIFT - 1
    assert accounts.known(person), "who goes on working stays"
    clock.now += SHIFT - 1
    assert accounts.known(person)
    clock.now += SHIFT + 1
    assert accounts.known(person) is None
    assert accounts.known(tablet)
    clock.now += YEAR + 1
    assert accounts.known(tablet) is None
    assert accounts.sessions() == []


def test_uses_are_kept_over_a_restart(
    accounts: Accounts, clock: SimpleNamespace, tmp_path: Path
) -> None:
    accounts.add("Ann", "operator", PASSWORD)
    secret = accounts.sign_in("Ann", PASSWORD, *HERE) or ""
    clock.now += SHIFT - 1
    accounts.known(secret)
    accounts.close()
    clock.now += SHIFT - 1
    again = Accounts(tmp_path / "accounts.sqlite", lambda: clock.now)
    assert again.known(secret)
    again.close()


def test_a_code_is_good_once_and_for_ten_minutes(
    accounts: Accounts, clock: SimpleNamespace
) -> None:
    code = accounts.invite("observer", "Screen on ward b", None)
    invitation = accounts.invitation(code)
    assert invitation is not None and invitation.role == "observer"
    guest = accounts.known(accounts.join(code) or "")
    assert guest is not None and guest.name == "Screen on ward b"
    assert accounts.join(code) is None and accounts.invitation(code) is None
    late = accounts.invite("face", "Another", None)
    clock.now += INVITED_FOR + 1
    assert accounts.invitation(late) is None and accounts.join(late) is None


def test_one_code_lets_one_of_many_in(accounts: Accounts) -> None:
    code = accounts.invite("face", "Tablet", None)
    found: list[str | None] = []
    crowd = [threading.Thread(target=lambda: found.append(accounts.join(code))) for _ in range(8)]
    for each in crowd:
        each.start()
    for each in crowd:
        each.join()
    assert len([each for each in found if each]) == 1


def test_wrong_passwords_take_longer_and_longer_for_name_and_place(
    accounts: Accounts, clock: SimpleNamespace
) -> None:
    accounts.add("Ann", "operator", PASSWORD)
    waits = []
    for _ in range(13):
        try:
            assert accounts.sign_in("Ann", "not her password", *HERE) is None
        except TooSoon as wait:
            waits.append(wait.seconds)
            clock.now += wait.seconds
    assert waits[:3] == [2.0, 4.0, 8.0] and max(waits) <= 60
    with pytest.raises(TooSoon):  # the right one, too, or a guess would be told from it
        accounts.sign_in("Ann", PASSWORD, "10.0.0.99", "")
    with pytest.raises(TooSoon):
        accounts.sign_in("Ben", PASSWORD, *HERE)
    accounts.sign_in("Ben", PASSWORD, "10.0.0.99", "")  # somebody else, somewhere else
    clock.now += 60
    assert accounts.sign_in("Ann", PASSWORD, *HERE)
    assert accounts.sign_in("Ann", "a slip of the hand", *HERE) is None
    assert accounts.sign_in("Ann", PASSWORD, *HERE), "what was before counts no more"
    assert len(accounts.failures(100)) == 10, "and is shown all the same"


def test_another_password_or_the_end_of_an_account_signs_out(accounts: Accounts) -> None:
    accounts.add("Ann", "operator", PASSWORD)
    changes: list[None] = []
    accounts.on_change(lambda: changes.append(None))
    first = accounts.sign_in("Ann", PASSWORD, *HERE) or ""
    guest = accounts.known(first)
    assert guest and accounts.holds(guest)
    accounts.set_role("ann", "administrator")
    assert not accounts.holds(guest), "connections of the old role are closed"
    accounts.set_password("Ann", "another good password")
    assert accounts.known(first) is None
    second = accounts.sign_in("Ann", "another good password", *HERE) or ""
    accounts.remove("Ann")
    assert accounts.known(second) is None
    assert changes
    with pytest.raises(UserError, match="no account of Ann"):
        accounts.remove("Ann")


def test_links_stay_the_same_until_they_are_withdrawn(accounts: Accounts) -> None:
    link = accounts.link("observer")
    assert accounts.link("observer") == link != accounts.link("operator")
    guest = accounts.known(link)
    assert guest is not None and guest.name is None and guest.session is not None
    accounts.withdraw(guest.session)
    assert accounts.known(link) is None
    assert accounts.link("observer") != link


def test_what_another_process_changes_is_noticed(accounts: Accounts, tmp_path: Path) -> None:
    accounts.add("Ann", "operator", PASSWORD)
    secret = accounts.sign_in("Ann", PASSWORD, *HERE) or ""
    noticed = threading.Event()
    accounts.on_change(noticed.set)
    accounts.watch()
    other = Accounts(tmp_path / "accounts.sqlite")
    other.remove("Ann")
    other.close()
    assert noticed.wait(30)
    assert accounts.known(secret) is None


def test_passwords_are_the_same_on_every_keyboard() -> None:
    composed, apart = "Z\u00fcrich am See", "Zu\u0308rich am See"
    assert passwords.is_right(apart, passwords.hashed(composed))
    assert passwords.hashed(composed) != passwords.hashed(composed), "salted"
    assert passwords.hashed(composed).startswith("$argon2id$")


# --- the command ---------------------------------------------------------------------------------


def test_accounts_are_made_listed_and_ended_at_the_terminal(nl2robot, monkeypatch, home) -> None:  # type: ignore[no-untyped-def]
    def typed(words: str) -> None:
        monkeypatch.setattr("sys.stdin", io.StringIO(words))

    typed(PASSWORD + "\n")
    assert nl2robot("accounts", "add", "Ann", "--role", "administrator")[0] == ExitStatus.OK
    typed("short\n")
    status, _, err = nl2robot("accounts", "add", "Ben")
    assert status == ExitStatus.BAD_INPUT and "10 to 200 characters" in err
    status, out, _ = nl2robot("accounts")  # which lists them
    assert "Ann" in out and "administrator" in out and "Ben" not in out
    status, _, err = nl2robot("accounts", "pair", "face")
    assert status == ExitStatus.BAD_INPUT and "Start `nl2robot serve --host 0.0.0.0` first" in err
    status, out, _ = nl2robot(
        *("accounts", "pair", "face", "--label", "Tablet", "--address", "https://robin:9090/")
    )
    link = next(line for line in out.splitlines() if line.startswith("https://robin:9090/join/"))
    kept = Accounts(home / "accounts.sqlite")
    invitation = kept.invitation(link.rpartition("/")[2])
    assert invitation is not None and (invitation.label, invitation.made_by) == (
        "Tablet",
        "Nurse Kim",
    )
    assert kept.join(link.rpartition("/")[2])
    [tablet] = kept.sessions()
    assert nl2robot("accounts", "withdraw", str(tablet.id))[0] == ExitStatus.OK
    assert kept.sessions() == []
    assert nl2robot("accounts", "remove", "ann")[0] == ExitStatus.OK
    assert kept.accounts() == []
    kept.close()


def test_a_code_in_a_terminal_can_be_read_by_a_camera() -> None:
    link = "https://192.168.1.20:9090/join/FGsjjasObPzplSFC"
    light = {sign: halves for halves, sign in HALVES.items()}
    rows = in_terminal(link).splitlines()
    picture = Image.new("L", (len(rows[0]), 2 * len(rows)))
    for y, row in enumerate(rows):
        for x, sign in enumerate(row):
            for half in (0, 1):
                picture.putpixel((x, 2 * y + half), 255 * light[sign][half])
    file = io.BytesIO()
    picture.resize((picture.width * 6, picture.height * 6), Image.Resampling.NEAREST).save(
        file, "PNG"
    )
    assert [code.text for code in read_codes(file.getvalue())] == [link]
