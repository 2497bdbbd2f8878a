"""Attacks on a running server, and what they do to a stop: `python -m tests.attacks`."""
