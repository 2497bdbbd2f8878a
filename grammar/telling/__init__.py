"""A plan in plain words.

`values` tells its conditions and values, `steps` what is done, `layout` puts sentences together.
"""
