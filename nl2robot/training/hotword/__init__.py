"""Trains the heads of hot words."""
