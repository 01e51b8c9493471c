"""What a finding in the samples must beat: a joint with nothing but the fitted base, and that base itself.

The finders of the second look have a plain base of their own, so a joint whose friction they cannot draw leaves them
something to explain. The fitted base knows that friction: a recording made from it shows what they find in nothing.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from fricomp.recording import Recording

from ..inputs.track import FloatArray, differentiate
from ..joint.kernel import compute_creep_friction
from ..record.result import Quantity
from .fine_ripple import FineRipple, measure_fall
from .settings import LOOK, RIPPLE
from .soft_presliding import SoftPresliding, find_soft_presliding, simulate_bristle


def simulate_base(recording: Recording, base: Mapping[str, Quantity], seed: int) -> Recording:
    """The recording as the fitted base alone would have given it, with the recording's own noise.

    Args:
        recording: Motion and noise are taken from it.
        base: Parameters of the fitted base, as in `DiagnosisRecord.base`.
        seed: Of the noise.
    """
    torque = np.asarray(recording.torque)
    # Second differences hold next to no motion; drawn again they keep the tails of the noise.
    steps = np.diff(torque, 2) / np.sqrt(6.0)
    noise = np.random.default_rng(seed).choice(steps, torque.size)
    return replace(recording, torque=_compute_torque(recording, base) + noise)


def _compute_torque(recording: Recording, base: Mapping[str, Quantity]) -> FloatArray:
    """Torque that moves the base along the recorded position [N·m]. Shape (n,)."""
    q, dt = np.asarray(recording.position), recording.sample_period
    value = {name: quantity.value for name, quantity in base.items()}
    v = differentiate(q, dt)
    a = differentiate(v, dt)
    curve = {side: _compute_curve(v, value, side) for side in ("forward", "reverse")}
    level, viscous = (np.where(v > 0.0, curve["forward"][k], curve["reverse"][k]) for k in (0, 1))
    if value.get("creep_velocity", 0.0) > 0.0:
        felt = v + value["creep_lead"] * a
        dry = np.vectorize(compute_creep_friction)(felt, level, value["creep_velocity"], value["sharpness"], 0.0)
    else:
        dry = level * simulate_bristle(q, max(value["breakaway"], 1e-12))
    body = value["inertia"] * a + value["offset"]
    if recording.metadata.motion == "rotary":
        body = body + value["gravity_cos"] * np.cos(q) + value["gravity_sin"] * np.sin(q)
    torque: FloatArray = body + dry + viscous * v
    return torque


def _compute_curve(velocity: FloatArray, value: Mapping[str, float], side: str) -> tuple[FloatArray, float]:
    fall = np.exp(-((velocity / value[f"{side}.stribeck_velocity"]) ** 2))
    level = value[f"{side}.coulomb_torque"] + value[f"{side}.excess"] * fall
    return level, value[f"{side}.viscous_coefficient"]


def is_beyond_the_base(recording: Recording, found: FineRipple, base: Mapping[str, Quantity], seed: int) -> bool:
    """Whether the ripple leaves clearly less than waves of its orders leave where only the base acts."""
    if not base:
        return True
    nulls = (measure_fall(simulate_base(recording, base, seed + k), found.harmonics, seed) for k in range(LOOK.bases))
    return all(1.0 - found.fall <= (1.0 - RIPPLE.least_fall) * (1.0 - fall) for fall in nulls)


def is_softer_than_the_base(
    recording: Recording, soft: SoftPresliding, base: Mapping[str, Quantity], seed: int
) -> bool:
    """Whether no bristle is found where only the base acts, or none that is nearly as soft as this one.

    Args:
        recording: The recording.
        soft: The bristle found in it.
        base: Parameters of the fitted base, as in `DiagnosisRecord.base`.
        seed: Of the noise.
    """
    shown = find_soft_presliding(simulate_base(recording, base, seed)) if base else None
    return shown is None or soft.distance > LOOK.softer * shown.distance
