"""What all studies share: a store of finished cases, a runner, a scorer, figures with intervals, and pages.

It imports nothing of a generator, so that a study whose generator must stay apart can use it.
"""
