from pathlib import Path

import pytest

from .hostile_files import FORMATS, read_hostile, write_seed_file

COUNT = dict.fromkeys(FORMATS, 90) | {"mat": 6, "mat-bare": 6}  # a process a file


@pytest.mark.parametrize("name", FORMATS)
def test_a_whole_file_is_read(name: str, tmp_path: Path) -> None:
    path = write_seed_file(name, tmp_path)
    FORMATS[name].readers[0](path)


@pytest.mark.filterwarnings("default")  # of parsers, on what is damaged
@pytest.mark.parametrize("name", FORMATS)
def test_damaged_and_strange_files_are_read_or_refused_and_nothing_else(name: str) -> None:
    outcome = read_hostile(name, COUNT[name], seed=7)
    assert set(outcome) <= {"read", "refused"}, outcome
    assert outcome["refused"] > 0
