"""All joints of an arm follow a motion, through the safety gate, and are recorded."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fricomp.adapters import JointAdapter
from fricomp.control import ArmLoad, ControlLoop, ReferenceState
from fricomp.control.loop.loop_log import LoopLog
from fricomp.errors import ParameterError
from fricomp.joint import JointFeedback, await_feedback
from fricomp.laws import FloatArray
from fricomp.recording import Recording, RecordingMetadata

from .fourier import FourierMotion, ReferenceTable

_BANDWIDTH = 4.0
"""[Hz] of each joint's loop: well above the motion, below where arms ring."""

_SLOW = 0.15
"""Part of the speed limits that the way to the start uses."""

_LEAST_APPROACH = 2.0
"""[s] of that way at least: over it the enable ramp of the gate opens."""


class ArmController:
    """Gravity and inertia of the simulation along the reference, and a PD loop on what it leaves.

        τ = τ_l(q_r, v_r, a_r) + J_r a_r + J (ω² (q_r - q) + 2 ω (v_r - v))

    Args:
        load: Dynamics of the links.
        armature: Inertia of the rotors [kg·m²] or [kg].
        inertia: Typical inertia that each joint moves, rotor included [kg·m²] or [kg].
        bandwidth: ω / 2π [Hz].
    """

    def __init__(
        self, load: ArmLoad, armature: Sequence[float], inertia: Sequence[float], bandwidth: float = _BANDWIDTH
    ) -> None:
        omega = 2.0 * np.pi * bandwidth
        self._load, self._armature = load, list(armature)
        self._stiffness = [one * omega**2 for one in inertia]
        self._damping = [2.0 * one * omega for one in inertia]

    def torque_into(self, out: list[float], feedback: JointFeedback, reference: ReferenceState) -> None:
        """Fill in the torque of each joint."""
        q, v, a = reference.position, reference.velocity, reference.acceleration
        load = self._load.compute(q, v, a)
        for j, (seen, moved) in enumerate(zip(feedback.position, feedback.velocity, strict=True)):
            back = self._stiffness[j] * (q[j] - seen) + self._damping[j] * (v[j] - moved)
            out[j] = load[j] + self._armature[j] * a[j] + back


def read_positions(adapter: JointAdapter, period: float = 1e-3) -> FloatArray:
    """Where the joints of an open adapter stand [rad] or [m]. Shape (n_joints,)."""
    adapter.configure("torque", period)
    feedback = JointFeedback(len(adapter.capabilities.joints))
    await_feedback(adapter, feedback, period)
    return np.array(feedback.position)


def record_excitation(
    adapter: JointAdapter,
    motion: FourierMotion,
    controller: ArmController,
    *,
    speed: FloatArray,
    period: float = 1e-3,
    source: str = "",
) -> list[Recording]:
    """Move all joints from where they stand to the motion's start and along it, and record them.

    They are at zero torque after it, whatever happens; a trip of the gate ends it, and nothing enables them again.

    Args:
        adapter: Open; its gate holds the limits.
        motion: The motion.
        controller: Who makes the joints follow.
        speed: Speed limits of the joints, for the way to the start [rad/s] or [m/s]. Shape (n_joints,).
        period: Control period [s].
        source: Kept with the recordings.

    Returns:
        One recording a joint, of the motion without the way to its start.

    Raises:
        SafetyTrip: The gate stopped the motion.
        AdapterError: The bus or a drive failed.
    """
    start = read_positions(adapter, period)
    approach = max(float(np.max(1.9 * np.abs(motion.centre - start) / (_SLOW * speed))), _LEAST_APPROACH)
    reference = ReferenceTable(motion, start, approach, period)
    rows = int(reference.duration / period) + 1
    loop = ControlLoop(adapter, reference, controller, period=period, log_capacity=rows)
    result = loop.run(reference.duration)
    result.raise_if_tripped()
    return _read_log(adapter, result.log, approach, source)


def _read_log(adapter: JointAdapter, log: LoopLog, approach: float, source: str) -> list[Recording]:
    kept = np.flatnonzero(log.time >= approach)
    if kept.size < 2:
        raise ParameterError("the motion was stopped before its start: nothing was recorded")
    recordings = []
    for j, joint in enumerate(adapter.capabilities.joints):
        metadata = RecordingMetadata(
            joint=joint.name,
            motion=joint.motion,
            torque_unit=joint.torque_unit,
            torque_kind=joint.torque_kind,
            encoder_resolution=joint.position_quantum or None,
            position_limits=joint.position_limits,
            source=source,
        )
        recordings.append(log.recording(j, metadata).rows(kept))
    return recordings
