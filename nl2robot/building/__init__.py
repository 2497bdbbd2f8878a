"""The building's own systems: what they tell the robot, and what they are told of it."""
