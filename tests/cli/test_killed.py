from collections.abc import Iterator
from pathlib import Path

import pytest

from .killed import count_operations, keep_leftovers, kill_and_repeat, repeat_on
from .warm import WarmProcess

SHARES = (0.2, 0.5, 0.9)
"""Of a run's file operations."""


@pytest.fixture(scope="module")
def warm() -> Iterator[WarmProcess]:
    with WarmProcess() as process:
        yield process


@pytest.mark.parametrize("at", [2, 4])
def test_an_export_that_is_killed_is_repeated_as_it_was_called(at: int, warm: WarmProcess, tmp_path: Path) -> None:
    kill_and_repeat(warm, "export", tmp_path, at)


@pytest.mark.slow
def test_an_identification_that_is_killed_is_repeated_as_it_was_called(warm: WarmProcess, tmp_path: Path) -> None:
    (tmp_path / "whole").mkdir()
    operations = count_operations(warm, "identify", tmp_path / "whole")
    for share in SHARES:
        killed = tmp_path / f"{share:g}"
        killed.mkdir()
        assert kill_and_repeat(warm, "identify", killed, round(share * operations))


@pytest.mark.slow
@pytest.mark.parametrize("name", ["calibrate", "diagnose"])
def test_what_a_kill_leaves_is_gone_on_with(name: str, warm: WarmProcess, tmp_path: Path) -> None:
    _, lefts = keep_leftovers(warm, name, tmp_path)
    for share in SHARES if name == "calibrate" else SHARES[1:]:  # a diagnosis writes at its end alone
        repeat_on(warm, name, tmp_path, lefts[round(share * len(lefts))])
