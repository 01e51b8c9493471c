"""The way from recordings to a verdict: checks, base, nulls, screening, joint refit, confirmation, verdict."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
from msgspec.structs import replace as with_fields

from fricomp.errors import DiagnosisError, ParameterError
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .evidence.answer import Answer
from .forward.forward import measure_forward_error
from .inputs.checks import inertia_against, kind_against, reasons_against, remarks_on
from .inputs.controller import Controller, estimate_controller
from .inputs.controller_check import check_controller
from .inputs.rigid import RigidJoint, read_simulation
from .joint.base import unpack
from .joint.loading import build_tracks, has_low_rate
from .joint.observer import Observer
from .joint.weak_form import estimate_rest_speed
from .payload import diagnose_arm
from .record.result import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord
from .record.sentence import forward_sentence
from .samples.second_look import second_look
from .search.late_creep import has_late_creep
from .search.preparation import Baseline, prepare
from .search.search import SearchResult, search
from .verdict.verdict import agreed, conclude

__all__ = ["diagnose", "with_remarks"]

_NULLS, _NULLS_THOROUGH = 32, 200
_RESTING = 0.6  # of the slowest speed that counts as sliding
_SLOW_BANDWIDTH = 30.0  # [rad/s] observer for recordings below 300 Hz


# Points of a search that do not simulate overflow; they are left out where they come up.
@np.errstate(over="ignore", invalid="ignore")
def diagnose(
    recordings: Recording | Sequence[Recording],
    simulation: RigidJoint | str | Path | None = None,
    *,
    joint: str | None = None,
    friction: FrictionModel | None = None,
    controller: Controller | None = None,
    thorough: bool = False,
    seed: int = 0,
    progress: Callable[[str], None] | None = None,
) -> Diagnosis:
    """Say what a simulation of a joint leaves out, from recordings of the real one.

    Args:
        recordings: One or several recordings of one joint.
        simulation: MJCF or URDF whose inertia and gravity are compared; None to identify them with the friction. With
            two sessions of all joints of an arm: its kinematics, for a difference in payload.
        joint: Name of the joint in the simulation and in the recordings; None where there is only one.
        friction: Friction model that is compared; None to identify it from the recordings.
        controller: The loop that moved the joint; None to estimate it where the reference was recorded.
        thorough: Use more nulls for the thresholds.
        seed: Of the nulls and bootstraps; the same seed gives the same answer.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: The simulation cannot be read, or the recordings do not belong together.
    """
    say = progress or (lambda _: None)
    given = [recordings] if isinstance(recordings, Recording) else list(recordings)
    if not given:
        raise DiagnosisError("no recording was given: diagnose needs at least one")
    names = {one.metadata.joint for one in given} - {"", "joint"}
    if len(names) > 1 and joint is None:
        return _arm(given, simulation, names)
    rigid = (
        simulation if isinstance(simulation, RigidJoint) or simulation is None else read_simulation(simulation, joint)
    )
    say("checking the data")
    against = [*reasons_against(given, joint), *(kind_against(given, rigid.rotary) if rigid is not None else ())]
    if against:
        return _bad_data(given, against)
    remarks, given = remarks_on(given), [one.on_joint_side() for one in given]
    remarks += [] if controller is None else check_controller(controller, given)
    loops = [estimate_controller(one) if controller is None else controller for one in given]
    known = _in_newton_metres(given, rigid)
    tracks = build_tracks(given, loops, None if known is None else known.spring)
    observer = Observer(rest_speed=_RESTING * estimate_rest_speed(tracks))
    observer = replace(observer, bandwidth=_SLOW_BANDWIDTH) if has_low_rate(given) else observer
    try:
        say("fitting the base model and simulating nulls")
        count = _NULLS_THOROUGH if thorough else _NULLS
        base = partial(prepare, tracks, observer=observer, nulls=count, seed=seed, rigid=known)
        prepared = base()
        against = [] if known is None else inertia_against(unpack(prepared.fit.theta).inertia, known.inertia)
        if against:
            return _bad_data(given, against)
        say("searching for effects")
        found = search(prepared)
        if has_late_creep(prepared, found):
            say("searching again, with friction that creeps")
            prepared = base(creeps=True)
            found = search(prepared)
        say("confirming on held-out data")
        answer = agreed(Answer(tuple(given), prepared, found, known, friction, seed))
        concluded = conclude(answer)
        looked = second_look(given, concluded, seed)
        if looked is concluded:
            say("simulating forward in MuJoCo")
            looked = _with_forward(looked, given[0], prepared, answer.found, loops[0])
        return with_remarks(looked, [*remarks, *_not_compared(given, rigid, known)])
    except (np.linalg.LinAlgError, FloatingPointError, ParameterError) as error:
        raise DiagnosisError(f"the recording cannot be explained by any joint model: {error}") from error


def _arm(recordings: Sequence[Recording], simulation: RigidJoint | str | Path | None, names: set[str]) -> Diagnosis:
    """Recordings of several joints: two sessions of an arm, in which its payload may differ."""
    if simulation is None or isinstance(simulation, RigidJoint):
        raise DiagnosisError(
            f"the recordings are of several joints ({', '.join(sorted(names))}): diagnose one joint at a time, or give "
            "two sessions of all joints and the simulation of the arm to compare payloads"
        )
    against = [
        f"{recording.metadata.joint}: {reason}"
        for recording in recordings
        for reason in reasons_against([recording], None)
    ]
    if against:
        return _bad_data(recordings, against)
    return diagnose_arm([one.on_joint_side() for one in recordings], simulation)


def _in_newton_metres(recordings: Sequence[Recording], rigid: RigidJoint | None) -> RigidJoint | None:
    """The simulation's joint where its inertia is in the unit of the recorded torque."""
    return rigid if all(one.metadata.torque_unit in ("N·m", "N") for one in recordings) else None


def _not_compared(
    recordings: Sequence[Recording], given: RigidJoint | None, known: RigidJoint | None
) -> tuple[str, ...]:
    if given is None or known is not None:
        return ()
    unit = recordings[0].metadata.torque_unit
    return (
        f"The torque is in {unit}: inertia, gravity and any spring of the simulation were not compared, they are "
        "fitted.",
    )


def _with_forward(
    diagnosis: Diagnosis, recording: Recording, prepared: Baseline, found: SearchResult, loop: Controller | None
) -> Diagnosis:
    """The diagnosis with a forward simulation of the held-out end of the first recording, where a loop is known."""
    if loop is None:
        return diagnosis
    named = {effect.name for effect in diagnosis.effects}  # without the overtones of a ripple
    held = diagnosis.record.heldout
    confirmed = held is not None and held.explained > 0.0 and held.before == "refitted"
    chosen = found.best if found.best is not None and confirmed and named & set(found.best.names) else None
    forward = measure_forward_error(recording, prepared, chosen, loop)
    if forward is None:
        return diagnosis
    record = with_fields(diagnosis.record, forward=forward)
    return replace(diagnosis, record=with_fields(record, sentences=(*record.sentences, forward_sentence(forward))))


def with_remarks(diagnosis: Diagnosis, remarks: Sequence[str]) -> Diagnosis:
    """The diagnosis with what the checks of the data noticed, last."""
    if not remarks:
        return diagnosis
    record = with_fields(diagnosis.record, sentences=(*diagnosis.sentences, *remarks))
    return replace(diagnosis, record=record)


def _bad_data(recordings: Sequence[Recording], reasons: Sequence[str]) -> Diagnosis:
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict="bad_data",
        sentences=("The data cannot be diagnosed.", *reasons),
        recordings=tuple(f"recording {i + 1}" for i in range(len(recordings))),
        joint=recordings[0].metadata.joint,
    )
    return Diagnosis(record)
