"""The page for direct control, and the helm: who drives."""
