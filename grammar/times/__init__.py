"""Times in sentences: which words say when, and which half of the day they leave out."""
