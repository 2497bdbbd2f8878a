"""What a robot can do, a file for each capability: its interface, and its implementations.

Each file holds an abstract class with the methods of `robot_api.methods` that need the capability,
then the implementations: emulated (does nothing but answer), simulated (does it in `sim`), shared
(made from other capabilities, for robots that lack it). `robot_api.drivers` puts drivers together
from them; docs/drivers.md shows how to add a method, a capability or a robot.
"""
