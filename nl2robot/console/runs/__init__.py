"""The pages of the past runs."""
