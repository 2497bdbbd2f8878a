"""Approved programs by the clock and by events: when each is due, and what came of it."""
