"""Joints whose friction is known, identified from a recorded motion: do the intervals hold the truth?"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from fricomp.calibration.identification import Status
from fricomp.calibration.motion.cutoffs import choose_settings
from fricomp.calibration.motion.identify import identify_motion
from fricomp.calibration.motion.joint_samples import sample_joint
from fricomp.control.compensation.trust import find_doubt_in_status
from fricomp.laws import BidirectionalStribeck, FloatArray, FrictionLaw, StribeckCurve
from fricomp.recording import Recording

from .seed_study import Score, SeedStudy, score

__all__ = ["MotionStudy", "draw_joint", "study_motions"]

_DURATION, _PERIOD = 20.0, 0.002
_COUNT = 2.0 * np.pi / 2**18
_FREQUENCIES = np.array([0.2, 0.53, 1.3])
"""Of the three swings [Hz]; their phases are drawn."""


class KnownJoint(NamedTuple):
    """A joint and how it is recorded.

    Attributes:
        law: Its friction.
        inertia: [kg·m²].
        noise: Standard deviation of the torque's white noise [N·m].
        amplitudes: Of the swings [rad]. Shape (3,).
        phases: [rad]. Shape (3,).
    """

    law: FrictionLaw
    inertia: float
    noise: float
    amplitudes: FloatArray
    phases: FloatArray

    def record(self, rng: np.random.Generator) -> Recording:
        """20 s at 500 Hz by an encoder of 18 bits."""
        t, rates = np.arange(0.0, _DURATION, _PERIOD), 2.0 * np.pi * _FREQUENCIES
        angles = rates[:, None] * t + self.phases[:, None]
        position = self.amplitudes @ np.sin(angles)
        velocity = (self.amplitudes * rates) @ np.cos(angles)
        acceleration = -(self.amplitudes * rates**2) @ np.sin(angles)
        torque = self.inertia * acceleration + np.asarray(self.law.torque(velocity))
        return Recording(t, np.round(position / _COUNT) * _COUNT, torque + self.noise * rng.normal(size=t.size))


class MotionStudy(NamedTuple):
    """Scores of all recordings, and of those whose status lets a model be used."""

    all: SeedStudy
    usable: SeedStudy


def draw_joint(rng: np.random.Generator) -> KnownJoint:
    """Friction, inertia, noise and motion within what geared joints have."""
    coulomb, ratio, bend = rng.uniform(0.1, 1.0), rng.uniform(1.2, 4.0), np.exp(rng.uniform(*np.log([0.03, 0.2])))
    forward, reverse = (
        StribeckCurve(coulomb * uneven, coulomb * uneven * ratio, bend * rng.uniform(0.9, 1.1), viscous)
        for uneven, viscous in zip(rng.uniform(0.8, 1.2, 2), coulomb * rng.uniform(0.05, 0.3, 2), strict=True)
    )
    return KnownJoint(
        FrictionLaw((BidirectionalStribeck(forward, reverse),)),
        inertia=float(rng.uniform(0.02, 0.2)),
        noise=float(rng.uniform(0.005, 0.02)) * coulomb * ratio,
        amplitudes=rng.uniform(0.5, 1.5) * np.array([1.0, 0.3, 0.1]),
        phases=rng.uniform(0.0, 2.0 * np.pi, 3),
    )


def study_motions(seeds: Iterable[int], report: Callable[[str, float], None] = lambda text, done: None) -> MotionStudy:
    """Draw, record and identify one joint a seed.

    Args:
        seeds: Of the joints.
        report: Told about progress.
    """
    wanted = list(seeds)
    scores: list[Score] = []
    statuses: dict[int, Status] = {}
    for index, seed in enumerate(wanted):
        report(f"seed {seed}", index / len(wanted))
        rng = np.random.default_rng(seed)
        joint = draw_joint(rng)
        recording = joint.record(rng)
        settings = choose_settings(recording)
        result = identify_motion(sample_joint(recording, settings), settings).friction
        scores += score(result, joint.law, seed, profiles=True)
        statuses[seed] = result.status
    usable = {seed: status for seed, status in statuses.items() if find_doubt_in_status(status, "") is None}
    return MotionStudy(
        SeedStudy(tuple(scores), tuple(map(str, statuses.values()))),
        SeedStudy(tuple(s for s in scores if s.seed in usable), tuple(map(str, usable.values()))),
    )
