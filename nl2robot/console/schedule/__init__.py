"""The page of the appointments."""
