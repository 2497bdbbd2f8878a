"""Which of several drafts is meant: what each would do is tried on paper, and drafts that do the
same are one vote."""
