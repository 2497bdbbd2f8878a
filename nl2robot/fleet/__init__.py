"""Several robots as one fleet: who is there, which of them does what, and a stop for all."""
