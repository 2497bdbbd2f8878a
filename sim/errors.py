"""What can go wrong in the simulated hospital.

    SimError
    ├── UnknownPlace     no place of that name in this world
    ├── UnknownPerson    no person of that name in this world
    ├── NotFound         the thing or person is not here, or not to be seen
    ├── NotPossible      cannot be done now (nothing in the hand, battery empty, ...)
    ├── Blocked          the way is blocked and there is no other
    └── TimedOut         nothing happened in the time allowed
    Interrupted          a BaseException: somebody stopped the robot

The names are those of the robot's own errors, so that a driver can hand each on as its namesake.
"""

from __future__ import annotations


class SimError(Exception):
    """Something could not be done; the message says why in a sentence a nurse understands."""


class UnknownPlace(SimError):
    pass


class UnknownPerson(SimError):
    pass


class NotFound(SimError):
    pass


class NotPossible(SimError):
    pass


class Blocked(SimError):
    pass


class TimedOut(SimError):
    pass


class Interrupted(BaseException):
    """The running behaviour was stopped; the robot is at rest."""
