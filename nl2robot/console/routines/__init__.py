"""The page of the routines."""
