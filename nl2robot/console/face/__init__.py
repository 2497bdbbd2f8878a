"""The robot's face: the page for the tablet on the robot, and who stands before it."""
