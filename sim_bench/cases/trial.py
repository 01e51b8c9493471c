"""One scene, run in closed loop under any change, always with the same noise."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fricomp.errors import DiagnosisError

from .concealed_torque import compute_concealed
from .dynamics import SAMPLE_PERIOD, Motion, simulate
from .effect import Change, Scene
from .excitation import LEAD_IN, build_reference
from .joint import Joint, draw_joint
from .plant import build_plant
from .refit import Rows, build_rows
from .sensing import Sensed, draw_sensors, sense
from .spec import CaseSpec
from .temperature import draw_temperature

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
        self._temperature = draw_temperature(time, np.random.default_rng(streams[8]))

    def effect_rng(self, index: int) -> np.random.Generator:
        """The same numbers at every call."""
        return np.random.default_rng(self._effect_streams[index])

    def temperature(self, change: Change) -> NDArray[np.float64]:
        """Temperature of the joint [°C], shape (n_samples,)."""
        return self._temperature if change.temperature is None else change.temperature

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


def _draw_shift(rng: np.random.Generator, joint: Joint) -> dict[str, float]:
    """Inertia and gravity of the user's simulation, 2 to 25 % off, and a centre of mass that lies elsewhere."""
    fields = joint.fields
    sizes = np.exp(rng.uniform(np.log(0.02), np.log(0.25), 2)) * rng.choice([-1.0, 1.0], 2)
    return {
        "inertia": float(fields["inertia"] * (1.0 + sizes[0])),
        "gravity": float(fields["gravity"] * (1.0 + sizes[1])),
        "gravity_angle": float(fields["gravity_angle"] + rng.uniform(-0.1, 0.1)),
    }
