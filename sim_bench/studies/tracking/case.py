"""One run on the stand-in: a sine, a controller, a compensation, and the true tracking error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, get_args

import numpy as np

from fricomp.control import Compensator, Controller, ControlLoop, ReferenceState, SineReference
from fricomp.control.loop.loop_log import LoopLog
from fricomp.joint import JointFeedback
from fricomp.laws import FloatArray
from fricomp.root_mean_square import compute_rms

from ...stand_in import SensorSettings, SimulatedJointAdapter, default_joint, sensors_for
from .joint import PERIOD, TrackedJoint, loop_of, scaled_law

Method = Literal["none", "coulomb_viscous", "stribeck", "default"]
METHODS: tuple[Method, ...] = get_args(Method)
"""Without; tanh-Coulomb-viscous, fitted; Stribeck on the reference alone; what the library chooses."""

REVERSAL_WINDOW = 0.3
"""Time after the reference changes its sign that counts as reversal [s]."""

_CYCLES = 2.0


@dataclass(frozen=True)
class TrackingCase:
    """What is run.

    Attributes:
        joint: Whose friction.
        method: How it is compensated.
        amplitude: Of the sine [rad].
        bandwidth: Of the PD loop [Hz].
        frequency: Of the sine [Hz].
        gain: Of the compensation; None for the method's own.
        friction_scale: True over modelled friction [1].
        delay: Of the sensors [s].
        seed: Of the sensor noise.
    """

    joint: TrackedJoint
    method: Method
    amplitude: float
    bandwidth: float
    frequency: float = 0.1
    gain: float | None = None
    friction_scale: float = 1.0
    delay: float = 0.001
    seed: int = 0


@dataclass(frozen=True)
class TrackingFigures:
    """How well it tracked. Arrays have shape (n_samples,).

    Attributes:
        rms: True tracking error, root mean square [rad].
        reversal_rms: The same within 0.3 s after each reversal [rad].
        time: [s].
        error: Reference minus true position [rad].
    """

    rms: float
    reversal_rms: float
    time: FloatArray
    error: FloatArray

    def change_from(self, base: TrackingFigures) -> tuple[float, float]:
        """RMS and RMS at reversals over those of other figures, minus one; negative is better [1]."""
        return self.rms / base.rms - 1.0, self.reversal_rms / base.reversal_rms - 1.0


@dataclass
class Witness:
    """A controller that also notes the true position, which no controller knows.

    Attributes:
        controller: The controller.
        adapter: What it runs on.
        position: True position at each cycle so far [rad].
    """

    controller: Controller
    adapter: SimulatedJointAdapter
    position: list[float] = field(default_factory=list)

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """What the controller says."""
        self.controller.torque_into(out, feedback, reference)
        self.position.append(self.adapter.stand_in.plant.position(0))


def run_case(case: TrackingCase) -> TrackingFigures:
    """Run `case` for two cycles of the sine; the first half cycle is left out of the figures."""
    witness, loop = _prepare(case)
    result = loop.run(_CYCLES / case.frequency)
    result.raise_if_tripped()
    return compute_figures(result.log, witness.position, case.frequency)


def compute_figures(log: LoopLog, position: Sequence[float], frequency: float) -> TrackingFigures:
    """How well a sine was followed, without its first half cycle.

    Args:
        log: Of the run.
        position: True position at each cycle [rad]. Shape (n_samples,) or longer.
        frequency: Of the sine [Hz].
    """
    time = log.time
    error = log.signal("position_reference")[:, 0] - np.array(position[: len(time)])
    settled = time >= 0.5 / frequency
    reversal = settled & _select_after_reversal(log.signal("velocity_reference")[:, 0])
    return TrackingFigures(
        rms=compute_rms(error[settled]),
        reversal_rms=compute_rms(error[reversal]),
        time=time,
        error=error,
    )


def run_standstill(case: TrackingCase, duration: float = 5.0) -> float:
    """Travel of the joint while the reference stands still, in the last four fifths of `duration` [s], [rad]."""
    witness, loop = _prepare(case, standing=True)
    loop.run(duration).raise_if_tripped()
    position = np.array(witness.position[len(witness.position) // 5 :])
    return float(np.ptp(position))


def _prepare(case: TrackingCase, *, standing: bool = False) -> tuple[Witness, ControlLoop]:
    law = scaled_law(case.joint.law, case.friction_scale)
    sensor = replace(sensors_for(law), delay=case.delay)
    adapter = SimulatedJointAdapter(default_joint(law=law, sensor=sensor, seed=case.seed))
    adapter.open()
    controller, _ = loop_of(case.bandwidth, sensor)
    witness, compensator = Witness(controller, adapter), _make_compensator(case, sensor)
    if standing:
        reference = SineReference([0.0], case.frequency, [5e-4])  # an offset that the friction holds
    else:
        reference = SineReference([case.amplitude], case.frequency, [0.0])
    loop = ControlLoop(
        adapter, reference, witness, compensators=None if compensator is None else [compensator], period=PERIOD
    )
    return witness, loop


def _make_compensator(case: TrackingCase, sensor: SensorSettings) -> Compensator | None:
    """The rivals get the full gain, and the direction smoothed as ours."""
    if case.method == "none":
        return None
    gain: dict[str, Any] = {} if case.gain is None else {"gain": case.gain}
    if case.method == "default":
        _, loop = loop_of(case.bandwidth, sensor)
        return Compensator(case.joint.model, period=PERIOD, loop=loop, **gain)
    model = case.joint.model
    smoothing = Compensator(model).settings.smoothing
    if case.method == "coulomb_viscous":
        model = case.joint.coulomb_viscous_model
    return Compensator(model, period=PERIOD, source="reference", smoothing=smoothing, **({"gain": 1.0} | gain))


def _select_after_reversal(velocity: FloatArray) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Samples within `REVERSAL_WINDOW` after the reference velocity changes its sign. Shape (n_samples,)."""
    near = np.zeros(len(velocity), dtype=bool)
    width = round(REVERSAL_WINDOW / PERIOD)
    for start in np.flatnonzero(np.diff(np.sign(velocity)) != 0.0):
        near[start + 1 : start + 1 + width] = True
    return near
