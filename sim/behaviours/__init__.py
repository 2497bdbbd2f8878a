"""What the simulated robot does, step by step: drive, look for somebody, carry, talk."""
