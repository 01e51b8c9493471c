"""Imported before the parts of the suite, so that an assert in them that fails prints its values in anybody's tests."""

from pathlib import Path

import pytest

for _part in Path(__file__).parent.glob("conformance_*.py"):
    pytest.register_assert_rewrite(f"fricomp.testing.{_part.stem}")
