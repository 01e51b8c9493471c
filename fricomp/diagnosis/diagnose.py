"""The way from recordings to a diagnosis: one stage after another, each from values to a value."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.errors import DiagnosisError, ParameterError
from fricomp.evaluation.motion import find_band
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .channels.reading import read_channels, read_held, read_loads
from .delivery.models import Delivery
from .effects.structure import N_BASE
from .evidence.alias import measure_late_rival
from .evidence.case import Case
from .evidence.findings import Findings, collect_findings, prefer_simulation
from .forward.forward import measure_forward_error
from .inputs.checks import inertia_against
from .inputs.controller import Controller
from .inputs.given import Given, read_given
from .inputs.late_action import find_late_action
from .inputs.rigid import RigidJoint
from .inputs.track import Track
from .joint.base import unpack
from .joint.loading import build_tracks, has_low_rate
from .joint.observer import Observer
from .joint.settings import JOINT
from .joint.solver import Fit
from .joint.weak_form import estimate_rest_speed
from .low_rate.answer import describe_slow_motion, diagnose_low_rate, is_low_rate
from .record.result import Diagnosis, Forward
from .samples.second_look import look_into_samples, remove_ripple
from .search.late_torque import measure_late_torque
from .search.preparation import Baseline, prepare
from .search.rounds import search_in_rounds
from .search.settings import SEARCH
from .verdict.delivering import deliver, leave_out_worse
from .verdict.experiment import propose_experiment
from .verdict.judging import Verdict, describe_repetitions, join_channels, judge, judge_beside
from .verdict.late_rival import choose_late, leaves_noise_alone
from .verdict.shared_effect import SimulationEffects
from .verdict.writing import write_diagnosis, write_read_off, write_refusal

__all__ = ["diagnose", "diagnose_given"]

Progress = Callable[[str], None]


@dataclass(frozen=True)
class StageSettings:
    """How the stages are run.

    Attributes:
        nulls: Recordings with nothing missing that are simulated for weights and thresholds. The more there are, the
            better the threshold is known that 98 % of them stay below, and the longer a diagnosis takes.
        draws: Seed of their noise. It is the same for every recording and every user (common random numbers), so that
            chance does not decide between two answers to the same data.
        other_draws: Whole diagnoses by other noise that a thorough one is held against.
        resting: Rest speed of the observer over the slowest speed that counts as sliding. Below it a model that rests
            is led back to the recorded position; a larger part would lead slow sliding back as well.
        slow_bandwidth: Bandwidth of the observer [rad/s] for recordings below some 300 Hz, whose steps a faster one
            could not follow.
        noise_share: Part of the acceleration's power that may be noise of the encoder in a row. An inertia comes out
            too small by it, and a loop that answers the noise takes its share for the motion's.
        widest_row: Widest row [s], about that of slow recordings: a wider one holds a whole stroke.
    """

    nulls: int = 32
    draws: int = 0
    other_draws: int = 3
    resting: float = 0.6
    slow_bandwidth: float = 30.0
    noise_share: float = 0.01
    widest_row: float = 0.17


SETTINGS = StageSettings()

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
    _report(progress, "checking the data")
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
    try:
        base = _choose_base(given, SETTINGS.draws)
        _report(progress, "fitting the base model and simulating nulls")
        try:
            baseline = base(tell=partial(_report, progress))
        except DiagnosisError as error:
            shown = read_channels(given.recordings)
            if not shown:
                raise
            return write_read_off(given, shown, (f"No joint model: {error}.",), (*given.remarks, *told))
        reasons = _check_inertia(given, baseline.fit)
        if reasons and baseline.noise_ratio < SEARCH.bent:
            return write_refusal(given, reasons, told)
        answer = _answer(given, baseline, base, simulated, seed, progress)
        findings, verdict = _weigh_late_action(given, answer, simulated, seed, progress)
        reasons = _check_inertia(given, (findings.chosen or findings.case.baseline).fit)
        if reasons:
            return write_refusal(given, reasons, told)
        others = _repeat_with_other_noise(given, simulated, progress) if thorough else ()
        findings, verdict, delivery = _hold_to_files(given, (findings, verdict), simulated, progress)
        remarks = (*given.remarks, *describe_repetitions(verdict, others))
        verdict = join_channels(verdict, read_channels(given.recordings))
        if verdict.sample is not None:
            return write_diagnosis(findings, verdict, delivery, remarks=remarks)
        remarks += _look_at_slow_motion(given, verdict, progress)
        proposal = propose_experiment(findings)
        _report(progress, "simulating forward in MuJoCo")
        forward = _simulate_forward(given, findings)
        return write_diagnosis(findings, verdict, delivery, proposal, forward, remarks)
    except (np.linalg.LinAlgError, FloatingPointError, ParameterError) as error:
        raise DiagnosisError(f"the recording cannot be explained by any joint model: {error}") from error


def _look_at_slow_motion(given: Given, verdict: Verdict, progress: Progress | None) -> tuple[str, ...]:
    """What the slow motion alone hints at where no physics could be named."""
    if verdict.word != "unknown_physics" or any(one.kind == "physics" for one in verdict.effects):
        return ()
    _report(progress, "looking at the slow motion alone")
    return describe_slow_motion(given)


def _answer(
    given: Given,
    baseline: Baseline,
    base: Callable[..., Baseline],
    simulated: SimulationEffects | None,
    seed: int,
    progress: Progress | None,
) -> tuple[Findings, Verdict]:
    """Search from this base, and judge what is found."""
    baseline, found = search_in_rounds(baseline, base, SETTINGS.draws, partial(_report, progress))
    case = Case(given.recordings, baseline, found, given.rigid, given.friction, SETTINGS.draws, seed)
    return _judge_case(given, case, simulated, progress)


def _weigh_late_action(
    given: Given,
    answer: tuple[Findings, Verdict],
    simulated: SimulationEffects | None,
    seed: int,
    progress: Progress | None,
) -> tuple[Findings, Verdict]:
    """Answer once more with the torque moved to where it may act, where the joint asks for that; keep what leaves less.

    From there the base may move it back, so that a lag which looks like a delay from afar is found as one; and a lag
    that is named may be a delay, as may what bends a base whose own delay is at its bound, where that takes no other
    names. Where the torque need not act late after all, the search has only begun elsewhere, and may name what it
    finds.
    """
    usual = -min(track.delays[0] for track in answer[0].case.baseline.problem.tracks)
    acts_late = find_late_action(given.recordings, usual) or measure_late_rival(answer[0].case.found)
    shows = acts_late > 0.0
    if not shows:
        lags = [one.parameters["time_constant"].value for one in answer[1].effects if one.name == "drive_lag"]
        if leaves_noise_alone(answer[1]) and not lags:
            return answer
        findings = answer[0]
        acts_late = measure_late_torque(findings.case.baseline, findings.chosen) or max(lags, default=0.0)
    if acts_late <= usual:
        return answer
    _report(progress, "searching with the torque where it acts")
    base = _choose_base(given, SETTINGS.draws, acts_late)
    findings, verdict = _answer(given, base(), base, simulated, seed, progress)
    return choose_late((findings, verdict), answer, usual, shows=shows)


def _choose_base(given: Given, draws: int, acts_late: float = 0.0) -> Callable[..., Baseline]:
    """What fits the base to the recordings, with this seed of the nulls' noise."""
    tracks = _build_tracks(given, acts_late)
    base = partial(prepare, tracks, observer=_choose_observer(given, tracks), seed=draws, rigid=given.rigid)
    return partial(base, nulls=SETTINGS.nulls)


def _judge_case(
    given: Given, case: Case, simulated: SimulationEffects | None, progress: Progress | None
) -> tuple[Findings, Verdict]:
    """Collect the evidence, and judge it; once more beside a ripple that only the samples show.

    Such a ripple is louder than the rows tell, and hides from them what else is missing.
    """
    _report(progress, "confirming on held-out data")
    findings = collect_findings(prefer_simulation(case))
    verdict = judge(findings, look_into_samples(findings), simulated)
    if verdict.sample is None or not verdict.sample.waves:
        return findings, verdict
    _report(progress, "searching beside the ripple")
    base = _choose_base(replace(given, recordings=remove_ripple(given.recordings, verdict.sample)), case.seed)
    baseline, found = search_in_rounds(base(), base, case.seed, partial(_report, progress))
    findings = collect_findings(prefer_simulation(replace(case, baseline=baseline, found=found)))
    return findings, judge_beside(findings, verdict.sample, simulated)


def _hold_to_files(
    given: Given, answer: tuple[Findings, Verdict], simulated: SimulationEffects | None, progress: Progress | None
) -> tuple[Findings, Verdict, Delivery | None]:
    """The answer with the models that are handed over with it; another one where these do not bear it out."""
    findings, verdict = answer
    delivery = deliver(findings, verdict, given.whole)
    while without := leave_out_worse(findings, verdict, delivery):
        findings, verdict = _judge_case(given, replace(findings.case, found=without), simulated, progress)
        delivery = deliver(findings, verdict, given.whole)
    return findings, verdict, delivery


def _repeat_with_other_noise(
    given: Given, simulated: SimulationEffects | None, progress: Progress | None
) -> tuple[Verdict, ...]:
    """Judge the same recordings by nulls of other noise."""
    verdicts = []
    for draws in range(SETTINGS.draws + 1, SETTINGS.draws + 1 + SETTINGS.other_draws):
        base = _choose_base(given, draws)
        baseline, found = search_in_rounds(base(), base, draws, partial(_report, progress))
        case = Case(given.recordings, baseline, found, given.rigid, given.friction, draws)
        verdicts.append(_judge_case(given, case, simulated, progress)[1])
    return tuple(verdicts)


def _report(progress: Progress | None, words: str) -> None:
    if progress is not None:
        progress(words)


def _build_tracks(given: Given, acts_late: float = 0.0) -> list[Track]:
    """The recordings on one grid, by their names, without the torque of a spring that the simulation has."""
    spring = None if given.rigid is None else given.rigid.spring
    tracks = build_tracks(given.recordings, given.loops, spring, acts_late, given.pasts)
    return [replace(track, name=name) for track, name in zip(tracks, given.names, strict=True)]


def _choose_observer(given: Given, tracks: Sequence[Track]) -> Observer:
    """An observer that knows rest from sliding, is slow where the recordings are, and follows no encoder's noise."""
    band = min(find_band(one, SETTINGS.noise_share) for one in given.recordings)
    width = min(max(JOINT.row_width, 1.0 / band), SETTINGS.widest_row)
    observer = Observer(rest_speed=SETTINGS.resting * estimate_rest_speed(tracks, width), width=width)
    fastest = SETTINGS.slow_bandwidth if has_low_rate(given.recordings) else observer.bandwidth
    return replace(observer, bandwidth=min(fastest, JOINT.settled / width))


def _check_inertia(given: Given, fit: Fit) -> list[str]:
    """Why the recordings cannot be of the simulation's joint by this fit of it; empty where they can. A base that
    leaves much may have been bent that far by what it lacks, as by a stop."""
    plant = unpack(fit.theta[:N_BASE])
    return [] if given.rigid is None else inertia_against(plant.inertia, given.rigid.inertia)


def _simulate_forward(given: Given, findings: Findings) -> Forward | None:
    """Simulate the held-out end of the first recording; None where no loop is known."""
    loop, chosen = given.loops[0], findings.chosen if findings.held.explained > 0.0 else None
    return None if loop is None else measure_forward_error(given.recordings[0], findings.case.baseline, chosen, loop)
