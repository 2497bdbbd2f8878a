"""Talking instead of typing: a microphone here or at a client, in; sentences out."""
