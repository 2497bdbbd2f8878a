"""The page of the fleet: all robots on one map, and a stop for all."""
