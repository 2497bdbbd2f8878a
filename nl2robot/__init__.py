"""nl2robot: tell a social robot what to do in your own words."""

__version__ = "0.2.0"
