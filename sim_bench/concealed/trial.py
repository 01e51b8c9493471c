"""One scene, run in closed loop under any change, always with the same noise."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from fricomp.errors import DiagnosisError

from .concealed_torque import compute_concealed
from .dynamics import SAMPLE_PERIOD, Motion, simulate
from .effect import Change, Scene
from .excitation import LEAD_IN, build_reference
from .joint import Joint, draw_joint
from .plant import build_plant
from .refit import Rows, build_rows
from .sensing import Sensed, draw_sensors, sense

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from .spec import CaseSpec

__all__ = ["Outcome", "Trial"]

_LOST = 1.5  # [rad] away from the reference a loop counts as unstable


@dataclass(frozen=True)
class Outcome:
    """One run: the true motion, its sensed channels, the concealed torque and the weak form, after the lead-in."""

    motion: Motion
    sensed: Sensed
    torque: NDArray[np.float64]
    rows: Rows


class Trial:
    """A joint, a motion and sensors, all drawn by the seed of a spec.

    Args:
        spec: Of the case.
        reference: Position [rad] and velocity [rad/s] in place of the spec's excitation, with its lead-in at
            rest; shape (n_samples, 2).
    """

    def __init__(self, spec: CaseSpec, reference: NDArray[np.float64] | None = None) -> None:
        streams = np.random.SeedSequence(spec.seed).spawn(9)
        self.spec = spec
        rng = np.random.default_rng(streams[0])
        self.joint = draw_joint(rng, spec.family, spec.core)
        given = reference
        if reference is None:
            draws = np.random.default_rng(streams[1])
            reference = build_reference(spec.excitation, spec.duration, self.joint.speed, draws)
        time = np.asarray(SAMPLE_PERIOD * np.arange(reference.shape[0]) - LEAD_IN, dtype=np.float64)
        self.scene = Scene(self.joint, time, reference)
        self.sensors = draw_sensors(np.random.default_rng(streams[2]), self.joint, spec.noise)
        self.start = int(np.searchsorted(time, -1e-9))
        # Another motion is another recording: noise that repeats itself would be part of the joint.
        self._noise_stream = streams[3] if given is None else streams[3].spawn(1)[0]
        self._effect_streams = streams[4:7]
        self.shift = _draw_shift(np.random.default_rng(streams[7]), self.joint) if spec.shifted else {}
        self._warming = _draw_warming(np.random.default_rng(streams[8]))

    def effect_rng(self, index: int) -> np.random.Generator:
        """The same numbers at every call."""
        return np.random.default_rng(self._effect_streams[index])

    def temperature(self, change: Change) -> NDArray[np.float64]:
        """Temperature of the joint [°C], shape (n_samples,)."""
        if change.temperature is not None:
            return change.temperature
        (rise, settling), time = self._warming, self.scene.time
        return np.asarray(25.0 - rise * np.expm1(-(time - time[0]) / settling) + 0.5 * np.sin(0.05 * time))

    def run(self, change: Change) -> Outcome:
        """The closed loop with the change.

        Raises:
            DiagnosisError: The loop loses its reference.
        """
        n = self.scene.time.size
        fields = {**self.joint.fields, **change.plant}
        disturbance = np.zeros(n) if change.disturbance is None else change.disturbance
        factor = np.ones(n) if change.factor is None else change.factor
        outside = np.stack([disturbance, self.temperature(change), factor], axis=1)
        whole = simulate(build_plant(fields), self.scene.reference, outside, self.joint.shares)
        sensors = replace(self.sensors, **change.sensing)  # type: ignore[arg-type]
        lost = np.abs(whole.position - self.scene.reference[:, 0]).max()
        if not lost < _LOST:
            raise DiagnosisError(f"the concealed joint of {self.spec} is unstable: draw another seed")
        torque = compute_concealed(whole, sensors, fields, change.belief)[self.start :]
        sensed = sense(whole, sensors, self.joint, fields, np.random.default_rng(self._noise_stream))
        motion = Motion(*(values[self.start :] for values in whole))
        sensed = Sensed(*(values[self.start :] for values in sensed))
        return Outcome(motion, sensed, torque, build_rows(motion, sensed, self.joint))


def _draw_warming(rng: np.random.Generator) -> tuple[float, float]:
    """Rise [K] and time constant [s] of a joint whose friction does not care: every other one warms up."""
    return float(rng.choice([0.0, 1.0]) * rng.uniform(5.0, 20.0)), float(rng.uniform(15.0, 60.0))


def _draw_shift(rng: np.random.Generator, joint: Joint) -> dict[str, float]:
    """Inertia and gravity of the user's simulation, 8 to 25 % off."""
    names = ("inertia", "gravity")
    return {name: joint.fields[name] * (1.0 + rng.choice([-1, 1]) * rng.uniform(0.08, 0.25)) for name in names}
