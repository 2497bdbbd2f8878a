"""Reminders to people: who was reminded of what, and the question what came of it."""
