"""Which digit a short sound is, by the sound alone."""
