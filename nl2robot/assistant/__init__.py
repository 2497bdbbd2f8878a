"""The door for assistants: a server of the Model Context Protocol that looks, tries and asks."""
