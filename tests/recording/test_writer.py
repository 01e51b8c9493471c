"""The growing recording: every block is on disk, a kill loses at most the one being written."""

import os
import signal
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path

import pytest

from fricomp.errors import RecordingError
from fricomp.recording import Block, Recording, RecordingWriter, concatenate, read_blocks, read_recording

MakeRecording = Callable[..., Recording]


def _halves(recording: Recording) -> tuple[Recording, Recording]:
    middle = len(recording) // 2
    return recording.rows(slice(None, middle)), recording.rows(slice(middle, None))


def test_blocks_join_to_the_recording_they_came_from(make_recording: MakeRecording, tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    recording = make_recording(100)
    with RecordingWriter(path, recording.metadata, ("time", "position", "torque", "velocity")) as writer:
        for number, part in enumerate(_halves(recording)):
            writer.append(part, f"plateau {number}")
            assert len(read_recording(path)) == 50 * (number + 1)  # on disk before append returns
    assert read_recording(path).content_hash == concatenate(_halves(recording)).content_hash
    assert read_blocks(path) == (Block("plateau 0", 0, 50), Block("plateau 1", 50, 100))


@pytest.mark.parametrize("lost", [1, 7, 40, 200])
def test_resuming_cuts_the_unfinished_block_and_goes_on(
    make_recording: MakeRecording, tmp_path: Path, lost: int
) -> None:
    path = tmp_path / "sweep.csv"
    first, second = _halves(make_recording(100))
    with RecordingWriter(path) as writer:
        writer.append(first, "first")
        writer.append(second, "second")
    os.truncate(path, path.stat().st_size - lost)
    with RecordingWriter(path, resume=True) as writer:
        assert writer.blocks == (Block("first", 0, 50),)
        assert writer.last_time == first.time[-1]
        writer.append(second, "second again")
    assert read_blocks(path) == (Block("first", 0, 50), Block("second again", 50, 100))
    assert read_recording(path).torque.tolist() == make_recording(100).torque.tolist()


def test_a_killed_process_loses_no_committed_block(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    program = textwrap.dedent("""
        import sys
        import numpy as np
        from fricomp.recording import Recording, RecordingWriter
        writer = RecordingWriter(sys.argv[1])
        for block in range(10**6):
            time = block + np.arange(500) / 1000
            writer.append(Recording(time, np.sin(time), np.cos(time)), str(block))
            print(block, flush=True)
    """)
    with subprocess.Popen([sys.executable, "-c", program, str(path)], stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        promised = -1
        while promised < 5:
            promised = int(process.stdout.readline())
        process.send_signal(signal.SIGKILL)
        process.wait()
    committed = [block.label for block in read_blocks(path)]
    assert committed == [str(number) for number in range(len(committed))]
    assert len(committed) > promised
    with RecordingWriter(path, resume=True) as writer:
        assert len(writer.blocks) == len(committed)
    assert len(read_recording(path)) == 500 * len(committed)


def test_a_full_disk_is_one_clear_error_and_keeps_what_was_written(
    make_recording: MakeRecording, tmp_path: Path
) -> None:
    resource = pytest.importorskip("resource")
    path = tmp_path / "sweep.csv"
    first, second = _halves(make_recording(2000))
    old_limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    old_handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    try:
        with RecordingWriter(path) as writer:
            writer.append(first, "first")
            resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + 1000, old_limit[1]))
            with pytest.raises(RecordingError, match="1000 rows are safe on disk"):
                writer.append(second, "second")
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, old_limit)
        signal.signal(signal.SIGXFSZ, old_handler)
    assert read_blocks(path) == (Block("first", 0, 1000),)
    assert len(read_recording(path)) == 1000


def test_the_writer_refuses_what_would_spoil_the_file(make_recording: MakeRecording, tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    recording = make_recording(100)
    with RecordingWriter(path, channels=("time", "position", "torque", "velocity")) as writer:
        writer.append(recording)
        with pytest.raises(RecordingError, match="go on in time"):
            writer.append(recording)
        with pytest.raises(RecordingError, match="has no velocity"):
            writer.append(recording.with_channels(time=recording.time + 1.0, velocity=None))
    with pytest.raises(RecordingError, match="exists: resume it"):
        RecordingWriter(path)
    with pytest.raises(RecordingError, match="has the columns time, position, torque, velocity"):
        RecordingWriter(path, resume=True)
    with pytest.raises(RecordingError, match="cannot write"):
        RecordingWriter(tmp_path / "absent" / "sweep.csv")
    with pytest.raises(RecordingError, match="'position' is not among"):
        RecordingWriter(tmp_path / "other.csv", channels=("time", "torque"))
