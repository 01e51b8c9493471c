"""Which files of a folder are its logs."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.arm.log.reading import list_log_files


def test_words_beside_logs_are_no_log(tmp_path: Path) -> None:
    (tmp_path / "README.txt").write_text("Friction tests of 5 March.\n\nMotor 2, see the drawing.\nNo load.\n")
    (tmp_path / "run.txt").write_text("t q tau\n" + "".join(f"{0.01 * k:.2f} {0.1 * k:.3f} 0.5\n" for k in range(50)))
    (tmp_path / "serial.txt").write_text("boot\n" + "".join(f"t={k}ms q=0.{k} tau=0.5\n" for k in range(50)))
    (tmp_path / "table.csv").write_text("t,q,tau\n0,0.1,0.2\n")
    found = [one.name for one in list_log_files([str(tmp_path)])]
    assert found == ["run.txt", "serial.txt", "table.csv"]
    alone = tmp_path / "words"
    alone.mkdir()
    (alone / "notes.txt").write_text("nothing yet\n")
    assert [one.name for one in list_log_files([str(alone)])] == [
        "notes.txt"
    ]  # whose reader says what is wrong with it


@pytest.mark.parametrize("suffix", [".h5", ".hdf5", ".feather", ".jsonl", ".MAT", ".tsv"])
def test_a_folder_holds_logs_of_every_format_that_names_its_columns(suffix: str, tmp_path: Path) -> None:
    (tmp_path / f"joint_1{suffix}").write_bytes(b"anything")
    (tmp_path / "picture.png").write_bytes(b"anything")
    assert [one.name for one in list_log_files([str(tmp_path)])] == [f"joint_1{suffix}"]
