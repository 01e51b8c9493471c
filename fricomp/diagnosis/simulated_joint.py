"""The joint that a simulation has, read off a recording that it made."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fricomp.errors import DiagnosisError
from fricomp.laws import BidirectionalStribeck, FrictionLaw, StribeckCurve
from fricomp.model import FrictionModel
from fricomp.recording import Recording

from .course import Progress
from .diagnose import diagnose
from .evidence.comparison import NAMED, PLAIN, UNEXPLAINED, Tolerances
from .evidence.settings import PARAMETERS
from .inputs.checks import reasons_against
from .inputs.rigid import RigidJoint
from .inputs.sensor_noise import add_sensor_noise
from .inputs.track import FloatArray
from .joint.base import BASE_NAMES, BODY_AND_CURVES
from .record.result import Diagnosis, NamedEffect, Quantity

_PARTING = {"offset": 1.0, "forward.coulomb_torque": -1.0, "reverse.coulomb_torque": 1.0}
"""How an offset and the difference of the directions make up for each other while the joint slides."""


@dataclass(frozen=True)
class SimulatedJoint:
    """What a simulation's recording says about the simulation.

    Attributes:
        rigid: Its inertia, gravity and friction; None where something stays unexplained, which bends all of them.
        friction: Its friction; None in the same case.
        effects: Effects of the catalogue that it has itself.
        noise_ratio: Residual that no effect explains, over the noise; None where nothing stays unexplained.
    """

    rigid: RigidJoint | None
    friction: FrictionModel | None
    effects: tuple[NamedEffect, ...] = ()
    noise_ratio: float | None = None

    @property
    def remarks(self) -> tuple[str, ...]:
        """What stays unexplained in it, in a sentence."""
        if self.noise_ratio is None:
            return ()
        return (
            "Careful: nothing was compared with the simulation. Its recording shows something that no effect explains "
            f"({self.noise_ratio:.3g} times the recording's noise), so that its inertia, gravity and friction cannot "
            "be read off it; what is named here may be in the simulation as well. The simulation itself, given with "
            "--simulation, would tell.",
        )


def read_simulated(
    recording: Recording,
    like: Sequence[Recording] = (),
    *,
    seed: int = 0,
    progress: Progress | None = None,
) -> SimulatedJoint:
    """Identify the joint that a simulation has, from its own recording, in the way of any other recording.

    Args:
        recording: What the simulator made.
        like: Recordings of the real joint, whose noise it gets where it has less: whatever a simulator does below that
            noise has no bearing on the comparison with them.
        seed: Of noise, nulls and bootstraps.
        progress: Called with a few words before each step.

    Raises:
        DiagnosisError: No joint can be identified from it.
    """
    against = reasons_against([recording], None)
    if against:
        raise DiagnosisError(f"the simulated recording cannot be used: {'; '.join(against)}")
    recording = recording.on_joint_side()
    sensed = add_sensor_noise(recording, [one.on_joint_side() for one in like], seed) if like else recording
    found = diagnose(sensed, seed=seed, progress=progress)
    if not found.record.base:
        raise DiagnosisError(
            "the simulated recording obeys no law of its joint's own motion, so no simulation can be read from it: "
            "give one that moves freely, or the simulation itself with --simulation"
        )
    left = _measure_rest(found)
    if left is not None:
        return SimulatedJoint(None, None, found.effects, left)
    friction = _read_friction(recording, found.record.base)
    return SimulatedJoint(_read_rigid(recording, found, friction), friction, found.effects)


def _measure_rest(found: Diagnosis) -> float | None:
    """What no effect explains, over the noise; None where that is no more than noise."""
    held = found.heldout
    if found.verdict == "unknown_physics" or held is None:
        return found.record.noise_ratio
    left = held.rmse_after / max(held.noise_floor, 1e-30)
    return left if left > PARAMETERS.readable else None


def _read_friction(recording: Recording, base: Mapping[str, Quantity]) -> FrictionModel:
    """The refitted curves, without the constant torque that a model alone would hold."""
    forward, reverse = (
        StribeckCurve(
            base[f"{side}.coulomb_torque"].value,
            base[f"{side}.coulomb_torque"].value + base[f"{side}.excess"].value,
            base[f"{side}.stribeck_velocity"].value,
            base[f"{side}.viscous_coefficient"].value,
        )
        for side in ("forward", "reverse")
    )
    metadata = recording.metadata
    law = FrictionLaw((BidirectionalStribeck(forward, reverse),))
    return FrictionModel(law=law, joint=metadata.joint, motion=metadata.motion, torque_unit=metadata.torque_unit)


def _read_rigid(recording: Recording, found: Diagnosis, friction: FrictionModel) -> RigidJoint:
    """Body and friction, and how far they may be off.

    Args:
        recording: What the simulator made.
        found: Its diagnosis.
        friction: What was read of its friction.
    """
    base, curves = found.record.base, (friction.forward, friction.reverse)
    rigid = RigidJoint(
        inertia=base["inertia"].value,
        gravity=(base["gravity_cos"].value, base["gravity_sin"].value),
        offset=base["offset"].value,
        damping=0.5 * sum(curve.viscous_coefficient for curve in curves),
        friction_loss=0.5 * sum(curve.coulomb_torque for curve in curves),
        rotary=recording.metadata.motion == "rotary",
    )
    tolerances = NAMED if found.effects else PLAIN
    if found.covariance is None:  # the samples showed more than the rows of this fit
        tolerances = UNEXPLAINED
    own = np.zeros((BODY_AND_CURVES, BODY_AND_CURVES)) if found.covariance is None else found.covariance
    return replace(rigid, covariance=_build_covariance(own, rigid, _measure_level(found, rigid), tolerances))


def _measure_level(found: Diagnosis, read: RigidJoint) -> float:
    """Dry friction in both directions, with what of it a named effect has taken over from the base."""
    if found.base_model is None:
        return read.friction_loss
    curves = (found.base_model.forward, found.base_model.reverse)
    return max(read.friction_loss, 0.5 * sum(curve.coulomb_torque for curve in curves))


def _build_covariance(covariance: FloatArray, read: RigidJoint, level: float, tolerances: Tolerances) -> FloatArray:
    """Covariance of inertia, gravity, offset and curves; what sliding cannot part is known no better than in a refit.

    Args:
        covariance: Of the base. Shape (p, p).
        read: What was read.
        level: Dry friction.
        tolerances: How far all of it strays beyond what the fit knows of its own error.
    """
    named = BASE_NAMES[:BODY_AND_CURVES]
    parting = np.array([_PARTING.get(name, 0.0) for name in named]) * PARAMETERS.split * level
    gravity = float(np.hypot(tolerances.gravity * float(np.hypot(*read.gravity)), tolerances.sliding * level))
    strays = {"log_inertia": tolerances.inertia, "gravity_cos": gravity, "gravity_sin": gravity}
    strays |= dict.fromkeys(_PARTING, tolerances.uneven * level)
    beyond = np.diag([strays.get(name, 0.0) for name in named]) ** 2
    result: FloatArray = covariance[: len(named), : len(named)] + np.outer(parting, parting) + beyond
    return result
