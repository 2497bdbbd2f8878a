"""Learning from examples; nothing that runs a robot imports this."""
