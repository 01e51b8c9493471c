"""What holds for every test: property tests draw the same examples on every run, and store none."""

from hypothesis import settings

settings.register_profile("repeatable", derandomize=True, database=None, deadline=None)
settings.load_profile("repeatable")
