"""The payload that explains the torques of all joints, and how well it is known."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm, t

from fricomp.errors import DiagnosisError
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from ..rigid.simulated_arm import SimulatedArm
from .rows import MOMENTS, JointRows, Session, SessionRows, build_joint_rows, list_gains
from .settings import SETTINGS

_NAMES = ("mass", "first_moment_x", "first_moment_y", "first_moment_z")


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


def find_payload(arm: SimulatedArm, sessions: Sequence[Session]) -> Payload:
    """Identify friction and the payload: what two sessions differ by, or what one has more than the simulation.

    Raises:
        DiagnosisError: No joint's torque is known in N·m or N.
    """
    rows = [SessionRows.build(arm, session) for session in sessions]
    gains = [list_gains(session) for session in sessions]
    joints = [name for name in arm.joints if all(name in known for known in gains)]
    if not joints:
        raise DiagnosisError(
            "no joint's torque is in N·m or N, and none says how much one ampere is (metadata drive_gain): "
            "a payload needs torque"
        )
    parts = {name: build_joint_rows(arm.joints.index(name), rows, [known[name] for known in gains]) for name in joints}
    weights, noise = _solve_folds(parts, None)
    drawn = np.array([_solve_folds(parts, fold)[0] for fold in range(SETTINGS.folds)])
    variance = (SETTINGS.folds - 1) * np.var(drawn @ MOMENTS, axis=0)
    if len(sessions) == 1:
        variance = variance + _compare_joints(parts)
    deviation, shown = np.sqrt(variance), _find_shown(parts)
    moments = {
        name: (float(value), float(error))
        for name, value, error, seen in zip(_NAMES, weights @ MOMENTS, deviation, shown, strict=True)
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
            n: float((_solve_folds(one, None)[0] @ MOMENTS)[0]) for n, one in alone.items() if _find_shown(one)[0]
        },
        errors={name: (compute_rms(sides[0][name]), compute_rms(sides[1][name])) for name in parts},
    )


def _find_shown(parts: dict[str, JointRows]) -> list[bool]:
    """Which of the mass and the first moments these rows fix."""
    columns = np.concatenate([part.payload - part.own @ (part.own.T @ part.payload) for part in parts.values()])
    _, s, V = np.linalg.svd(columns, full_matrices=False)
    V = V[s > SETTINGS.seen * s[0]]
    away = np.linalg.norm(MOMENTS - V.T @ (V @ MOMENTS), axis=0) / np.linalg.norm(MOMENTS, axis=0)
    return [bool(one < SETTINGS.told) for one in away]


def _compare_joints(parts: dict[str, JointRows]) -> FloatArray:
    """Variance of mass and first moments by which joints are left out in turn, which others still fix. Shape (4,).

    Links that weigh something else than the simulation says pull each joint's payload to another place: where the
    simulation is right, all joints agree.
    """
    fewer = [{name: part for name, part in parts.items() if name != left} for left in parts]
    drawn = [_solve_folds(some, None)[0] @ MOMENTS for some in fewer if some and _find_shown(some)[0]]
    if len(drawn) < 2:
        return np.zeros(MOMENTS.shape[1])
    few = float(t.ppf(0.975, len(drawn) - 1) / norm.ppf(0.975))  # so few that a deviation is known badly itself
    return np.asarray(few**2 * (len(drawn) - 1) * np.var(drawn, axis=0))


def _solve_folds(parts: dict[str, JointRows], left_out: int | None) -> tuple[FloatArray, dict[str, float]]:
    """Weights of the payload's point masses, and each joint's RMS error [N·m]; each joint counts by its own noise."""
    kept = {name: part.fold != left_out for name, part in parts.items()}
    return _solve_weighted(parts, kept)


def _solve_weighted(parts: dict[str, JointRows], kept: dict[str, np.ndarray]) -> tuple[FloatArray, dict[str, float]]:
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


def _predict_held_out(parts: dict[str, JointRows], *, with_payload: bool) -> dict[str, FloatArray]:
    """Errors of each joint on the last third of each session by a fit to the rest [N·m]. Shapes (n_rows,)."""
    kept = {name: ~part.test for name, part in parts.items()}
    weights = _solve_weighted(parts, kept)[0] if with_payload else np.zeros(10)
    errors = {}
    for name, part in parts.items():
        target = part.torque - part.payload @ weights
        own = np.linalg.lstsq(part.own[~part.test], target[~part.test], rcond=SETTINGS.rank)[0]
        errors[name] = target[part.test] - part.own[part.test] @ own
    return errors
