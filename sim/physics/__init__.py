"""Bodies that move: the robot, its ways, what is in them."""
