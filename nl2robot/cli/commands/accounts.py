"""`nl2robot accounts`: who may come in to this machine's server, and what they came in by."""

from __future__ import annotations

import argparse
import getpass
import sys
import time
from contextlib import closing
from datetime import datetime

from nl2robot.cli.options.values import user_name
from nl2robot.errors import ExitStatus, UserError
from nl2robot.paths import authority_file, data_folder
from nl2robot.station.accounts import INVITED_FOR, Accounts
from nl2robot.station.entrance import PAGES_AT
from nl2robot.station.passwords import SHORTEST
from nl2robot.station.qr_code import in_terminal
from robot_api.serving.roles import PAIRED, PERSONAL


def add_arguments(parser: argparse.ArgumentParser) -> None:
    actions = parser.add_subparsers(dest="action", metavar="ACTION")
    actions.add_parser("list", help="accounts, devices and links, and who failed to sign in")
    add = actions.add_parser("add", help="make an account; asks for its password")
    add.add_argument("name")
    add.add_argument("--role", choices=PERSONAL, default="operator", help="(default: operator)")
    remove = actions.add_parser("remove", help="end an account, and whatever it is signed in on")
    remove.add_argument("name")
    password = actions.add_parser("password", help="give an account another password")
    password.add_argument("name")
    role = actions.add_parser("role", help="give an account another role")
    role.add_argument("name")
    role.add_argument("role", choices=PERSONAL)
    pair = actions.add_parser("pair", help="show a QR code by which one tablet comes in")
    pair.add_argument("role", choices=PAIRED)
    pair.add_argument("--label", help="what the tablet is called, such as where it hangs")
    pair.add_argument("--address", metavar="URL", help="of the pages, if others than the last")
    token = actions.add_parser("token", help="make a token by which an assistant comes in")
    token.add_argument("name", help="what the assistant is called, as people see it")
    withdraw = actions.add_parser("withdraw", help="let nobody come in by a device or link again")
    withdraw.add_argument("number", type=int, help="as `nl2robot accounts list` has it")


def run(options: argparse.Namespace) -> int:
    with closing(Accounts(data_folder() / "accounts.sqlite")) as accounts:
        match options.action:
            case "list" | None:
                _list(accounts)
            case "add":
                accounts.check_new(options.name)
                accounts.add(options.name, options.role, _password(options.name))
                print(f"{options.name} can sign in now, as {options.role}.")
            case "remove":
                accounts.remove(options.name)
                print(f"{options.name} cannot sign in any more, and is signed out everywhere.")
            case "password":
                accounts.check_known(options.name)
                accounts.set_password(options.name, _password(options.name))
                print(f"The password is changed; {options.name} has to sign in anew.")
            case "role":
                accounts.set_role(options.name, options.role)
                print(f"{options.name} is {options.role} now.")
            case "pair":
                _pair(accounts, options)
            case "token":
                secret = accounts.let_in("assistant", options.name, _who())
                print(secret)
                print(
                    f"{options.name} comes in by it: it sees what goes on, proposes programs and"
                    " can stop the robot. It is not shown again; keep it as you keep a password.",
                    file=sys.stderr,
                )
            case "withdraw":
                accounts.withdraw(options.number)
                print(f"Nobody comes in by {options.number} any more.")
    return ExitStatus.OK


def _list(accounts: Accounts) -> None:
    from rich.console import Console
    from rich.table import Table

    console = Console(highlight=False)
    people = Table("account", "role", "since", title="Accounts", title_justify="left")
    for each in accounts.accounts():
        people.add_row(each.name, each.role, _when(each.made))
    console.print(people if people.rows else "There are no accounts: nl2robot accounts add NAME.")
    devices = Table(
        *("", "device or link", "whose", "role", "last used"),
        title="What people and tablets came in by",
        title_justify="left",
    )
    for device in accounts.sessions():
        whose = device.account or (f"paired by {device.made_by}" if device.made_by else "")
        used = "not yet" if device.link and device.used == device.made else _when(device.used)
        devices.add_row(str(device.id), device.label, whose, device.role, used)
    if devices.rows:
        console.print(devices)
    for failure in accounts.failures(10):
        print(f"{_when(failure.time)}  failed to sign in as {failure.name} at {failure.address}")
    if authority_file().exists():
        from nl2robot.station.certificates import fingerprint_of

        print(f"Fingerprint of the certificate authority: {fingerprint_of(authority_file())}")


def _pair(accounts: Accounts, options: argparse.Namespace) -> None:
    pages = options.address or accounts.noted(PAGES_AT)
    if pages is None:
        raise UserError("Where are the robot's pages? Start `nl2robot serve --host 0.0.0.0` first.")
    label = options.label or f"tablet ({options.role})"
    code = accounts.invite(options.role, label, _who())
    link = f"{pages.rstrip('/')}/join/{code}"
    print(in_terminal(link))
    print(f"{link}\nOne tablet comes in by it, within {INVITED_FOR / 60:.0f} minutes, as {label}.")


def _password(name: str) -> str:
    if not sys.stdin.isatty():
        return sys.stdin.readline().rstrip("\n")
    print(f"At least {SHORTEST} characters: three words that do not belong together, say.")
    given = getpass.getpass(f"Password for {name}: ")
    if getpass.getpass("The same again: ") != given:
        raise UserError("The two passwords are not the same. Give the command again.")
    return given


def _who() -> str:
    return user_name()


def _when(then: float) -> str:
    """The day as well, unless it is today's."""
    moment = datetime.fromtimestamp(then)
    today = moment.date() == datetime.fromtimestamp(time.time()).date()
    return f"{moment:%H:%M}" if today else f"{moment:%Y-%m-%d %H:%M}"
