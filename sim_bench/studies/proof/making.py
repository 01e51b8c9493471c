"""Cases made on a worker, with their names and the commands that make them again."""

from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from fricomp.errors import DiagnosisError, FricompError

from ...cases import CaseSpec, derive_case_id, generate, record_again, write_answer, write_case
from ..real.injection import InjectedSpec, inject

_LONGEST, _PERIOD = 120.0, 1e-3
"""Longest proposed motion that is recorded, and the period of its samples [s]; both are those of planned cases."""


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


def name_case(spec: CaseSpec | InjectedSpec) -> str:
    """A name that says nothing about what is concealed."""
    return spec.name if isinstance(spec, InjectedSpec) else derive_case_id(spec)


def write_command(spec: CaseSpec | InjectedSpec) -> str:
    """The command that makes the case again."""
    if isinstance(spec, InjectedSpec):
        effect = f"--effect {spec.effect} --strength {spec.strength} " if spec.effect else ""
        return f"fricomp cases inject {spec.source} {effect}--seed {spec.seed} --out runs/cases"
    parts = ["fricomp cases make", f"--seed {spec.seed}", *(f"--effect {name}" for name in spec.effects)]
    parts += [f"--strength {spec.strength}", f"--excitation {spec.excitation}", f"--duration {spec.duration:g}"]
    for option in ("noise", "core", "family", "form", "fault"):
        value = getattr(spec, option)
        parts += [f"--{option} {value}"] if value else []
    parts += [f"--{flag}" for flag in ("shifted", "hidden") if getattr(spec, flag)]
    return " ".join([*parts, "--out runs/cases"])


def prepare(spec: CaseSpec | InjectedSpec, salt: str) -> Prepared:
    """Make a case and its answer."""
    if isinstance(spec, InjectedSpec):
        return _prepare_injected(spec, salt)
    try:
        case = generate(spec)
    except DiagnosisError as error:
        return Prepared(name_case(spec), {}, b"", refused=str(error))
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
        return Prepared(spec.name, {}, b"", refused="the joint of a public recording cannot be moved again")
    try:
        again = record_again(generate(spec), _read_motion(motion))
    except DiagnosisError as error:
        return Prepared(name_case(spec), {}, b"", refused=str(error))
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
