"""Checks a program and runs it, able to reach nothing but the robot methods it was given."""
