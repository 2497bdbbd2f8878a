"""The live floor map, and what is drawn on it."""
