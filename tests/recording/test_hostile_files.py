import os
import signal
import subprocess
from pathlib import Path

import pytest

from fricomp.recording.sources import mat_file

from .hostile_files import FORMATS, MatlabReader, read_hostile, write_seed_file

COUNT = dict.fromkeys(FORMATS, 90) | {"mat": 6, "mat-bare": 6, "hdf5": 6}  # a process a file


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


def test_a_copy_answers_about_a_matlab_file_as_an_interpreter_does(tmp_path: Path) -> None:
    text = tmp_path / "text.mat"
    text.write_text("nothing of the kind")
    reader, whole = MatlabReader(), write_seed_file("mat", tmp_path)
    for path in (whole, text, whole):
        call = mat_file.make_call(path)
        alone, in_copy = subprocess.run(call, check=False, capture_output=True), reader.run(call)
        assert in_copy.returncode == alone.returncode
        assert (in_copy.stdout, in_copy.stderr) == (alone.stdout, alone.stderr)


def test_a_matlab_file_that_kills_its_reader_is_told_and_the_next_is_read(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reader, whole = MatlabReader(), write_seed_file("mat", tmp_path)
    read = mat_file.write_variables
    monkeypatch.setattr(mat_file, "write_variables", lambda path: read(path) if path.endswith("a.mat") else os.abort())
    assert reader.run(["", "deadly.mat"]).returncode == -signal.SIGABRT
    assert reader.run(["", str(whole)]).returncode == 0
