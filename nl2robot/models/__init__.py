"""Models for speech and language: which there are, fetching one, checking it."""
