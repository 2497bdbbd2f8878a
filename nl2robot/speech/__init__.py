"""Speech to text on this machine alone.

audio        any recording -> 16 kHz mono samples
recogniser   samples and what may be said -> the words, and whether to believe them
answers      what may be answered to a question, and which answer was given
vocabulary   words that the speech model can never hear, and what to call them instead
benchmark    how fast it is
"""
