"""What the written files are worth: torque error and open-loop motion on blocks that took no part in their fit."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np

from fricomp.diagnosis.record.result import Quantity
from fricomp.evaluation.arm import ArmEvaluation, JointErrors, evaluate_arm
from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from ..answer import ArmAnswer
from ..comparison.torque_scale import find_scales, scale_recordings
from ..confirmation import fit_plainly
from ..fit import ArmFit
from ..friction_model import build_friction_model
from ..record import FileErrors, PositionErrors
from ..row_weights import BoolArray
from .best_gain import find_best_gain
from .corrected_simulation import correct_simulation

__all__ = ["FileTrial", "compare_files", "hold_out"]

_BLOCK = 5.0
"""[s] of a block: open-loop simulations of 2 s have to lie within one."""

_HELD_OUT = 4
"""One block of so many takes no part in the fit."""

_LEAST_PART = 1e-3
"""Of the mean level, that a level of one direction has at least."""

Spans = list[tuple[float, float]]


@dataclass(frozen=True)
class FileTrial:
    """Where files are compared: made of some rows of a recording, simulated within some spans of it.

    Attributes:
        answer: The confirmed fit.
        simulation: The file that was compared.
        trained: Rows that the files are made of. Shape (n,).
        spans: Times that count [s]; all if None.
        longest: Of the open-loop simulations [s]; none at 0.
    """

    answer: ArmAnswer
    simulation: Path
    trained: BoolArray
    spans: Spans | None
    longest: float

    def evaluate_plain(self) -> ArmEvaluation:
        """Errors of the simulation with Coulomb, viscous and constant torques."""
        arm = self.answer.identification.fit.arm
        found, _ = fit_plainly(arm, self.answer.identification.equations, self.trained)
        plain = {name: _build_plain(self.answer, j, found[j].tolist()) for j, name in enumerate(arm.joints)}
        return self._evaluate(self.simulation, plain, self.answer.identification.recording.recordings)

    def evaluate_fit(self, fit: ArmFit) -> ArmEvaluation:
        """Errors of `arm.xml` and the friction models that are made of a fit, as those that are written are.

        What is written is true torque: that of joints whose scale the fit has wrong is compared as it says it is.
        """
        part = replace(self.answer.identification, fit=fit)
        models = {name: build_friction_model(part, j) for j, name in enumerate(fit.arm.joints)}
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "arm.xml"
            corrected = correct_simulation(replace(self.answer, identification=part), self.simulation)[0]
            path.write_text(corrected, encoding="utf-8")
            return self._evaluate(path, models, scale_recordings(fit, part.recording.recordings))

    def _evaluate(
        self, simulation: Path, friction: dict[str, FrictionModel], recordings: Sequence[Recording]
    ) -> ArmEvaluation:
        found = self.answer.identification
        return evaluate_arm(
            simulation,
            recordings,
            friction=friction,
            spans=self.spans,
            band=found.rows.cutoff,
            torque_delay={
                name: found.delay.value + own
                for name, (own, _) in zip(found.fit.arm.joints, self.answer.own_delays, strict=True)
            },
            positions=self.longest > 0.0,
            longest=self.longest,
        )


def compare_files(trial: FileTrial, fit: ArmFit, before: ArmEvaluation, after: ArmEvaluation) -> dict[str, FileErrors]:
    """Errors of each joint by its simulation with plain friction, and by the files that a fit makes, by its name.

    Args:
        trial: On held-out rows.
        fit: What the files are made of.
        before: Of the simulation with plain friction.
        after: Of the files.
    """
    equations = trial.answer.identification.equations
    used = equations.moving & ~trial.trained[:, None]
    left = np.where(used, fit.residuals(equations), 0.0)
    own = np.sqrt(np.sum(left**2, axis=0) / np.maximum(np.sum(used, axis=0), 1))
    part = replace(trial.answer.identification, fit=fit)
    gains = [find_best_gain(part, j, used[:, j]) for j in range(len(fit.arm.joints))]
    pairs = zip(fit.arm.joints, (own / find_scales(fit)).tolist(), gains, strict=True)
    return {name: _compare(before.joint(name), after.joint(name), fitted, gain) for name, fitted, gain in pairs}


def hold_out(time: FloatArray) -> tuple[BoolArray, Spans, Spans]:
    """Rows that take no part in a fit, their spans, and the spans of the others [s]."""
    first, last = float(time[0]), float(time[-1])
    blocks = max(_HELD_OUT, int((last - first) // _BLOCK))
    edges = np.linspace(first, last, blocks + 1)
    chosen = [k for k in range(blocks) if k % _HELD_OUT == _HELD_OUT // 2]
    every = [(float(a), float(b)) for a, b in pairwise(edges)]
    spans = [every[k] for k in chosen]
    held = np.any([(time >= a) & (time < b) for a, b in spans], axis=0)
    return held, spans, [one for one in every if one not in spans]


def _build_plain(answer: ArmAnswer, joint: int, values: Sequence[float]) -> FrictionModel:
    level, offset, viscous = max(values[0], 1e-9), values[1], max(values[2], 0.0)
    least = _LEAST_PART * level
    curves = [StribeckCurve(one, one, 1.0, viscous) for one in (max(level + offset, least), max(level - offset, least))]
    whole = build_friction_model(answer.identification, joint)
    return replace(whole, law=FrictionLaw((BidirectionalStribeck(curves[0], curves[1]),)))


def _compare(before: JointErrors, after: JointErrors, fitted: float, gain: Quantity | None) -> FileErrors:
    pairs = zip(before.position, after.position, strict=True)
    return FileErrors(
        torque_simulation=before.torque.rms,
        torque_fit=fitted,
        torque=after.torque.rms,
        band=after.torque.band,
        best_gain=gain,
        positions=tuple(
            PositionErrors(after=b.after, simulation=a.median, files=b.median, travel=b.travel, unit=b.unit)
            for a, b in pairs
        ),
    )
