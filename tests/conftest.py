"""What holds for all tests."""

from hypothesis import settings

# A busy machine with two cores takes its time; how fast things are is measured, not tested.
settings.register_profile("nl2robot", deadline=None)
settings.load_profile("nl2robot")
