"""The web console: talk, review, watch, drive, stop; the robot's face; on the wire's port.

`app` puts it together from its parts (`part`), each of which has its services, events and pages.
NiceGUI is imported only here, and only by `nl2robot serve`.
"""
