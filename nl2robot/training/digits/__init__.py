"""Trains the ear for digits."""
