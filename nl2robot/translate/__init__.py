"""From words to a program: sentences, conversations, routines, and the planners behind."""
