"""The work that is timed: diagnoses, identifications, files, and other packages on the same data."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fricomp.calibration import identify
from fricomp.calibration.batch.identification import identify_batch
from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.identify import MotionIdentification, identify_motion
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.calibration.motion.parts import read_motion_recording
from fricomp.diagnosis import diagnose
from fricomp.errors import DiagnosisError
from fricomp.recording import Recording, read_recording, write_recording

from ...cases import CaseSpec
from ..identification.throughput import draw_joints
from ..proof.baselines.data import load_data
from ..proof.baselines.methods import sysid_parameters
from ..proof.making import prepare

__all__ = ["Peer", "SpeedCase", "list_peers", "list_work", "make_case"]

Samples = NDArray[np.float64]
Work = tuple[str, str, float, Callable[[], object]]
"""Group, name, size and what is called."""

_EFFECTS: dict[int, tuple[str, ...]] = {0: (), 1: ("cogging",), 2: ("load_coulomb", "end_stop")}
_NAMES = ("nothing missing", "one effect", "two effects")


@dataclass(frozen=True)
class SpeedCase:
    """A joint of the generator, in a folder.

    Attributes:
        folder: With recording and simulation.
        recording: Read.
    """

    folder: Path
    recording: Recording

    def diagnose(self, every: int = 1) -> object:
        """Diagnose it, with every so manieth sample."""
        return diagnose(self.recording.rows(slice(None, None, every)), self.folder / "joint.xml")


@dataclass(frozen=True)
class Peer:
    """Another package on the same data.

    Attributes:
        name: Of the package and what it fits.
        ours: What of the timings it stands beside.
        call: Run it; None where it is not installed.
    """

    name: str
    ours: str
    call: Callable[[], object] | None


def make_case(effects: int, duration: float, folder: Path) -> SpeedCase:
    """A joint with so many effects, each clear, recorded at 1 kHz for `duration` [s].

    Raises:
        DiagnosisError: It cannot be made.
    """
    made = prepare(CaseSpec(70 + effects, _EFFECTS[effects], duration=duration, noise="white"), "speed")
    if made.refused:
        raise DiagnosisError(f"the case to be timed cannot be made: {made.refused}")
    folder.mkdir(parents=True, exist_ok=True)
    for name, content in made.files.items():
        (folder / name).write_bytes(content)
    return SpeedCase(folder, read_recording(folder / "recording.parquet"))


def list_work(folder: Path, *, quick: bool) -> Iterator[Work]:
    """Everything that is timed, each made right before it is yielded."""
    yield from _list_diagnoses(folder, quick)
    for count in (10_000, 100_000) if quick else (10_000, 100_000, 1_000_000):
        yield "identify: points", f"identify, {count} points", count, partial(identify, *draw_points(count))
    identify_batch(*draw_joints(2, seed=0))  # torch is loaded
    for joints in (10, 100) if quick else (10, 100, 1000):
        call = partial(identify_batch, *draw_joints(joints, seed=0))
        yield "identify: joints", f"{joints} joints in one call", joints, call
    yield from _list_files(folder, quick)


def _list_diagnoses(folder: Path, quick: bool) -> Iterator[Work]:
    durations = (10.0, 20.0, 40.0) if quick else (30.0, 60.0, 120.0)
    middle = durations[1]
    case = make_case(0, middle, folder / "warm")
    case.diagnose(4)  # kernels are compiled and packages loaded
    for every in (1, 2, 4):
        rate = 1000.0 / every
        yield (
            "diagnosis: rate [Hz]",
            f"nothing missing, {middle:g} s at {rate:g} Hz",
            rate,
            partial(case.diagnose, every),
        )
    for duration in durations:
        case = make_case(0, duration, folder / f"null{duration:g}")
        yield "diagnosis: duration [s]", f"nothing missing, {duration:g} s", duration, case.diagnose
    for effects in (0, 1, 2):
        case = make_case(effects, middle, folder / f"effects{effects}")
        yield "diagnosis: 1 + effects", f"{_NAMES[effects]}, {middle:g} s", 1.0 + effects, case.diagnose


def _list_files(folder: Path, quick: bool) -> Iterator[Work]:
    for count in (100_000,) if quick else (100_000, 1_000_000):
        path, recording = folder / f"{count}.csv", draw_recording(count)
        write_recording(recording, path)
        yield "CSV: samples", f"read_recording, {count} samples", count, partial(read_recording, path)
        call = partial(_identify_recording, recording)
        yield "identify: samples", f"identify, {count} samples", count, call


def _identify_recording(recording: Recording) -> MotionIdentification:
    """Checks, filters, rigid body and friction, as `fricomp.identify` has them."""
    checked = read_motion_recording(recording).recording
    settings = choose_settings(checked, gravity=True)
    return identify_motion(sample_joint(checked, settings), settings)


def draw_points(count: int) -> tuple[Samples, Samples]:
    """Velocities [rad/s] and torques [N·m] of a Stribeck curve with one percent of noise. Shapes (count,)."""
    random = np.random.default_rng(0)
    velocity = np.exp(random.uniform(np.log(0.003), np.log(3.0), count)) * random.choice([-1.0, 1.0], count)
    clean = compute_friction(np.abs(velocity), 0.8, 1.2, 0.05, 0.3)
    return velocity, np.sign(velocity) * clean * (1.0 + 0.01 * random.standard_normal(count))


def compute_friction(speed: Samples, coulomb: float, static: float, stribeck: float, viscous: float) -> Samples:
    """Stribeck curve [N·m] over speed [rad/s]."""
    return np.asarray(coulomb + (static - coulomb) * np.exp(-((speed / stribeck) ** 2)) + viscous * speed)


def draw_recording(count: int) -> Recording:
    """A joint that swings, with inertia, gravity, friction and noise, at 1 kHz."""
    time = np.arange(count, dtype=np.float64) * 1e-3
    rates, sizes = (0.3, 0.77, 1.9), (1.0, 0.4, 0.1)
    angles = [2.0 * np.pi * rate * time for rate in rates]
    position = sum(size * np.sin(angle) for size, angle in zip(sizes, angles, strict=True))
    velocity = sum(
        2.0 * np.pi * rate * size * np.cos(angle) for rate, size, angle in zip(rates, sizes, angles, strict=True)
    )
    bend = sum(
        -((2.0 * np.pi * rate) ** 2) * size * np.sin(angle)
        for rate, size, angle in zip(rates, sizes, angles, strict=True)
    )
    speed = np.asarray(velocity)
    friction = np.sign(speed) * compute_friction(np.abs(speed), 0.8, 1.2, 0.05, 0.3)
    noise = 0.01 * np.random.default_rng(0).standard_normal(count)
    torque = 0.1 * np.asarray(bend) + 2.0 * np.cos(position) + friction + noise
    return Recording(time=time, position=np.asarray(position), torque=np.asarray(torque))


def list_peers(folder: Path, *, quick: bool) -> list[Peer]:
    """Other packages on data of the timings; bam and pandas only where they are installed."""
    from scipy.optimize import curve_fit

    points, seconds = 100_000, 20.0 if quick else 60.0
    velocity, torque = draw_points(points)
    side = velocity > 0.0
    case = make_case(0, seconds, folder / "peer")
    data = load_data(case.folder)
    count = 100_000 if quick else 1_000_000
    path = folder / f"{count}.csv"
    pandas = None
    if find_spec("pandas") is not None and path.exists():
        from pandas import read_csv

        pandas = partial(read_csv, path, comment="#")
    fit = partial(curve_fit, compute_friction, velocity[side], torque[side], p0=(1.0, 1.5, 0.1, 0.5))
    return [
        Peer("scipy.optimize.curve_fit, one direction, no choice of noise", f"identify, {points} points", fit),
        Peer(
            "mujoco.sysid, five parameters of the rigid joint, no effects",
            f"nothing missing, {seconds:g} s",
            partial(sysid_parameters, data),
        ),
        Peer("pandas.read_csv", f"read_recording, {count} samples", pandas),
        Peer("bam, Stribeck model", f"identify, {points} points", None),
    ]
