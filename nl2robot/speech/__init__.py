"""Speech to text on this machine alone.

audio        any recording -> 16 kHz mono samples
levels       how loud it is
recogniser   samples and what may be said -> the words, and whether to believe them
answers      what may be answered to a question, and which answer was given
vocabulary   words that the speech model can never hear, and what to call them instead
digits       which digit a short sound is, by the sound alone; digits_training makes it
scenes       noise and rooms; trials: what is said in them to measure how well it is heard
benchmark    how fast it is
"""
