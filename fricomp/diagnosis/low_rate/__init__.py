"""Recordings of 10 to 60 Hz: what sliding shows at such a rate, and what falls between its samples.

`settings` has the numbers, `models` the models that are compared, `held_out` their errors on data left out,
and `answer` the diagnosis that follows.
"""
