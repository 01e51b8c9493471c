"""The way from recordings to a diagnosis: one stage after another, each from values to a value."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.errors import DiagnosisError, ParameterError
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .channels.reading import read_channels, read_held, read_loads
from .course import Course, Progress, conclude, repeat_with_other_noise
from .effects.structure import N_BASE
from .evidence.findings import Findings
from .forward.forward import measure_forward_error
from .inputs.checks import inertia_against
from .inputs.controller import Controller
from .inputs.given import Given, read_given
from .inputs.rigid import RigidJoint
from .joint.base import unpack
from .joint.solver import Fit
from .low_rate.answer import describe_slow_motion, diagnose_low_rate, is_low_rate
from .record.result import Diagnosis, Forward
from .search.settings import SEARCH
from .verdict.experiment import propose_experiment
from .verdict.judging import Verdict, describe_repetitions, join_channels
from .verdict.shared_effect import SimulationEffects
from .verdict.writing import write_diagnosis, write_read_off, write_refusal

_SEVERAL_LOADS = (
    "A simulated joint has one offset and one level of friction, and the measured load changes both: nothing else was "
    "looked for. For the rest, diagnose recordings of one load."
)


def diagnose(
    recordings: Recording | Sequence[Recording],
    simulation: RigidJoint | str | Path | None = None,
    *,
    joint: str | None = None,
    friction: FrictionModel | None = None,
    controller: Controller | None = None,
    thorough: bool = False,
    seed: int = 0,
    names: Sequence[str] | None = None,
    simulation_error: float | None = None,
    progress: Progress | None = None,
) -> Diagnosis:
    """Say what a simulation of a joint leaves out, from recordings of the real one.

    Args:
        recordings: One or several recordings of one joint.
        simulation: MJCF or URDF whose inertia and gravity are compared; None to identify them with the friction. With
            two sessions of all joints of an arm: its kinematics, for a difference in payload.
        joint: Name of the joint in the simulation and in the recordings; None where there is only one.
        friction: Friction model that is compared; None to identify it from the recordings.
        controller: The loop that moved the joint; None to estimate it where the reference was recorded.
        thorough: Repeat the whole diagnosis with other noise in its nulls, and say how often the names come again. The
            answer stays the same.
        seed: Of the bands of the report's maps; names, numbers and errors do not depend on it.
        names: What each recording is called in the answer; None to count them.
        simulation_error: Relative standard deviation by which inertia and gravity of the simulation may be off, 0.2
            where it is None. Departures from the simulation cost by it.
        progress: Called with a few words before each step, and with a first look at what is left.

    Raises:
        DiagnosisError: The simulation cannot be read, or the recordings do not belong together.
    """
    series = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not series:
        raise DiagnosisError("no recording was given: diagnose needs at least one")
    joints = {one.metadata.joint for one in series} - {"", "joint"}
    if len(joints) > 1 and joint is None:
        raise DiagnosisError(
            f"the recordings are of several joints ({', '.join(sorted(joints))}): diagnose one joint at a time, or "
            "give the simulation of the arm to fricomp.examine_arm, and two sessions of it to fricomp.diagnose to "
            "compare payloads"
        )
    if progress is not None:
        progress("checking the data")
    given = read_given(
        series, simulation, joint=joint, friction=friction, controller=controller, names=names,
        simulation_error=simulation_error,
    )  # fmt: skip
    return diagnose_given(given, thorough=thorough, seed=seed, progress=progress)


def diagnose_given(
    given: Given,
    simulated: SimulationEffects | None = None,
    *,
    thorough: bool = False,
    seed: int = 0,
    progress: Progress | None = None,
) -> Diagnosis:
    """Run the stages on checked inputs.

    Args:
        given: Recordings and what they are compared with.
        simulated: Effects that the simulation has itself; None where nobody looked for them.
        thorough: Repeat the whole diagnosis with other noise, and say how often the names come again.
        seed: Of the bands of the report's maps.
        progress: Called with a few words before each step, and with a first look at what is left.

    Raises:
        DiagnosisError: No joint model explains the recordings.
    """
    return replace(_run_stages(given, simulated, thorough, seed, progress), data=given.data)


# Points of a search that do not simulate overflow; they are left out where they come up.
@np.errstate(over="ignore", invalid="ignore")
@one_blas_thread()
def _run_stages(
    given: Given, simulated: SimulationEffects | None, thorough: bool, seed: int, progress: Progress | None
) -> Diagnosis:
    told = () if simulated is None else simulated.remarks
    if given.reasons:
        held = read_held(given.recordings) if len(given.reasons) == len(given.recordings) else ()
        write = partial(write_read_off, given, held) if held else partial(write_refusal, given)
        return write(given.reasons, told)
    loaded = read_loads(given.recordings)
    if loaded:
        return write_read_off(given, loaded, (_SEVERAL_LOADS,), (*given.remarks, *told))
    if is_low_rate(given.recordings):
        return diagnose_low_rate(given, told, progress)
    course = Course(given, simulated, seed, progress)
    try:
        base = course.choose_base()
        course.tell("fitting the base model and simulating nulls")
        try:
            baseline = base(tell=course.tell)
        except DiagnosisError as error:
            shown = read_channels(given.recordings)
            if not shown:
                raise
            return write_read_off(given, shown, (f"No joint model: {error}.",), (*given.remarks, *told))
        reasons = _check_inertia(given, baseline.fit)
        if reasons and baseline.noise_ratio < SEARCH.bent:
            return write_refusal(given, reasons, told)
        findings, verdict, delivery = conclude(course, baseline, base)
        reasons = _check_inertia(given, (findings.chosen or findings.case.baseline).fit)
        if reasons:
            return write_refusal(given, reasons, told)
        others = repeat_with_other_noise(course) if thorough else ()
        remarks = (*given.remarks, *describe_repetitions(verdict, others))
        verdict = join_channels(verdict, read_channels(given.recordings))
        if verdict.sample is not None:
            return write_diagnosis(findings, verdict, delivery, remarks=remarks)
        remarks += _look_at_slow_motion(course, verdict)
        proposal = propose_experiment(findings)
        course.tell("simulating forward in MuJoCo")
        forward = _simulate_forward(given, findings)
        return write_diagnosis(findings, verdict, delivery, proposal, forward, remarks)
    except (np.linalg.LinAlgError, FloatingPointError, ParameterError) as error:
        raise DiagnosisError(f"the recording cannot be explained by any joint model: {error}") from error


def _look_at_slow_motion(course: Course, verdict: Verdict) -> tuple[str, ...]:
    """What the slow motion alone hints at where no physics could be named."""
    if verdict.word != "unknown_physics" or any(one.kind == "physics" for one in verdict.effects):
        return ()
    course.tell("looking at the slow motion alone")
    return describe_slow_motion(course.given)


def _check_inertia(given: Given, fit: Fit) -> list[str]:
    """Why the recordings cannot be of the simulation's joint by this fit of it; empty where they can. A base that
    leaves much may have been bent that far by what it lacks, as by a stop."""
    plant = unpack(fit.theta[:N_BASE])
    return [] if given.rigid is None else inertia_against(plant.inertia, given.rigid.inertia)


def _simulate_forward(given: Given, findings: Findings) -> Forward | None:
    """Simulate the held-out end of the first recording; None where no loop is known."""
    loop, chosen = given.loops[0], findings.chosen if findings.held.explained > 0.0 else None
    return None if loop is None else measure_forward_error(given.recordings[0], findings.case.baseline, chosen, loop)
