"""The command line: a module for each command, and what people see at a terminal."""
