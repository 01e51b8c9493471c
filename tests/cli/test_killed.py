from pathlib import Path

import pytest

from .killed import count_operations, kill_and_repeat


@pytest.mark.parametrize("at", [2, 4])
def test_an_export_that_is_killed_is_repeated_as_it_was_called(at: int, tmp_path: Path) -> None:
    kill_and_repeat("export", tmp_path, at)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["identify", "calibrate", "diagnose"])
@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_a_command_that_is_killed_is_repeated_as_it_was_called(name: str, share: float, tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    (tmp_path / "killed").mkdir()
    operations = count_operations(name, tmp_path / "whole")
    kill_and_repeat(name, tmp_path / "killed", round(share * operations))
