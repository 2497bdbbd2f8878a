"""Free texts: where they may end, and whether they are meant to be said."""
