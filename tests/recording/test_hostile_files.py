import importlib.util
from pathlib import Path
from types import ModuleType

import pytest


def _load() -> ModuleType:
    """The harness beside this file, which is a script too."""
    spec = importlib.util.spec_from_file_location("hostile_files", Path(__file__).with_name("hostile_files.py"))
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


HOSTILE = _load()
COUNT = dict.fromkeys(HOSTILE.FORMATS, 150) | {"mat": 6, "mat-bare": 6}  # a process a file


@pytest.mark.parametrize("name", HOSTILE.FORMATS)
def test_a_whole_file_is_read(name: str, tmp_path: Path) -> None:
    path = HOSTILE.write_seed_file(name, tmp_path)
    for read in HOSTILE.FORMATS[name][2]:
        read(path)


@pytest.mark.filterwarnings("default")  # of parsers, on what is damaged
@pytest.mark.parametrize("name", HOSTILE.FORMATS)
def test_damaged_files_are_read_or_refused_and_nothing_else(name: str) -> None:
    outcome = HOSTILE.read_hostile(name, COUNT[name], seed=7)
    assert set(outcome) <= {"read", "refused"}, outcome
    assert outcome["refused"] > 0
