"""The people of the simulated hospital: walking, talking, being looked for."""
