"""The languages: a folder of data for each, where those of other packages are, and a checker."""
