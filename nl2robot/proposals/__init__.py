"""Programs that somebody proposes who may not approve them, until a person has decided."""
