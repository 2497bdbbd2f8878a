"""How fast and how well, measured: commands and modules that nothing else imports."""
