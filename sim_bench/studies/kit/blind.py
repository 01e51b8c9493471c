"""A case diagnosed from its files alone, in a process and a folder of its own."""

import os
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

from fricomp import version

_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_PACKAGES = str(Path(version.__file__).resolve().parents[1])

_LIMIT = 900.0
"""Longest time of one diagnosis [s]: the slowest of 2,000 cases took 434 s on a busy machine."""


@dataclass(frozen=True)
class BlindAnswer:
    """What came back from a diagnosis.

    Attributes:
        diagnosis: Content of `diagnosis.json`; empty where there is none.
        motion: Content of the proposed motion's file; empty where none is proposed.
        seconds: Wall-clock time of the whole command, with the start of the interpreter [s].
        processor_seconds: Time of one core that it took [s]; 0 where that is not known.
        error: What it wrote to stderr, where it failed.
    """

    diagnosis: bytes
    motion: bytes
    seconds: float
    error: str
    processor_seconds: float = 0.0


Diagnose = Callable[[dict[str, bytes]], BlindAnswer]
"""Diagnoses the files of a case, given by their names."""


_JOINT, _ARM = "blind_diagnosis", "blind_arm"
"""Modules of the blind side."""


def diagnose_blind(files: dict[str, bytes]) -> BlindAnswer:
    """Diagnose the files of one case in another process and a folder that holds nothing else."""
    return _diagnose(files, _JOINT)


def diagnose_arm_blind(files: dict[str, bytes]) -> BlindAnswer:
    """The same of an arm: the diagnosis is then the content of `arm.json`."""
    return _diagnose(files, _ARM)


def _diagnose(files: dict[str, bytes], module: str) -> BlindAnswer:
    with TemporaryDirectory() as place:
        folder = Path(place)
        for name, content in files.items():
            (folder / name).write_bytes(content)
        start, before = time.perf_counter(), _read_processor_time()
        error = _run(folder, module)
        seconds = time.perf_counter() - start
        used = _read_processor_time() - before
        return BlindAnswer(_read(folder / "diagnosis.json"), _read(folder / "motion.csv"), seconds, error, used)


def _read_processor_time() -> float:
    """Of the commands that this process started and that are over [s]."""
    spent = os.times()
    return spent.children_user + spent.children_system


def _run(folder: Path, module: str) -> str:
    """What the command in this folder wrote where it failed; empty where it did not."""
    command = [sys.executable, "-m", f"fricomp.sim_bench.studies.kit.{module}"]
    # The fricomp of this process, whatever else the interpreter would find in that folder.
    path = os.pathsep.join(filter(None, [_PACKAGES, os.environ.get("PYTHONPATH")]))
    environment = {**os.environ, **_ONE_THREAD, "PYTHONPATH": path}
    try:
        done = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=_LIMIT, check=False
        )
    except subprocess.TimeoutExpired:
        return f"no answer within {_LIMIT:g} s"
    return "" if done.returncode == 0 else f"exit status {done.returncode}: {done.stderr.strip()[-500:]}"


def _read(path: Path) -> bytes:
    return path.read_bytes() if path.exists() else b""
