"""The examples in docstrings do what they say."""

from __future__ import annotations

import doctest

import pytest

from fricomp.control import Compensator, ControlLoop


@pytest.mark.parametrize("documented", [Compensator, ControlLoop], ids=lambda documented: documented.__name__)
def test_the_example_in_a_docstring_runs(documented: type) -> None:
    (example,) = doctest.DocTestFinder(recurse=False).find(documented, globs={})
    assert len(example.examples) >= 6
    assert doctest.DocTestRunner().run(example).failed == 0
