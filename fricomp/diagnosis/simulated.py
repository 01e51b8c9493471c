"""The diagnosis against the user's own simulation, known only by a recording that it made under the same commands."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.recording import Recording

from .course import Progress
from .diagnose import diagnose, diagnose_given
from .inputs.checks import reasons_against
from .inputs.controller import Controller
from .inputs.given import read_given
from .record.result import Diagnosis
from .simulated_joint import read_simulated
from .verdict.shared_effect import SimulationEffects

__all__ = ["compare_motions", "diagnose_against"]

_MECHANICAL = {"N·m", "N"}


@dataclass(frozen=True)
class MotionSettings:
    """When a simulated recording is told to have another motion than the recorded one.

    Attributes:
        short: Part of the recording's duration below which the simulated one is told to be shorter.
        same_motion: Difference of the positions, over their standard deviation, from which the motions are others.
            Unrelated motions of one size differ by the square root of two; the same one by how differently two joints
            follow a command.
    """

    short: float = 0.8
    same_motion: float = 0.5


SETTINGS = MotionSettings()


def diagnose_against(
    recordings: Recording | Sequence[Recording],
    simulated: Recording,
    *,
    joint: str | None = None,
    controller: Controller | None = None,
    thorough: bool = False,
    seed: int = 0,
    names: Sequence[str] | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Say what a simulation of a joint leaves out that is known only by what it recorded under the same commands.

    Args:
        recordings: One or several recordings of the real joint.
        simulated: What the simulator recorded; it needs no noise.
        joint: Name of the joint in the recordings; None to take any.
        controller: The loop that moved the real joint; None to estimate it where the reference was recorded.
        thorough: Repeat the whole diagnosis with other noise, and say how often the names come again.
        seed: Of the bands of the report's maps; names, numbers and errors do not depend on it.
        names: What each recording is called in the answer; None to count them.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: No joint can be read off the simulated recording, or the recordings do not belong together.
    """
    series = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if reasons_against(series, joint):
        return diagnose(series, joint=joint, names=names)  # which says so
    alike = _have_one_unit(simulated, series)
    if progress is not None:
        progress("reading the simulation from its recording")
    known = read_simulated(simulated, series, progress=progress)
    friction = known.friction if alike else None
    given = read_given(series, known.rigid, joint=joint, friction=friction, controller=controller, names=names)
    remarks = (*known.remarks, *compare_motions(series, simulated))
    own = SimulationEffects(known.effects, sure=known.noise_ratio is None, remarks=remarks)
    return diagnose_given(given, own, thorough=thorough, seed=seed, progress=progress)


def _have_one_unit(simulated: Recording, recordings: Sequence[Recording]) -> bool:
    """Whether the torques are in one unit; with currents the simulation's friction cannot be compared.

    Raises:
        DiagnosisError: Only the simulated torque is none in N·m or N.
    """
    own, *others = (one.on_joint_side().metadata.torque_unit for one in (simulated, *recordings))
    if own not in _MECHANICAL and set(others) <= _MECHANICAL:
        raise DiagnosisError(
            f"the simulated torque is in {own} and the recorded one in {others[0]}: let the simulator record N·m or N"
        )
    return set(others) == {own}


def compare_motions(recordings: Sequence[Recording], simulated: Recording) -> tuple[str, ...]:
    """Say where a simulated recording was not made under the commands of the recordings, in sentences."""
    longest = max(one.duration for one in recordings)
    if simulated.duration < SETTINGS.short * longest:
        return (
            f"The simulated recording lasts {simulated.duration:.3g} s and the recording {longest:.3g} s: what it says "
            "about the simulation holds for the part of the motion that it has.",
        )
    apart = min(_measure_distance(one, simulated) for one in recordings)
    if apart < SETTINGS.same_motion:
        return ()
    return (
        f"The simulated recording has another motion (positions at the same times differ by {apart:.2g} times the "
        "spread of the recorded ones): let the simulator follow the same commands, since a motion that shows less of "
        "its joint leaves the comparison in doubt.",
    )


def _measure_distance(recording: Recording, simulated: Recording) -> float:
    """RMS difference of the positions at the same time since the start, over the standard deviation of the recorded."""
    time = np.asarray(recording.time) - recording.time[0]
    shared = time <= simulated.duration
    moved = np.interp(time[shared], np.asarray(simulated.time) - simulated.time[0], np.asarray(simulated.position))
    position = np.asarray(recording.position)[shared]
    return float(np.sqrt(np.mean((moved - position) ** 2)) / max(float(np.std(position)), 1e-12))
