"""Checked without a robot: canned utterances, paraphrases, the names of a world."""
