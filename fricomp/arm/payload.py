"""What an arm carries at its end, from joint torques: more in one session than in another, or than its simulation.

    tau_j = sum over bodies Y_jb(q, v, a) w_b + [session] Y_je(q, v, a) w_p + friction_j(v, tau_j)

The weights w_b of the bodies are whatever the recordings say, for each joint on its own; only w_p is shared by all
joints. So the simulation need not know what its links weigh, and no motion has to be repeated [hollerbach2016]. Of one
session alone the bodies weigh what the simulation says, and w_p is what they leave.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.signal import butter, filtfilt
from scipy.stats import norm, t

from fricomp.blas import one_blas_thread
from fricomp.diagnosis.inputs.checks import reasons_against
from fricomp.diagnosis.inputs.given import Given
from fricomp.diagnosis.record.result import DIAGNOSIS_SCHEMA, Diagnosis, DiagnosisRecord, NamedEffect, Quantity
from fricomp.diagnosis.record.sentence import Notes, write_record
from fricomp.diagnosis.samples.sample_finding import compute_held_out
from fricomp.diagnosis.verdict.writing import write_refusal
from fricomp.errors import DiagnosisError
from fricomp.laws import FloatArray
from fricomp.recording import Recording
from fricomp.root_mean_square import compute_rms

from .fit import Z95
from .rigid.inertia import N_INERTIA, combine_inertia
from .rigid.regressor import compute_regressor
from .rigid.simulated_arm import SimulatedArm, read_arm

__all__ = ["Payload", "diagnose_payload", "find_payload", "group_sessions"]


@dataclass(frozen=True)
class PayloadSettings:
    """How a difference in payload is looked for. Chosen on one arm of six joints and on made arms of two.

    Attributes:
        cutoff: Of the low pass that torque and motion share [Hz]: above the motions of an arm, below its oscillations.
        rate: Of the rows behind it [Hz].
        edge: Time at both ends of a session that is left out [s], where the filter settles.
        slow: Part of the top speed over which friction changes its sign.
        top: Quantile of the speed that counts as the top speed.
        folds: Blocks that are left out in turn for the deviations.
        rank: Singular value, over the largest, below which a combination of weights is not seen.
        seen: The same for the columns of the payload.
        told: Part of a moment that may lie outside of what the rows fix: a larger one tells numbers that are none.
        dust: Size of a column, over the largest, that rounding leaves of a body that this joint does not move.
        significant: Standard deviations from which a payload differs. A smaller value names payloads by chance: the
            deviations come from eight blocks alone.
        test_share: Part of each session, its last, on which errors are counted.
        most_joints: Joints that are told to show it.
    """

    cutoff: float = 5.0
    rate: float = 25.0
    edge: float = 1.0
    slow: float = 0.03
    top: float = 0.95
    folds: int = 8
    rank: float = 1e-5
    seen: float = 1e-4
    told: float = 0.01
    dust: float = 1e-9
    significant: float = 4.0
    test_share: float = 1.0 / 3.0
    most_joints: int = 3


SETTINGS = PayloadSettings()


@dataclass(frozen=True)
class Payload:
    """What a session carries more than the first one. Errors are on the last third of each session.

    Attributes:
        moments: Value and standard deviation of "mass" [kg] and "first_moment_x", _y, _z about the frame of the last
            body [kg·m]; those that the motions do not show are left out.
        before: Held-out error without a payload [N·m]. Shape (n_rows,).
        after: The same with it.
        noise: RMS of what the model leaves where it was fitted [N·m], for each joint.
        by_joint: Mass that each joint alone would give [kg], where it shows one.
        errors: Held-out RMS error of each joint without a payload and with it [N·m].
    """

    moments: dict[str, tuple[float, float]]
    before: FloatArray
    after: FloatArray
    noise: dict[str, float]
    by_joint: dict[str, float]
    errors: dict[str, tuple[float, float]]

    @property
    def significance(self) -> float:
        """Largest moment in its standard deviations."""
        return max((abs(value) / max(error, 1e-12) for value, error in self.moments.values()), default=0.0)


Session = dict[str, Recording]


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
    reasons = [f"{one.metadata.joint}: {reason}" for one in recordings for reason in reasons_against([one], None)]
    if reasons:
        called = tuple(names or (f"recording {i + 1}" for i in range(len(recordings))))
        return write_refusal(Given(tuple(recordings), called), reasons)
    sessions = group_sessions([one.on_joint_side() for one in recordings])
    joints = list(sessions[0])
    if len(sessions) > 2 or any(set(one) != set(joints) for one in sessions):
        told = "; ".join(", ".join(one) for one in sessions)
        raise DiagnosisError(f"a payload is found from one or two sessions with the same joints; got {told}")
    arm = read_arm(simulation, joints, match)
    renamed = [dict(zip(arm.joints, (one[name] for name in joints), strict=True)) for one in sessions]
    counted = tuple(f"session {i + 1}, {name}" for i, session in enumerate(sessions) for name in session)
    return _write_answer(find_payload(arm, renamed), tuple(names or counted), single=len(sessions) == 1)


def find_payload(arm: SimulatedArm, sessions: Sequence[Session]) -> Payload:
    """Identify friction and the payload: what two sessions differ by, or what one has more than the simulation.

    Raises:
        DiagnosisError: No joint's torque is known in N·m or N.
    """
    rows = [_Rows.build(arm, session) for session in sessions]
    gains = [_list_gains(session) for session in sessions]
    joints = [name for name in arm.joints if all(name in known for known in gains)]
    if not joints:
        raise DiagnosisError(
            "no joint's torque is in N·m or N, and none says how much one ampere is (metadata drive_gain): "
            "a payload needs torque"
        )
    parts = {name: _build_joint_rows(arm.joints.index(name), rows, [known[name] for known in gains]) for name in joints}
    weights, noise = _solve_folds(parts, None)
    drawn = np.array([_solve_folds(parts, fold)[0] for fold in range(SETTINGS.folds)])
    variance = (SETTINGS.folds - 1) * np.var(drawn @ _MOMENTS, axis=0)
    if len(sessions) == 1:
        variance = variance + _compare_joints(parts)
    deviation, shown = np.sqrt(variance), _find_shown(parts)
    moments = {
        name: (float(value), float(error))
        for name, value, error, seen in zip(_NAMES, weights @ _MOMENTS, deviation, shown, strict=True)
        if seen
    }
    alone = {name: {name: part} for name, part in parts.items()}
    sides = [_predict_held_out(parts, with_payload=known) for known in (False, True)]
    before, after = (np.concatenate(list(side.values())) for side in sides)
    return Payload(
        moments=moments,
        before=before,
        after=after,
        noise=noise,
        by_joint={
            n: float((_solve_folds(one, None)[0] @ _MOMENTS)[0]) for n, one in alone.items() if _find_shown(one)[0]
        },
        errors={name: (compute_rms(sides[0][name]), compute_rms(sides[1][name])) for name in parts},
    )


_NAMES = ("mass", "first_moment_x", "first_moment_y", "first_moment_z")
_DISTANCE = 0.1
"""[m] of the point masses that make up a body from its origin: about the size of a link, so that all of their columns
are of one size."""


def _place_points() -> FloatArray:
    """Where ten point masses sit on a body: their masses and moments are independent [m]. Shape (10, 3)."""
    e = np.eye(3)
    points = [np.zeros(3), *e, *-e, e[0] + e[1], e[1] + e[2], e[0] + e[2]]
    return np.asarray(_DISTANCE * np.array(points))


_POINTS = _place_points()
_MOMENTS = np.column_stack([np.ones(10), _POINTS])
"""Mass and first moments of ten unit masses at the points that a body is made of. Shape (10, 4)."""

_INERTIA = np.stack([combine_inertia(1.0, point, np.zeros((3, 3))) for point in _POINTS], axis=1)
"""Ten numbers of a link for each of these masses. Shape (10, 10)."""


@dataclass(frozen=True)
class _Rows:
    """Filtered motion and torques of one session at `SETTINGS.rate`.

    Attributes:
        velocity: Of all joints. Shape (n, n_joints), like the others.
        acceleration: [rad/s²] or [m/s²].
        torque: As recorded.
        simulated: Of the simulation's links and rotors [N·m] or [N].
        bodies: Columns of all links. Shape (n, n_joints, 10 n_links).
        payload: Columns of the last link. Shape (n, n_joints, 10).
    """

    velocity: FloatArray
    acceleration: FloatArray
    torque: FloatArray
    simulated: FloatArray
    bodies: FloatArray
    payload: FloatArray

    @classmethod
    def build(cls, arm: SimulatedArm, session: Session) -> _Rows:
        series = [session[name] for name in arm.joints]
        dt = float(np.median([one.sample_period for one in series]))
        first, last = max(one.time[0] for one in series), min(one.time[-1] for one in series)
        grid = np.arange(first, last, dt)
        b, a = butter(3, SETTINGS.cutoff * 2.0 * dt)
        position, torque = (
            np.stack([filtfilt(b, a, np.interp(grid, one.time, getattr(one, name))) for one in series], axis=1)
            for name in ("position", "torque")
        )
        velocity = np.gradient(position, dt, axis=0)
        acceleration = np.gradient(velocity, dt, axis=0)
        edge = round(SETTINGS.edge / dt)
        kept = slice(edge, grid.size - edge, max(1, round(1.0 / (SETTINGS.rate * dt))))
        columns = compute_regressor(arm, position[kept], velocity[kept], acceleration[kept])
        links = columns.reshape(*columns.shape[:2], -1, N_INERTIA) @ _INERTIA
        simulated = columns @ arm.inertia.ravel() + acceleration[kept] * arm.armature
        last_link = links[:, :, arm.last_link]
        bodies = links.reshape(columns.shape)
        return cls(velocity[kept], acceleration[kept], torque[kept], simulated, bodies, last_link)


def _list_gains(session: Session) -> dict[str, float]:
    """Torque of one unit of the recorded torque, for the joints of which it is known [N·m] or [N].

    Gains that were seen in the log itself (`drive_gain_logged`) go before those that somebody states (`drive_gain`).
    """
    plain = {name: 1.0 for name, one in session.items() if one.metadata.torque_unit in ("N·m", "N")}
    for key in ("drive_gain_logged", "drive_gain"):
        stated = {name: one.metadata.extra.get(key) for name, one in session.items() if name not in plain}
        known = {name: float(gain) for name, gain in stated.items() if isinstance(gain, int | float)}
        if known:
            return plain | known
    return plain


@dataclass(frozen=True)
class _JointRows:
    """Equations of one joint: own columns, payload columns (zero in the first session), torque, and fold of a row."""

    own: FloatArray
    payload: FloatArray
    torque: FloatArray
    fold: np.ndarray
    test: np.ndarray


def _build_joint_rows(j: int, rows: Sequence[_Rows], gains: Sequence[float]) -> _JointRows:
    """Of one joint; of a single session the links are known, and the payload is what they leave."""
    torque = np.concatenate([one.torque[:, j] * gain for one, gain in zip(rows, gains, strict=True)])
    v = np.concatenate([one.velocity[:, j] for one in rows])
    sign = np.tanh(v / (SETTINGS.slow * max(float(np.quantile(np.abs(v), SETTINGS.top)), 1e-12)))
    friction = np.column_stack([np.ones_like(v), v, sign])
    if len(rows) == 1:
        payload, load = rows[0].payload[:, j], rows[0].simulated[:, j]
        torque, plain = torque - load, np.column_stack([friction, rows[0].acceleration[:, j]])
    else:
        bodies = np.concatenate([one.bodies[:, j] for one in rows])
        payload = np.concatenate([k * one.payload[:, j] for k, one in enumerate(rows)])
        plain, n = np.column_stack([bodies, friction]), bodies.shape[1]
        rigid = np.column_stack([plain, payload])
        load = rigid[:, :n] @ np.linalg.lstsq(rigid, torque, rcond=SETTINGS.rank)[0][:n]
    own = np.column_stack([plain, v * np.abs(v), np.abs(load) * sign])
    size = np.linalg.norm(own, axis=0)
    seen = size > SETTINGS.dust * size.max()
    U, s, _ = np.linalg.svd(own[:, seen] / size[seen], full_matrices=False)
    lengths = [one.torque.shape[0] for one in rows]
    fold = np.concatenate([np.arange(n) * SETTINGS.folds // n for n in lengths])
    test = np.concatenate([np.arange(n) >= n * (1.0 - SETTINGS.test_share) for n in lengths])
    return _JointRows(U[:, s > SETTINGS.rank * s[0]], payload, torque, fold, test)


def _find_shown(parts: dict[str, _JointRows]) -> list[bool]:
    """Which of the mass and the first moments these rows fix."""
    columns = np.concatenate([part.payload - part.own @ (part.own.T @ part.payload) for part in parts.values()])
    _, s, V = np.linalg.svd(columns, full_matrices=False)
    V = V[s > SETTINGS.seen * s[0]]
    away = np.linalg.norm(_MOMENTS - V.T @ (V @ _MOMENTS), axis=0) / np.linalg.norm(_MOMENTS, axis=0)
    return [bool(one < SETTINGS.told) for one in away]


def _compare_joints(parts: dict[str, _JointRows]) -> FloatArray:
    """Variance of mass and first moments by which joints are left out in turn, which others still fix. Shape (4,).

    Links that weigh something else than the simulation says pull each joint's payload to another place: where the
    simulation is right, all joints agree.
    """
    fewer = [{name: part for name, part in parts.items() if name != left} for left in parts]
    drawn = [_solve_folds(some, None)[0] @ _MOMENTS for some in fewer if some and _find_shown(some)[0]]
    if len(drawn) < 2:
        return np.zeros(_MOMENTS.shape[1])
    few = float(t.ppf(0.975, len(drawn) - 1) / norm.ppf(0.975))  # so few that a deviation is known badly itself
    return np.asarray(few**2 * (len(drawn) - 1) * np.var(drawn, axis=0))


def _solve_folds(parts: dict[str, _JointRows], left_out: int | None) -> tuple[FloatArray, dict[str, float]]:
    """Weights of the payload's point masses, and each joint's RMS error [N·m]; each joint counts by its own noise."""
    kept = {name: part.fold != left_out for name, part in parts.items()}
    return _solve_weighted(parts, kept)


def _solve_weighted(parts: dict[str, _JointRows], kept: dict[str, np.ndarray]) -> tuple[FloatArray, dict[str, float]]:
    noise = {}
    for name, part in parts.items():
        table = np.column_stack([part.own, part.payload])[kept[name]]
        left = part.torque[kept[name]] - table @ np.linalg.lstsq(table, part.torque[kept[name]], rcond=SETTINGS.rank)[0]
        noise[name] = compute_rms(left)
    columns: list[FloatArray] = []
    targets: list[FloatArray] = []
    for name, part in parts.items():
        Q = np.linalg.qr(part.own[kept[name]])[0]
        for values, into in ((part.payload[kept[name]], columns), (part.torque[kept[name]], targets)):
            into.append((values - Q @ (Q.T @ values)) / noise[name])
    weights: FloatArray = np.linalg.lstsq(np.concatenate(columns), np.concatenate(targets), rcond=SETTINGS.rank)[0]
    return weights, noise


def _predict_held_out(parts: dict[str, _JointRows], *, with_payload: bool) -> dict[str, FloatArray]:
    """Errors of each joint on the last third of each session by a fit to the rest [N·m]. Shapes (n_rows,)."""
    kept = {name: ~part.test for name, part in parts.items()}
    weights = _solve_weighted(parts, kept)[0] if with_payload else np.zeros(10)
    errors = {}
    for name, part in parts.items():
        target = part.torque - part.payload @ weights
        own = np.linalg.lstsq(part.own[~part.test], target[~part.test], rcond=SETTINGS.rank)[0]
        errors[name] = target[part.test] - part.own[part.test] @ own
    return errors


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
