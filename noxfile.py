"""`make test` under every Python that nl2robot runs on: `make test-all`, or `nox -s tests-3.13`.

A Python that is not on this machine is left out, and named. `nox -- lint` makes that instead.
"""

import nox

PYTHONS = ("3.11", "3.12", "3.13", "3.14")


@nox.session(python=PYTHONS, venv_backend="venv")
def tests(session: nox.Session) -> None:
    """Each in an environment of its own, from the same locks."""
    place = session.virtualenv.location
    wanted = session.posargs or ["test"]
    session.run("make", *wanted, f"PYTHON={place}/bin/python", f"VENV={place}/made", external=True)
