"""Always listening: for the hot word, and for "stop"."""
