"""Pictures of floors and runs."""
