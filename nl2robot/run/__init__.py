"""Approved programs on the robot: one run at a time, its log, its pauses, what came of it."""
