"""Files are whole or not there: after a full disk, an interruption, a kill, and beside planted links."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from fricomp.errors import ModelFileError, OutputError
from fricomp.whole_file import remove_abandoned_parts, whole_file, write_whole


def test_text_and_bytes_are_written_with_the_folders_above(tmp_path: Path) -> None:
    write_whole(tmp_path / "a" / "b" / "text", "N·m\n")
    write_whole(tmp_path / "bytes", b"\x00\xff")
    assert (tmp_path / "a" / "b" / "text").read_bytes() == "N·m\n".encode()
    assert (tmp_path / "bytes").read_bytes() == b"\x00\xff"


def test_a_name_that_no_text_file_can_hold_is_written_escaped(tmp_path: Path) -> None:
    write_whole(tmp_path / "facts", "recording \udcff.csv")
    assert (tmp_path / "facts").read_text() == "recording \\udcff.csv"


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt(), ValueError("no")])
def test_what_goes_wrong_leaves_the_old_file_and_no_other(failure: BaseException, tmp_path: Path) -> None:
    path = tmp_path / "friction.json"
    path.write_text("old")
    kind = ModelFileError if isinstance(failure, OSError) else type(failure)

    def fail(part: Path) -> None:
        part.write_text("half")
        raise failure

    with pytest.raises(kind), whole_file(path, ModelFileError) as part:
        fail(part)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="this system has no device that is always full")
def test_a_disk_that_is_full_is_one_sentence(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def full(descriptor: int) -> None:
        with open("/dev/full", "wb", buffering=0) as device:
            device.write(b"x")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OutputError, match=r"cannot write .*report.html: No space left on device"):
        write_whole(tmp_path / "report.html", "page")
    assert list(tmp_path.iterdir()) == []


def test_a_planted_link_is_replaced_and_not_followed(tmp_path: Path) -> None:
    other = tmp_path / "other"
    other.write_text("of somebody else")
    (tmp_path / "report.html").symlink_to(other)
    write_whole(tmp_path / "report.html", "page")
    assert other.read_text() == "of somebody else"
    assert (tmp_path / "report.html").read_text() == "page"
    assert not (tmp_path / "report.html").is_symlink()


def test_two_writers_of_one_file_do_not_meet(tmp_path: Path) -> None:
    path = tmp_path / "friction.json"
    with whole_file(path) as first, whole_file(path) as second:
        first.write_text("first")
        second.write_text("second")
    assert path.read_text() == "first"
    assert list(tmp_path.iterdir()) == [path]


def test_what_a_killed_writer_left_is_removed_and_that_of_a_living_one_stays(tmp_path: Path) -> None:
    script = (
        "import sys, time; from pathlib import Path; from fricomp.whole_file import whole_file\n"
        "with whole_file(Path(sys.argv[1])) as part:\n"
        "    part.write_text('half'); print('writes', flush=True); time.sleep(600)"
    )
    process = subprocess.Popen([sys.executable, "-c", script, str(tmp_path / "a")], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    with process, whole_file(tmp_path / "b") as mine:
        assert process.stdout.readline() == "writes\n"
        remove_abandoned_parts(tmp_path)
        assert len(list(tmp_path.iterdir())) == 2
        process.send_signal(signal.SIGKILL)
        process.wait()
        remove_abandoned_parts(tmp_path)
        assert list(tmp_path.iterdir()) == [mine]
        mine.write_text("whole")
    assert [path.name for path in tmp_path.iterdir()] == ["b"]
