"""What runs on workers: making a case, and diagnosing one from its files alone in a process and folder of its own."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fricomp import version
from fricomp.errors import DiagnosisError, FricompError

from ...cases import CaseSpec, case_id, generate, record_again, write_answer, write_case
from ..real.injection import InjectedSpec, inject

__all__ = ["BlindAnswer", "Prepared", "diagnose_blind", "prepare", "prepare_follow_up"]

_ONE_THREAD = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
_PACKAGES = str(Path(version.__file__).resolve().parents[1])
_LIMIT = 900.0  # [s] for one diagnosis
_LONGEST, _PERIOD = 120.0, 1e-3  # [s] of a proposed motion, of its samples


@dataclass(frozen=True)
class Prepared:
    """A case on its way to the diagnosis.

    Attributes:
        case: Its name.
        files: What the diagnosis may read, by file name; empty where the case could not be made.
        answer: What it may not.
        refused: Why the case could not be made; empty where it could.
    """

    case: str
    files: dict[str, bytes]
    answer: bytes
    refused: str = ""


@dataclass(frozen=True)
class BlindAnswer:
    """What came back from a diagnosis.

    Attributes:
        diagnosis: Content of `diagnosis.json`; empty where there is none.
        motion: Content of the proposed motion's file; empty where none is proposed.
        seconds: Wall-clock time of the whole command, start of the interpreter included [s].
        error: What it wrote to stderr, where it failed.
    """

    diagnosis: bytes
    motion: bytes
    seconds: float
    error: str


def prepare(spec: CaseSpec | InjectedSpec, salt: str) -> Prepared:
    """Make a case and its answer."""
    if isinstance(spec, InjectedSpec):
        return _prepare_injected(spec, salt)
    try:
        case = generate(spec)
    except DiagnosisError as error:
        return Prepared(case_id(spec), {}, b"", refused=str(error))
    with TemporaryDirectory() as place:
        folder = write_case(case, Path(place) / "cases")
        answer, _ = write_answer(case, Path(place) / "answers", salt)
        files = {path.name: path.read_bytes() for path in sorted(folder.iterdir())}
        return Prepared(folder.name, files, answer.read_bytes())


def _prepare_injected(spec: InjectedSpec, salt: str) -> Prepared:
    try:
        made = inject(spec, salt)
    except FricompError as error:
        return Prepared(spec.name, {}, b"", refused=str(error))
    return Prepared(spec.name, made.files, made.answer)


def prepare_follow_up(spec: CaseSpec | InjectedSpec, motion: bytes) -> Prepared:
    """Record the case's joint once more, on the motion that its diagnosis proposed.

    Args:
        spec: Of the case.
        motion: Table with the columns `time` [s], `position_reference` [rad] and `velocity_reference` [rad/s].
    """
    if isinstance(spec, InjectedSpec):
        return Prepared(spec.name, {}, b"", refused="nobody has the joint of a public recording here")
    try:
        again = record_again(generate(spec), _read_motion(motion))
    except DiagnosisError as error:
        return Prepared(case_id(spec), {}, b"", refused=str(error))
    with TemporaryDirectory() as place:
        folder = write_case(again, Path(place))
        return Prepared(folder.name, {"recording_2.parquet": (folder / "recording.parquet").read_bytes()}, b"")


def _read_motion(motion: bytes) -> np.ndarray:
    """Position and velocity at 1 kHz, at most two minutes of it; shape (n_samples, 2)."""
    header, *rows = motion.decode().splitlines()
    columns = dict(zip(header.split(","), np.loadtxt(rows, delimiter=",", ndmin=2).T, strict=True))
    missing = {"time", "position_reference", "velocity_reference"} - set(columns)
    if missing:
        raise DiagnosisError(f"the proposed motion has no {', '.join(sorted(missing))}; it has {header}")
    time = columns["time"]
    grid = np.arange(time[0], min(time[-1], time[0] + _LONGEST), _PERIOD)
    wanted = [np.interp(grid, time, columns[name]) for name in ("position_reference", "velocity_reference")]
    return np.stack(wanted, axis=1)


def diagnose_blind(files: dict[str, bytes]) -> BlindAnswer:
    """Diagnose the files of one case in another process and a folder that holds nothing else."""
    with TemporaryDirectory() as place:
        folder = Path(place)
        for name, content in files.items():
            (folder / name).write_bytes(content)
        start = time.perf_counter()
        error = _run(folder)
        seconds = time.perf_counter() - start
        return BlindAnswer(_content(folder / "diagnosis.json"), _content(folder / "motion.csv"), seconds, error)


def _run(folder: Path) -> str:
    command = [sys.executable, "-m", "fricomp.sim_bench.studies.blind_diagnosis"]
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


def _content(path: Path) -> bytes:
    return path.read_bytes() if path.exists() else b""
