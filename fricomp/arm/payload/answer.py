"""From recordings to the answer on what an arm carries, in numbers and in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

import numpy as np

from fricomp.blas import one_blas_thread
from fricomp.diagnosis.inputs.checks import reasons_against
from fricomp.diagnosis.inputs.given import Given
from fricomp.diagnosis.record.result import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord, NamedEffect, Quantity
from fricomp.diagnosis.record.sentence import Notes, write_record
from fricomp.diagnosis.samples.sample_finding import compute_held_out
from fricomp.diagnosis.verdict.writing import write_refusal
from fricomp.errors import DiagnosisError, SimulationFileError
from fricomp.recording import Recording

from ..fit import Z95
from ..left_out.still import find_still
from ..rigid.simulated_arm import read_arm
from .estimate import Payload, find_payload
from .rows import Session
from .settings import SETTINGS


def group_sessions(recordings: Sequence[Recording]) -> list[Session]:
    """Recordings of all joints at once, grouped: a new session begins where a joint comes for another time."""
    sessions: list[Session] = []
    for recording in recordings:
        name = recording.metadata.joint
        if not sessions or name in sessions[-1]:
            sessions.append({})
        sessions[-1][name] = recording
    return sessions


@one_blas_thread()
def diagnose_payload(
    recordings: Sequence[Recording],
    simulation: str | Path,
    names: Sequence[str] | None = None,
    *,
    match: Mapping[str, str] | None = None,
) -> Diagnosis:
    """Say what an arm carries at its end: more than in its first session, or more than its simulation.

    Args:
        recordings: Two sessions of all joints, one after the other; or one, which is compared with the simulation.
        simulation: MJCF or URDF of the arm. Of two sessions it gives the kinematics alone; of one its links must weigh
            what it says, as in the `arm.xml` of a session without the payload.
        names: What each recording is called; None for its session and its joint.
        match: Names in the simulation by names in the recordings, where they differ.

    Raises:
        DiagnosisError: The recordings are not one or two sessions of the same joints, or no joint's torque is in N·m.
        SimulationFileError: The simulation cannot be read, or lacks a joint.
    """
    recordings, apart = _leave_still(recordings)
    reasons = [f"{one.metadata.joint}: {reason}" for one in recordings for reason in reasons_against([one], None)]
    if reasons:
        called = tuple(names or (f"recording {i + 1}" for i in range(len(recordings))))
        return write_refusal(Given(tuple(recordings), called), reasons)
    sessions = group_sessions([one.on_joint_side() for one in recordings])
    joints = list(sessions[0])
    if len(sessions) > 2 or any(set(one) != set(joints) for one in sessions):
        told = "; ".join(", ".join(one) for one in sessions)
        raise DiagnosisError(f"a payload is found from one or two sessions with the same joints; got {told}")
    given = {name: there for name, there in (match or {}).items() if name in joints}
    arm = read_arm(simulation, joints, given, _place_apart(simulation, joints, apart, match))
    renamed = [dict(zip(arm.joints, (one[name] for name in joints), strict=True)) for one in sessions]
    counted = tuple(f"session {i + 1}, {name}" for i, session in enumerate(sessions) for name in session)
    return _write_answer(find_payload(arm, renamed), tuple(names or counted), single=len(sessions) == 1)


def _leave_still(recordings: Sequence[Recording]) -> tuple[Sequence[Recording], dict[str, float]]:
    """The recordings of joints that move in a session, and where the others stood [rad] or [m], such as a gripper."""
    stood = [find_still(list(session.values())) for session in group_sessions(recordings)]
    apart = {name: place for name, place in stood[0].items() if all(name in one for one in stood)} if stood else {}
    moving = [one for one in recordings if one.metadata.joint not in apart]
    return (moving, apart) if moving else (recordings, {})


def _place_apart(
    simulation: str | Path, joints: Sequence[str], apart: Mapping[str, float], match: Mapping[str, str] | None
) -> dict[str, float]:
    """Positions of joints that stood still by their names in the simulation, of those that it has."""
    placed = {}
    for name, place in apart.items():
        given = {one: there for one, there in (match or {}).items() if one in (*joints, name)}
        with suppress(SimulationFileError):
            placed[read_arm(simulation, [*joints, name], given).joints[-1]] = place
    return placed


def _write_answer(found: Payload, names: tuple[str, ...], *, single: bool) -> Diagnosis:
    noise = float(np.sqrt(np.mean([value**2 for value in found.noise.values()])))
    held = compute_held_out(found.before, found.after, noise, ("N·m", 0))
    seen = found.significance > SETTINGS.significant and held.rmse_after < held.rmse_before
    units = {"mass": "kg"}
    parameters = {
        name: Quantity(value, units.get(name, "kg·m"), (value - Z95 * error, value + Z95 * error))
        for name, (value, error) in found.moments.items()
    }
    effect = NamedEffect(
        name="payload_error",
        kind="parameter",
        parameters=parameters,
        share=held.explained,
        equation="tau_j = ... + Y_je(q, v, a) w_p",
        sentence=_describe_payload(found, single=single),
        citation="hollerbach2016",
    )
    fields = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA,
        verdict="parameters" if seen else "consistent",
        effects=(effect,) if seen else (),
        heldout=held,
        recordings=names,
        joint="arm",
    )
    notes = Notes(lead=(_describe_joints(found),)) if seen else Notes(opening=_describe_likeness(found, single=single))
    return Diagnosis(write_record(fields, notes))


def _describe_joints(found: Payload) -> str:
    """The joints whose torques show the payload most."""
    most = sorted(found.errors.items(), key=lambda item: item[1][1] ** 2 - item[1][0] ** 2)[: SETTINGS.most_joints]
    shown = [f"{name} ({before:.3g} to {after:.3g} N·m)" for name, (before, after) in most if after < before]
    return f"It shows most in the torque of {', '.join(shown)}: the fall of each one's held-out error."


def _describe_likeness(found: Payload, *, single: bool) -> str:
    mass, error = found.moments.get("mass", (0.0, 0.0))
    head = (
        "The arm carries at its end what its simulation does"
        if single
        else ("Both sessions carry the same at the end of the arm")
    )
    return (
        f"{head}, as far as these motions show"
        + (f": the masses differ by {mass:.2g} ± {Z95 * error:.2g} kg" if "mass" in found.moments else "")
        + ". Nothing else was looked for; diagnose the joints one at a time."
    )


def _describe_payload(found: Payload, *, single: bool) -> str:
    who, other = ("the arm", "in its simulation") if single else ("the last session", "the first")
    if "mass" not in found.moments:
        return f"{who} carries another load at the end of the arm than {other}"
    mass = found.moments["mass"][0]
    joints = ", ".join(f"{name} {value:.3g}" for name, value in found.by_joint.items())
    more = f"{abs(mass):.3g} kg {'more' if mass > 0.0 else 'less'}"
    return f"{who} carries {more} than {other} at the end of the arm (by single joints: {joints} kg)"
